"""`follow_path`: follow a path of the tool with the whole robot, or say where and why it ends."""

from collections.abc import Callable, Mapping
from typing import Unpack

import numpy as np

from ikde.errors import InputError
from ikde.kernels.arrays import Floats
from ikde.model.arguments import RobotLike, read_robot
from ikde.model.base_motion import base_joints, find_planar_base
from ikde.model.collision_model import CollisionChoice
from ikde.model.robot import Drive, Robot
from ikde.solver.joints import JointValues
from ikde.solver.problem import Freeze
from ikde.track.certify import certify, measure_deviation
from ikde.track.continuation import follow_continuation
from ikde.track.follower import Follower, make_follower
from ikde.track.limits import MotionLimits
from ikde.track.moving import Around
from ikde.track.optimized import follow_optimized
from ikde.track.path import ToolPath
from ikde.track.plan import Moves, TrackPlan
from ikde.track.settings import TrackSettings
from ikde.track.spec import TrackMethod
from ikde.track.trajectory import Followed, Trajectory
from ikde.track.typical import follow_typical
from ikde.track.verify_track import verify_track

Method = Callable[[Follower], Followed]
METHODS: Mapping[TrackMethod, Method] = {
    "continuation": follow_continuation,
    "optimized": follow_optimized,
    "typical": follow_typical,
}
"""What takes a packed plan to a motion."""


def follow_path(
    robot: RobotLike,
    path: ToolPath,
    *,
    drive: Drive | None = None,
    method: TrackMethod = "continuation",
    limits: MotionLimits | None = None,
    start: JointValues | None = None,
    seed: int = 0,
    collision: CollisionChoice = None,
    freeze: Freeze | None = None,
    settings: TrackSettings | None = None,
    **moves: Unpack[Moves],
) -> Trajectory:
    """Follow the path inside all limits, free of self-collision and of a world at the samples and between them.

    Without a detector nothing is compared.

    Args:
        robot: the robot, its name or the path of its file.
        path: poses of the tool, a sample every `path.dt_s`.
        drive: `differential`, a base with two wheels, or `omnidirectional` and `mecanum`: every joint by itself. None:
            that of the robot's file, else on arcs if the robot has a base. `typical` ignores it: every joint moves
            independently.
        method: `continuation`; or one of the paper's: `optimized`, which keeps the limits at samples only, or
            `typical`, which goes on to the end whatever it violates: see `Trajectory.violations`.
        limits: None for the robot's own speeds and accelerations, and the paper's limits (`MotionLimits.of`).
        start: the configuration at the first pose [N], or by name; None for the one that `continuation` finds best.
        seed: same seed, same bits.
        collision: a detector's name, a `Detector`, a `World`, a `CollisionModel` (with margins: its `in_world`),
            `"none"`, or None for the robot's default.
        freeze: joints that must not move, with their value in m or rad (None: from `start`, else home).
        settings: of that method: `ContinuationSettings`, `OptimizedSettings` or `TypicalSettings`; None for its
            usual ones.
        moves: `moving`, a mapping of obstacles of the world by name to an `ObjectMotion`, which says where each is at
            any time of the path.

    Returns:
        The motion, as far as it goes; except for `typical` it never jumps. `stop` says where and why it ended
        before the path did.

    Raises:
        InputError: for what does not fit the robot, and a start that is not at the first pose or collides.
    """
    if unknown := moves.keys() - Moves.__annotations__:
        raise TypeError(f"follow_path() got an unexpected keyword argument {min(unknown)!r}")
    for value, kind, name in ((path, ToolPath, "path"), (limits, MotionLimits, "limits")):
        if not isinstance(value, kind) and not (value is None and name == "limits"):
            raise InputError(f"expected a {kind.__name__}, got {type(value).__name__}", (name,))
    plan = TrackPlan.of(
        read_robot(robot),
        path,
        drive=drive,
        method=method,
        limits=limits,
        start=start,
        seed=seed,
        collision=collision,
        freeze=freeze,
        settings=settings,
        **moves,
    )
    return follow_plan(plan)


def follow_plan(plan: TrackPlan) -> Trajectory:
    """Follow a plan by its method, and grade what comes of it."""
    return grade_motion(plan, METHODS[plan.method](make_follower(plan)))


def grade_motion(plan: TrackPlan, followed: Followed) -> Trajectory:
    """The motion with what the judge and the certificate say about it."""
    robot, path, limits, drive, q = plan.robot, plan.path, plan.limits, plan.base_drive, followed.q
    moving = plan.make_moving()
    around = None if moving is None else Around(moving, path.times_s[: len(q)])
    graded = verify_track(plan.collision, path, q, drive=drive, limits=limits, moving=moving)
    deviation_m, deviation_rad = measure_deviation(robot, path, q, drive)
    v, omega = base_speeds(robot, graded.speeds) if drive != "differential" else (graded.v, graded.omega)
    return Trajectory(
        path=path,
        joint_names=robot.joint_names,
        base_joints=base_joints(robot),
        drive=drive,
        method=plan.method,
        limits=limits,
        q=q,
        v=v,
        omega=omega,
        wheel_speeds=None if drive != "differential" or robot.wheels is None else graded.wheel_speeds,
        stop=followed.stop,
        seconds=followed.seconds,
        search_seconds=followed.search_seconds,
        grade=graded,
        certificate=certify(plan.collision, q, drive, around),
        moving=plan.moving,
        deviation_m=deviation_m,
        deviation_rad=deviation_rad,
    )


def base_speeds(robot: Robot, speeds: Floats) -> tuple[Floats, Floats]:
    """Speeds of a base along x and y [M, 2] in m/s and of its heading [M] in rad/s, out of all joints' [M, N]."""
    base = find_planar_base(robot)
    if base[0] < 0:
        return np.zeros((len(speeds), 2)), np.zeros(len(speeds))
    return speeds[:, base[:2]], speeds[:, base[2]]
