"""A loaded track file run as it says, or with what the caller wants otherwise."""

from collections.abc import Callable, Mapping

import numpy as np

from ikde.errors import InputError
from ikde.kernels.arrays import Floats
from ikde.model.robot import Robot
from ikde.solver.joints import JointValues
from ikde.track.limits import MotionLimits
from ikde.track.plan import AskedLimits, TrackPlan
from ikde.track.spec import Drive, TrackMethod
from ikde.track.track import track
from ikde.track.trajectory import Trajectory


def run_track(
    plan: TrackPlan,
    *,
    method: TrackMethod | None = None,
    drive: Drive | None = None,
    seed: int | None = None,
    start: JointValues | None = None,
    announce_compile: Callable[[], None] | None = None,
) -> Trajectory:
    """Follow a track file's path inside its limits.

    Args:
        plan: what `load_track` gives.
        method: `continuation`, or one of the paper's; None for the plan's.
        drive: `differential` or `omnidirectional`; None for the plan's.
        seed: same seed, same bits; None for the plan's.
        start: the configuration at the first pose, [N] or by joint name, m and rad; None for the plan's.
        announce_compile: called once if kernels must be compiled first.

    Returns:
        The motion, as far as it goes. `stop` says where and why it ended before the path did.

    Raises:
        InputError: for an unknown method or drive, and a start that is not at the first pose or collides.
        FileError: the same, with file, line and key, if that is what the file says.
    """
    plan = plan.with_changes(method=method, drive=drive, seed=seed, start=start)
    try:
        return track(
            plan.robot,
            plan.path,
            drive=plan.drive,
            method=plan.method,
            limits=make_limits(plan.robot, plan.limits),
            start=plan.start,
            seed=plan.seed,
            detector=plan.detector or "none",
            announce_compile=announce_compile,
        )
    except InputError as error:
        if not error.where or error.where[0] in plan.replaced:
            raise
        raise plan.blame(error.message, error.where) from None


def make_limits(robot: Robot, asked: AskedLimits) -> MotionLimits:
    """The limits of a track file; what it leaves out is as in the paper (`MotionLimits.of`)."""
    usual = MotionLimits.of(robot)
    assert usual.speed is not None
    return MotionLimits(
        ranges=asked.ranges,
        speed=_by_joint(robot, asked.speed, usual.speed),
        acceleration=_by_joint(robot, asked.acceleration, np.inf) if asked.acceleration else None,
        wheel_speed_rad_s=asked.wheel_speed_rad_s,
        farthest_m=asked.farthest_m,
        center=asked.center,
        position_error_m=asked.position_error_m or usual.position_error_m,
        orientation_error_rad=asked.orientation_error_rad or usual.orientation_error_rad,
    )


def _by_joint(robot: Robot, asked: Mapping[str, float], usual: Floats | float) -> Floats:
    """One number a joint [N]."""
    row = np.broadcast_to(np.asarray(usual, dtype=float), len(robot.joints)).copy()
    for name, value in asked.items():
        row[robot.joint_names.index(name)] = value
    return row
