"""Between which values the speeds of one instant may lie: speed limits, accelerations, ends of ranges, wheels."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ikde.kernels.arrays import Floats, Ints
from ikde.model.base_motion import find_planar_base, usual_drive
from ikde.model.robot import Robot, Wheels
from ikde.model.wheels import wheel_names, wheels_by_twist
from ikde.solver.priority import Bounds
from ikde.track.limits import MotionLimits

FREE = 1e6  # m/s, rad/s: what has no limit
REASONS = np.array(["speed", "range", "acceleration"], dtype=object)
BY_ACCELERATION = 2


class NamedBounds(NamedTuple):
    """Bounds of the speeds that are sought, and what each is called at either end."""

    bounds: Bounds
    rows_by_joint: Floats
    """[C, N]: the same rows by the joints."""
    joints: Ints
    """[C] place in q of the joint that a row is of alone; -1 of other rows."""
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
    rows = _Rows(*(np.concatenate(parts) for parts in zip(*_list_rows(robot, limits, motion), strict=True)))
    bounds = Bounds(rows.by_joint @ motion.mapping, rows.lower, rows.upper)
    names, low, high = (tuple(words.tolist()) for words in (rows.names, REASONS[rows.low], REASONS[rows.high]))
    return NamedBounds(bounds, rows.by_joint, rows.joints, names, low, high)


class _Rows(NamedTuple):
    """Rows by the joints, their ends, and where these come from: places in `REASONS`."""

    names: NDArray[np.object_]
    joints: Ints
    by_joint: Floats
    lower: Floats
    upper: Floats
    low: Ints
    high: Ints


def _list_rows(robot: Robot, limits: MotionLimits, motion: Motion) -> list[_Rows]:
    base = find_planar_base(robot)
    drive = usual_drive(robot) if base[0] >= 0 else "omnidirectional"
    rows = [_list_joints(robot, limits, motion, base[:2] if drive == "differential" else base[:0])]
    if drive == "differential":
        rows.append(_list_forward(limits, motion, base))
    if robot.wheels is not None and limits.wheel_speed_rad_s is not None and drive != "omnidirectional":
        rows.append(_list_wheels(robot.wheels, limits.wheel_speed_rad_s, motion, base))
    return rows


def _list_joints(robot: Robot, limits: MotionLimits, motion: Motion, held_by_forward: Ints) -> _Rows:
    """Of every joint that is sought; x and y of a base on two wheels have ranges alone."""
    size = len(motion.q)
    speed = np.full(size, FREE) if limits.speed is None else np.minimum(limits.speed, FREE)
    acceleration = np.full(size, np.inf) if limits.acceleration is None else limits.acceleration.copy()
    speed[held_by_forward], acceleration[held_by_forward] = FREE, np.inf
    room = np.full((2, size), np.inf)
    if limits.ranges:
        room[0], room[1] = motion.q - robot.lower, robot.upper - motion.q
    lower, upper, low, high = _find_ends(speed, acceleration, room, motion.dt_s, motion.before)
    some = np.flatnonzero(motion.mapping.any(axis=1) & ((lower > -FREE) | (upper < FREE)))
    names = np.array(robot.joint_names, dtype=object)[some]
    return _Rows(names, some, np.eye(size)[some], lower[some], upper[some], low[some], high[some])


def _list_forward(limits: MotionLimits, motion: Motion, base: Ints) -> _Rows:
    """Of a base on two wheels: along its heading it is held to the lower limit of those of x and y."""
    along = _find_forward(motion.q, base)
    speed = np.full(1, FREE if limits.speed is None else limits.speed[base[:2]].min())
    acceleration = np.full(1, np.inf if limits.acceleration is None else limits.acceleration[base[:2]].min())
    before = None if motion.before is None else along @ motion.before[:, None]
    ends = _find_ends(np.minimum(speed, FREE), acceleration, np.full((2, 1), np.inf), motion.dt_s, before)
    return _Rows(np.array(["base forward"], dtype=object), np.full(1, -1), along[None], *ends)


def _list_wheels(wheels: Wheels, fastest: float, motion: Motion, base: Ints) -> _Rows:
    forward = _find_forward(motion.q, base)
    left, omega = np.zeros_like(forward), np.zeros_like(forward)
    left[base[:2]], omega[base[2]] = [-forward[base[1]], forward[base[0]]], 1.0
    by_joint = wheels_by_twist(wheels) @ np.array([forward, left, omega])
    count = len(by_joint)
    ends, speeds, names = np.full(count, fastest), np.zeros(count, dtype=np.int64), np.array(wheel_names(wheels))
    return _Rows(names.astype(object), np.full(count, -1), by_joint, -ends, ends, speeds, speeds)


def _find_forward(q: Floats, base: Ints) -> Floats:
    """The row [N] that makes the speed of a base along its heading of the speeds of the joints."""
    along = np.zeros(len(q))
    along[base[0]], along[base[1]] = np.cos(q[base[2]]), np.sin(q[base[2]])
    return along


def _find_ends(
    speed: Floats, acceleration: Floats, room: Floats, dt_s: float, before: Floats | None
) -> tuple[Floats, Floats, Ints, Ints]:
    """Least and largest speeds [n] for `room` [2, n] down and up, and where each comes from."""
    down, up = (_stop_before(side, acceleration, dt_s) for side in room)
    low, high = -np.minimum(down, speed), np.minimum(up, speed)
    low_why, high_why = (down < speed).astype(np.int64), (up < speed).astype(np.int64)
    if before is None or not np.isfinite(acceleration).any():
        return low, high, low_why, high_why
    change = acceleration * dt_s
    least, most = before - change, before + change
    low_why = np.where(least >= high, high_why, np.where(least > low, BY_ACCELERATION, low_why))
    high_why = np.where(most <= low, low_why, np.where(most < high, BY_ACCELERATION, high_why))
    return np.clip(least, low, high), np.clip(most, low, high), low_why, high_why


def _stop_before(room: Floats, acceleration: Floats, dt_s: float) -> Floats:
    """The largest speeds [n] from which joints still stop within `room`, slowed down every `dt_s` from the next on.

    Stopping from n accelerations takes n (n + 1) / 2 of a dt^2 and, between two of those, a share of the next. A joint
    that is already outside has no room: it does not go farther, and nothing throws it back.
    """
    room = np.maximum(room, 0.0)
    brakes = np.isfinite(acceleration) & np.isfinite(room)
    if not brakes.any():
        return room / dt_s
    step = np.where(brakes, acceleration, 1.0) * dt_s * dt_s
    way = np.where(brakes, room, 0.0)
    n = np.floor(0.5 * (np.sqrt(1.0 + 8.0 * way / step) - 1.0))
    return np.where(brakes, (way + 0.5 * n * (n + 1.0) * step) / ((n + 1.0) * dt_s), room / dt_s)
