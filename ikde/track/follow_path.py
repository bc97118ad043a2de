"""`follow_path`: follow a path of the tool with the whole robot, or say where and why it ends."""

import numpy as np

from ikde.errors import InputError
from ikde.kernels.arrays import Floats
from ikde.model.collision_model import CollisionChoice, CollisionModel
from ikde.model.planar_base import find_planar_base
from ikde.model.robot import Robot
from ikde.solver.joints import JointValues
from ikde.solver.problem import Freeze, make_problem
from ikde.solver.settings import SolveSettings, check_seed
from ikde.track.certify import certify, measure_deviation
from ikde.track.continuation import Continuation
from ikde.track.courses import ContinuationSettings
from ikde.track.drive import choose_drive
from ikde.track.follower import make_follower
from ikde.track.limits import MotionLimits
from ikde.track.methods import Followed, TrackSettings, check_method, follow_by
from ikde.track.path import ToolPath
from ikde.track.spec import Drive, TrackMethod
from ikde.track.starts import read_start
from ikde.track.trajectory import Trajectory
from ikde.track.verify_track import verify_track


def follow_path(
    robot: Robot,
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
) -> Trajectory:
    """Follow the path inside all limits, free of self-collision at the samples and between them if there is a detector.

    Args:
        robot: the robot.
        path: poses of the tool, a sample every `path.dt_s`.
        drive: `differential`, a base with two wheels, or `omnidirectional`: every joint by itself. None: on arcs if
            the robot has a base. `typical` minds no wheels and always moves every joint by itself.
        method: `continuation`; or one of the paper's: `optimized`, which keeps the limits at samples only, or
            `typical`, which goes on to the end whatever it breaks: see `Trajectory.breaches`.
        limits: None for those of the paper (`MotionLimits.of`).
        start: the configuration at the first pose [N], or by name; None for the one that `continuation` finds best.
        seed: same seed, same bits.
        collision: as for `ikde.solve`.
        freeze: joints that must not move, with their value in m or rad (None: from `start`, else home).
        settings: of that method: `ContinuationSettings`, `OptimizedSettings` or `TypicalSettings`; None for its
            usual ones.

    Returns:
        The motion, as far as it goes; except for `typical` it never jumps. `stop` says where and why it ended
        before the path did.

    Raises:
        InputError: for what does not fit the robot, and a start that is not at the first pose or collides.
    """
    for value, kind, name in ((robot, Robot, "robot"), (path, ToolPath, "path"), (limits, MotionLimits, "limits")):
        if not isinstance(value, kind) and not (value is None and name == "limits"):
            raise InputError(f"expected a {kind.__name__}, got {type(value).__name__}", (name,))
    check_method(method, settings)
    drive = choose_drive(robot, drive, method)
    limits = MotionLimits.of(robot) if limits is None else limits.check(robot)
    model = CollisionModel.of(robot, collision)
    if start is not None:
        start = read_start(robot, start)
    problem = make_problem(robot, SolveSettings(), collision=model, near=start, freeze=freeze)
    frozen = {name: float(problem.lower[robot.joint_names.index(name)]) for name in problem.frozen}
    follower = make_follower(model, path, drive=drive, limits=limits, frozen=problem.frozen)
    wanted = settings if isinstance(settings, ContinuationSettings) else ContinuationSettings()
    search = Continuation(follower=follower, frozen=frozen, seed=check_seed(seed), settings=wanted)
    followed = follow_by(method, search, start, settings)
    return grade_motion(model, path, followed, drive=drive, method=method, limits=limits)


def grade_motion(
    collision: CollisionModel,
    path: ToolPath,
    followed: Followed,
    *,
    drive: Drive,
    method: str,
    limits: MotionLimits,
) -> Trajectory:
    """The motion with what the judge and the certificate say about it."""
    robot, q = collision.robot, followed.q
    graded = verify_track(collision, path, q, drive=drive, limits=limits)
    deviation_m, deviation_rad = measure_deviation(robot, path, q, drive)
    v, omega = base_speeds(robot, graded.speeds) if drive == "omnidirectional" else (graded.v, graded.omega)
    return Trajectory(
        path=path,
        joint_names=robot.joint_names,
        base_joints=base_joints(robot),
        drive=drive,
        method=method,
        limits=limits,
        q=q,
        v=v,
        omega=omega,
        wheel_speeds=None if drive == "omnidirectional" or robot.wheels is None else graded.wheel_speeds,
        stop=followed.stop,
        seconds=followed.seconds,
        search_seconds=followed.search_seconds,
        verification=graded,
        certificate=certify(collision, q),
        deviation_m=deviation_m,
        deviation_rad=deviation_rad,
    )


def base_joints(robot: Robot) -> tuple[str, ...]:
    """Names of x, y and heading of a base that drives in the plane; none for a robot without."""
    return tuple(robot.joint_names[k] for k in find_planar_base(robot) if k >= 0)


def base_speeds(robot: Robot, speeds: Floats) -> tuple[Floats, Floats]:
    """Speeds of a base along x and y [M, 2] in m/s and of its heading [M] in rad/s, out of all joints' [M, N]."""
    base = find_planar_base(robot)
    if base[0] < 0:
        return np.zeros((len(speeds), 2)), np.zeros(len(speeds))
    return speeds[:, base[:2]], speeds[:, base[2]]
