"""What holds a step of a servo, in words."""

from typing import Any, NamedTuple

from ikde.kernels.arrays import Floats
from ikde.kernels.servo_room import (
    ACCELERATION,
    APPROACH,
    BASE_ROW,
    BOX,
    DISTANCE_ROW,
    ERROR,
    HELD,
    HELD_BY,
    HELD_SIDE,
    HELD_VALUE,
    HELD_WHY,
    NOTHING,
    RANGE,
    REACH,
    SPEED,
)
from ikde.model.collision_model import CollisionModel
from ikde.track.limits import MotionLimits
from ikde.track.servo_plan import ServoPlan
from ikde.track.servo_result import Held


class Holding(NamedTuple):
    """What a step's kernel said, and what it means it of."""

    collision: CollisionModel
    entries: tuple[str, ...]
    limits: MotionLimits
    plan: ServoPlan
    numbers: Floats
    codes: Any
    speeds: Floats
    q: Floats
    dt_s: float


def no_target(wrong: str | None) -> Held | None:
    """Why a step without a target brakes."""
    return None if wrong is None else Held(kind="target", names=(), text=f"no target: {wrong}")


def tell_held(holding: Holding, is_there: bool) -> Held | None:
    """The constraint that holds a step; None if the tool is where it should be."""
    held = holding.codes.item(HELD)
    if is_there or held == NOTHING:
        return None
    if held == REACH:
        error = holding.numbers.item(ERROR)
        text = f"the reach: no joint brings the tool nearer than {1e3 * error:.4g} mm"
        return Held(kind="reach", names=(), value=error, text=text)
    if held == BOX:
        return _tell_entry(holding)
    place = holding.codes.item(HELD_BY)
    return _tell_place(holding, place) if place >= 0 else _tell_row(holding, place)


def _tell_entry(holding: Holding) -> Held:
    entry, why = holding.codes.item(HELD_BY), holding.codes.item(HELD_WHY)
    name, sign = holding.entries[entry], 2 * holding.codes.item(HELD_SIDE) - 1
    robot, rates = holding.collision.robot, holding.plan.rates
    joint = robot.joint_names.index(name) if name in robot.joint_names else -1
    unit = "m" if joint < 0 or robot.is_prismatic[joint] else "rad"
    speed = holding.speeds.item(entry)
    if why == RANGE:
        limit = float((robot.upper if sign > 0 else robot.lower)[joint])
        value = holding.q.item(joint)
        text = f"the range of {name}: {value:.6g} of {limit:.6g} {unit}"
        return Held(kind="range", names=(name,), value=value, limit=limit, text=text)
    if why == SPEED:
        limit = float(rates[0, entry])
        text = f"the speed of {name}: {abs(speed):.4g} of {limit:.4g} {unit}/s"
        return Held(kind="speed", names=(name,), value=speed, limit=limit, text=text)
    assert why in (ACCELERATION, APPROACH)
    limit = float(rates[1, entry])
    to = ", which must stop in time" if why == APPROACH else ""
    text = f"the acceleration of {name}: {limit:.4g} {unit}/s^2 at most{to}, at {speed:.4g} {unit}/s"
    return Held(kind="acceleration", names=(name,), value=speed, limit=limit, text=text)


def _tell_place(holding: Holding, place: int) -> Held:
    collision = holding.collision
    names, extra_m = collision.name_pair(place), collision.extra_m(place)
    distance_m, asked_m = holding.numbers.item(HELD_VALUE) + extra_m, collision.limit_m + extra_m
    is_own = place < len(collision.pairs)
    text = f"{names[0]} and {names[1]}: {1e3 * distance_m:.4g} mm apart, {1e3 * asked_m:.4g} mm at least"
    return Held(kind="pair" if is_own else "object", names=names, value=distance_m, limit=asked_m, text=text)


def _tell_row(holding: Holding, row: int) -> Held:
    if row == BASE_ROW:
        return Held(kind="base", names=holding.entries[:2], text="the range of the base's x or y")
    if row == DISTANCE_ROW:
        limit = holding.limits.max_distance_m
        return Held(kind="distance", names=(), limit=limit, text="the tool's largest distance from the platform")
    limit = holding.limits.wheel_speed_rad_s
    return Held(kind="wheels", names=(), limit=limit, text=f"the wheels: {limit:.4g} rad/s at most")
