"""A loaded track file followed as it says, or with what the caller wants otherwise; and compiled ahead."""

from functools import partial

import numpy as np

from ikde.errors import InputError
from ikde.model.collision_model import CollisionChoice
from ikde.model.robot import Drive, Robot
from ikde.solver.joints import JointValues
from ikde.solver.plain import compute_frames
from ikde.solver.warmup import Stage
from ikde.track.follow_path import METHODS, follow_plan
from ikde.track.path import ToolPath
from ikde.track.plan import TrackPlan
from ikde.track.servo import Servo
from ikde.track.spec import TrackMethod
from ikde.track.trajectory import Trajectory


def run_track(
    plan: TrackPlan,
    *,
    method: TrackMethod | None = None,
    drive: Drive | None = None,
    seed: int | None = None,
    start: JointValues | None = None,
) -> Trajectory:
    """Follow a track file's path inside its limits.

    Args:
        plan: what `load_track` gives.
        method: `continuation`, or one of the paper's; None for the plan's.
        drive: `differential` or `omnidirectional`; None for the plan's.
        seed: same seed, same bits; None for the plan's.
        start: the configuration at the first pose, [N] or by joint name, m and rad; None for the plan's.

    Returns:
        The motion, as far as it goes. `stop` says where and why it ended before the path did.

    Raises:
        InputError: for what is no plan, an unknown method or drive, and a start that is elsewhere or collides.
    """
    if not isinstance(plan, TrackPlan):
        raise InputError(f"expected what `load_track` gives, got {type(plan).__name__}; `follow_path` takes a path")
    return follow_plan(plan.with_changes(method=method, drive=drive, seed=seed, start=start))


def list_track_stages(robot: Robot, collision: CollisionChoice = None) -> list[Stage]:
    """What tracks compile, a stage a method, and servos: kernels are the same for each drive and kind of path."""
    tool = compute_frames(robot, robot.home)[robot.tool]
    path = ToolPath.through(np.tile(tool[:3, 3], (3, 1)), dt_s=0.02)  # the robot stands still at home
    plan = TrackPlan.of(robot, path, drive="omnidirectional", collision=collision)
    tracks = [Stage(name=f"track, {method}", run=partial(run_track, plan, method=method)) for method in METHODS]
    return [*tracks, Stage(name="servo", run=partial(Servo, robot, robot.home, collision=collision))]
