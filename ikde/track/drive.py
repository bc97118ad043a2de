"""A drive packed for the kernels: the largest step of one sample, and by how much a step may differ from the last."""

from collections.abc import Collection

import numpy as np

from ikde.kernels.arrays import COORDINATE, DriveArrays, Floats, Ints
from ikde.model.base_motion import find_wheels
from ikde.model.pack import frame_names, pack_robot
from ikde.model.robot import Robot, Wheels
from ikde.model.tree import build_tree
from ikde.track.limits import MotionLimits

MAX_STEP_M, MAX_STEP_RAD = 0.5, 0.5 * np.pi  # of one sample, whatever the speed limits: a step is found near its start


def implied_wheel_speed(wheels: Wheels, speed: Floats, base: Ints) -> float:
    """The wheel speed that the speed limits [N] of a base imply, rad/s: (v + B omega) / r."""
    v = float(min(speed[base[0]], speed[base[1]]))
    return (v + wheels.half_track_m * float(speed[base[2]])) / wheels.radius_m


def pack_drive(
    robot: Robot, drive: str, limits: MotionLimits, dt_s: float, frozen: Collection[str] = ()
) -> DriveArrays:
    """The drive for the kernels: the largest step of one sample, and by how much a step may differ from the last."""
    base = find_wheels(robot, drive)
    most = max_steps(robot)
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
        largest=by_step(largest, base, others),
        change=_shares(by_step(change, base, others), by_step(largest, base, others)),
        half_track=half_track,
        wheel_travel=wheel_travel,
        centre_body=tree.frame_body[centre],
        p_body_centre=_to_packed(robot, centre),
        max_distance=np.inf if limits.max_distance_m is None else float(limits.max_distance_m),
    )


def max_steps(robot: Robot) -> Floats:
    """[N] m or rad: what a joint moves in one sample at most."""
    return np.where(robot.is_prismatic, MAX_STEP_M, MAX_STEP_RAD)


def _wheels_of(limits: MotionLimits, wheels: Wheels | None, dt_s: float) -> tuple[float, float]:
    """Half track, and how far a wheel rolls in a sample at most, in m: any way for wheels without a limit, or none."""
    if wheels is None:
        return 0.0, np.inf
    fastest = limits.wheel_speed_rad_s
    return wheels.half_track_m, np.inf if fastest is None else float(fastest * wheels.radius_m * dt_s)


def by_step(values: Floats, base: Ints, others: Ints) -> Floats:
    """Values by coordinate [N] as values by entry of a step [D]: a base drives with the lower of those of x and y."""
    if base[0] < 0:
        return values[others]
    return np.concatenate([[min(values[base[0]], values[base[1]]), values[base[2]]], values[others]])


def _shares(change: Floats, largest: Floats) -> Floats:
    """Changes as shares of the largest step [D]; what is frozen has none to keep."""
    return np.divide(change, largest, out=np.full(len(change), np.inf), where=largest > 0.0)


def _to_packed(robot: Robot, frame: str) -> Floats:
    """Origin of a frame in its packed body [3], m."""
    return pack_robot(robot).T_body_frame[frame_names(robot).index(frame), :, 3].copy()
