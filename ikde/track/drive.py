"""Bases: how one moves between samples, its twist and its wheels, in plain numpy; and a drive packed for the kernels.

`differential`: two driven wheels, whether the robot tells of them or not. Between samples the speeds v and omega stay,
so the base runs along an exact arc and never slides sideways (5). `omnidirectional`: x, y and heading run linearly. So
does every joint of an arm.
"""

from collections.abc import Collection

import numpy as np

from ikde.errors import InputError
from ikde.kernels.arrays import COORDINATE, DriveArrays, Floats, Ints
from ikde.model.pack import frame_names, pack_robot
from ikde.model.planar_base import find_planar_base
from ikde.model.robot import Robot, Wheels
from ikde.model.tree import build_tree
from ikde.track.limits import MotionLimits
from ikde.track.spec import DRIVES, Drive

MOST_M, MOST_RAD = 0.5, 0.5 * np.pi  # of one sample, whatever the speed limits: a step is found near its start


def step_base(start: Floats, v: Floats, omega: Floats, dt_s: Floats | float) -> Floats:
    """Where a base [..., 3] is after `dt_s` of constant `v` m/s and `omega` rad/s [...]: the end of the exact arc."""
    angle = omega * dt_s
    chord, middle = v * dt_s * np.sinc(0.5 * angle / np.pi), start[..., 2] + 0.5 * angle
    return start + np.stack([chord * np.cos(middle), chord * np.sin(middle), angle], axis=-1)


def base_twist(start: Floats, end: Floats, dt_s: float) -> tuple[Floats, Floats, Floats]:
    """The arc between two places of a base [..., 3]: v in m/s, omega in rad/s, and what no arc explains in m/s.

    That residual is the chord's velocity across the mid heading: (5) along the motion, 0 on an arc.
    """
    shift = end - start
    middle, angle = 0.5 * (start[..., 2] + end[..., 2]), shift[..., 2]
    along = shift[..., 0] * np.cos(middle) + shift[..., 1] * np.sin(middle)
    across = shift[..., 1] * np.cos(middle) - shift[..., 0] * np.sin(middle)
    return along / np.sinc(0.5 * angle / np.pi) / dt_s, angle / dt_s, across / dt_s


def wheel_speeds(wheels: Wheels, v: Floats, omega: Floats) -> Floats:
    """Speeds of the left and the right wheel [..., 2] in rad/s (6), of `v` m/s and `omega` rad/s [...]."""
    return np.stack([v - wheels.half_track_m * omega, v + wheels.half_track_m * omega], axis=-1) / wheels.radius_m


def implied_wheel_speed(wheels: Wheels, speed: Floats, base: Ints) -> float:
    """The wheel speed that the speed limits [N] of a base imply, rad/s: (v + B omega) / r."""
    v = float(min(speed[base[0]], speed[base[1]]))
    return (v + wheels.half_track_m * float(speed[base[2]])) / wheels.radius_m


def usual_drive(robot: Robot) -> Drive:
    """`differential` for a robot that has a base to drive, `omnidirectional` for one that has none."""
    return "differential" if find_planar_base(robot)[0] >= 0 else "omnidirectional"


def choose_drive(robot: Robot, drive: Drive | None, method: str) -> Drive:
    """The drive of a method: `typical` minds none and moves freely; None is the robot's usual one."""
    if drive is not None:
        find_wheels(robot, drive)
    if method == "typical":
        return "omnidirectional"
    return usual_drive(robot) if drive is None else drive


def find_wheels(robot: Robot, drive: str) -> Ints:
    """Coordinates [3] of x, y and heading of a base that runs on arcs; -1 thrice for a drive without.

    Raises `InputError` for an unknown drive, or a robot that has no base to drive.
    """
    if drive not in DRIVES:
        raise InputError(f"expected one of {', '.join(DRIVES)}, got {drive!r}", ("drive",))
    if drive == "omnidirectional":
        return np.full(3, -1)
    base = find_planar_base(robot).copy()
    if base[0] < 0:
        raise InputError(f"{robot.name} has no base that drives in the plane and turns", ("drive",))
    return base


def pack_drive(
    robot: Robot, drive: str, limits: MotionLimits, dt_s: float, frozen: Collection[str] = ()
) -> DriveArrays:
    """The drive for the kernels: the largest step of one sample, and by how much a step may differ from the last."""
    base = find_wheels(robot, drive)
    most = largest_steps(robot)
    is_frozen = np.isin(robot.joint_names, list(frozen)) | (robot.upper <= robot.lower)
    asked = np.inf if limits.speed is None else limits.speed * dt_s
    largest = np.where(is_frozen, 0.0, np.minimum(asked, most))
    change = np.full(len(largest), np.inf) if limits.acceleration is None else limits.acceleration * dt_s**2
    others = np.array([c for c in pack_robot(robot).bodies[1:, COORDINATE].tolist() if c not in base])
    tree = build_tree(robot)
    centre = limits.center or robot.tool
    half_track, wheel_travel = _wheels_of(limits, robot.wheels, dt_s)
    return DriveArrays(
        base=base,
        others=others,
        largest=_by_step(largest, base, others),
        change=_shares(_by_step(change, base, others), _by_step(largest, base, others)),
        half_track=half_track,
        wheel_travel=wheel_travel,
        centre_body=tree.frame_body[centre],
        p_body_centre=_to_packed(robot, centre),
        max_distance=np.inf if limits.farthest_m is None else float(limits.farthest_m),
    )


def largest_steps(robot: Robot) -> Floats:
    """[N] m or rad: what a joint moves in one sample at most."""
    return np.where(robot.slides, MOST_M, MOST_RAD)


def _wheels_of(limits: MotionLimits, wheels: Wheels | None, dt_s: float) -> tuple[float, float]:
    """Half track, and how far a wheel rolls in a sample at most, in m: any way for wheels without a limit, or none."""
    if wheels is None:
        return 0.0, np.inf
    fastest = limits.wheel_speed_rad_s
    return wheels.half_track_m, np.inf if fastest is None else float(fastest * wheels.radius_m * dt_s)


def _by_step(values: Floats, base: Ints, others: Ints) -> Floats:
    """Values by coordinate [N] as values by entry of a step [D]: a base drives with the lower of those of x and y."""
    if base[0] < 0:
        return values[others]
    return np.concatenate([[min(values[base[0]], values[base[1]]), values[base[2]]], values[others]])


def _shares(change: Floats, largest: Floats) -> Floats:
    """Changes as shares of the largest step [D]; what is frozen has none to heed."""
    return np.divide(change, largest, out=np.full(len(change), np.inf), where=largest > 0.0)


def _to_packed(robot: Robot, frame: str) -> Floats:
    """Origin of a frame in its packed body [3], m."""
    return pack_robot(robot).T_body_frame[frame_names(robot).index(frame), :, 3].copy()
