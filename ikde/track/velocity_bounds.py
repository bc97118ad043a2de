"""Between which values the speeds of one instant may lie: speed limits, accelerations, ends of ranges, wheels."""

from typing import NamedTuple

import numpy as np

from ikde.kernels.arrays import Floats, Ints
from ikde.model.base_motion import find_planar_base, usual_drive
from ikde.model.robot import Robot
from ikde.model.wheels import wheel_names, wheels_by_twist
from ikde.solver.priority import Bounds
from ikde.track.limits import MotionLimits

FREE = 1e6  # m/s, rad/s: what has no limit


class NamedBounds(NamedTuple):
    """Bounds of the speeds that are sought, and what each is called at either end."""

    bounds: Bounds
    rows_by_joint: Floats
    """[C, N]: the same rows by the joints."""
    names: tuple[str, ...]
    low: tuple[str, ...]
    """Which limit the lower value comes from: `speed`, `acceleration` or `range`."""
    high: tuple[str, ...]


class Motion(NamedTuple):
    """What the bounds of an instant depend on."""

    q: Floats
    """[N]"""
    mapping: Floats
    """[N, n]: speeds of all joints of those that are sought."""
    dt_s: float
    before: Floats | None
    """[N] speeds of the instant before; None: unknown, and no acceleration is limited."""


def make_bounds(robot: Robot, limits: MotionLimits, motion: Motion) -> NamedBounds:
    """All bounds of the speeds that are sought, in which standing still is always one of the answers but for `before`.

    Ranges and speeds come before accelerations: where these leave nothing of those, the nearest value is all there is.
    """
    rows = [*_list_joints(robot, limits, motion), *_list_wheels(robot, limits, motion)]
    by_joint = np.array([row[1] for row in rows]).reshape(len(rows), len(motion.q))
    lower, upper = np.array([row[2] for row in rows]), np.array([row[3] for row in rows])
    bounds = Bounds(by_joint @ motion.mapping, lower, upper)
    names, low, high = tuple(row[0] for row in rows), tuple(row[4] for row in rows), tuple(row[5] for row in rows)
    return NamedBounds(bounds, by_joint, names, low, high)


Row = tuple[str, Floats, float, float, str, str]
"""Name, row by the joints [N], least and largest value, and where these come from."""


def _list_joints(robot: Robot, limits: MotionLimits, motion: Motion) -> list[Row]:
    lower, upper = robot.lower, robot.upper
    base, size = find_planar_base(robot), len(robot.joints)
    speed = np.full(size, FREE) if limits.speed is None else np.minimum(limits.speed, FREE)
    acceleration = np.full(size, np.inf) if limits.acceleration is None else limits.acceleration
    on_wheels = base[0] >= 0 and usual_drive(robot) == "differential"
    rows = []
    for k, name in enumerate(robot.joint_names):
        own_speed, own_acceleration = float(speed[k]), float(acceleration[k])
        if on_wheels and k in base[:2]:  # x and y of a base on two wheels: its speed along the heading is limited
            own_speed, own_acceleration = FREE, np.inf
        room = (lower[k] - motion.q[k], upper[k] - motion.q[k]) if limits.ranges else (-np.inf, np.inf)
        before = None if motion.before is None else float(motion.before[k])
        ends = _find_ends(own_speed, own_acceleration, room, motion.dt_s, before)
        if motion.mapping[k].any() and (ends[0] > -FREE or ends[1] < FREE):
            rows.append((name, np.eye(size)[k], *ends))
    if on_wheels:
        along = _find_forward(motion.q, base)
        before = None if motion.before is None else float(along @ motion.before)
        own = float(speed[base[:2]].min()), float(acceleration[base[:2]].min())
        rows.append(("base forward", along, *_find_ends(*own, (-np.inf, np.inf), motion.dt_s, before)))
    return rows


def _list_wheels(robot: Robot, limits: MotionLimits, motion: Motion) -> list[Row]:
    fastest = limits.wheel_speed_rad_s
    drive = usual_drive(robot)
    if robot.wheels is None or fastest is None or find_planar_base(robot)[0] < 0 or drive == "omnidirectional":
        return []
    base = find_planar_base(robot)
    forward = _find_forward(motion.q, base)
    left, omega = np.zeros_like(forward), np.zeros_like(forward)
    left[base[:2]], omega[base[2]] = [-forward[base[1]], forward[base[0]]], 1.0
    rows = wheels_by_twist(robot.wheels) @ np.array([forward, left, omega])
    return [
        (name, row, -fastest, fastest, "speed", "speed")
        for name, row in zip(wheel_names(robot.wheels), rows, strict=True)
    ]


def _find_forward(q: Floats, base: Ints) -> Floats:
    """The row [N] that makes the speed of a base along its heading of the speeds of the joints."""
    along = np.zeros(len(q))
    along[base[0]], along[base[1]] = np.cos(q[base[2]]), np.sin(q[base[2]])
    return along


def _find_ends(
    speed: float, acceleration: float, room: tuple[float, float], dt_s: float, before: float | None
) -> tuple[float, float, str, str]:
    """Least and largest speed of one joint, and where each comes from."""
    down, up = -_stop_before(-room[0], acceleration, dt_s), _stop_before(room[1], acceleration, dt_s)
    low, low_why = (down, "range") if down > -speed else (-speed, "speed")
    high, high_why = (up, "range") if up < speed else (speed, "speed")
    if before is not None and acceleration < np.inf:
        least, most = before - acceleration * dt_s, before + acceleration * dt_s
        if least > low:
            low, low_why = min(least, high), "acceleration" if least < high else high_why
        if most < high:
            high, high_why = max(most, low), "acceleration" if most > low else low_why
    return low, high, low_why, high_why


def _stop_before(room: float, acceleration: float, dt_s: float) -> float:
    """The largest speed from which a joint still stops within `room`, slowed down once every `dt_s` from the next on.

    Stopping from n accelerations takes n (n + 1) / 2 of a dt^2 and, between two of those, a share of the next. A joint
    that is already outside has no room: it does not go farther, and nothing throws it back.
    """
    room = max(room, 0.0)
    if room == np.inf:
        return np.inf
    step = acceleration * dt_s * dt_s
    if step in (np.inf, 0.0):
        return room / dt_s
    n = np.floor(0.5 * (np.sqrt(1.0 + 8.0 * room / step) - 1.0))
    return float(n * acceleration * dt_s + (room - 0.5 * n * (n + 1.0) * step) / ((n + 1.0) * dt_s))
