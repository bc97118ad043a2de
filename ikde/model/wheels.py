"""Wheels of a base and its twist, one from the other; and how much a wheel slips.

A twist is (m/s forward, m/s to the left, rad/s to the left) in the base's own frame. Two driven wheels are left and
right; they have no say in the speed to the left, which is 0. Mecanum wheels are front left, rear left, rear right and
front right, with rollers at 45 degrees whose axes point at the middle, seen from above [Zhang2022, eq. 1].
"""

import numpy as np

from ikde.errors import InputError
from ikde.kernels.arrays import Floats
from ikde.model.robot import Wheels

DIFFERENTIAL = ("wheel_left", "wheel_right")
MECANUM = ("wheel_front_left", "wheel_rear_left", "wheel_rear_right", "wheel_front_right")
FROM_MIDDLE = np.array([[1.0, -1.0, -1.0], [1.0, 1.0, -1.0], [1.0, -1.0, 1.0], [1.0, 1.0, 1.0]])


def wheel_names(wheels: Wheels) -> tuple[str, ...]:
    """What each wheel is called, in their order."""
    return DIFFERENTIAL if wheels.half_wheelbase_m is None else MECANUM


def wheels_by_twist(wheels: Wheels) -> Floats:
    """The matrix [W, 3] that makes wheel speeds in rad/s of a twist: inverse kinematics.

    The speed of two wheels to the left does not count: a twist that has one is none of theirs.
    """
    if wheels.half_wheelbase_m is None:
        side = wheels.half_track_m
        return np.array([[1.0, 0.0, -side], [1.0, 0.0, side]]) / wheels.radius_m
    return FROM_MIDDLE * [1.0, 1.0, wheels.half_track_m + wheels.half_wheelbase_m] / wheels.radius_m


def twist_by_wheels(wheels: Wheels) -> Floats:
    """The matrix [3, W] that makes a twist of wheel speeds in rad/s: forward kinematics.

    It is the pseudo-inverse of the other. Four mecanum wheels in the proportion (1, -1, -1, 1) move nothing, they slip.
    """
    if wheels.half_wheelbase_m is None:
        yaw = 0.5 / wheels.half_track_m
        return np.array([[0.5, 0.5], [0.0, 0.0], [-yaw, yaw]]) * wheels.radius_m
    yaw = 1.0 / (wheels.half_track_m + wheels.half_wheelbase_m)
    return 0.25 * wheels.radius_m * FROM_MIDDLE.T * np.array([[1.0], [1.0], [yaw]])


def wheel_speeds(wheels: Wheels, v: Floats, omega: Floats) -> Floats:
    """Speeds of the left and the right wheel [..., 2] in rad/s (6), of `v` m/s and `omega` rad/s [...]."""
    return np.stack([v - wheels.half_track_m * omega, v + wheels.half_track_m * omega], axis=-1) / wheels.radius_m


def slip_ratio(rim: Floats, ground: Floats) -> Floats:
    """How much wheels slip [...], of the speed of their rims and of the ground below them [...], m/s; from -1 to 1.

    (rim - ground) / the faster of the two [Zhang2022, eq. 14]: above 0 the wheel spins, below 0 it skids, and 0 both
    for none and for a wheel at rest. Backwards it counts as forwards.

    Raises:
        InputError: where rim and ground run against each other.
    """
    rim, ground = np.broadcast_arrays(np.asarray(rim, dtype=float), np.asarray(ground, dtype=float))
    if (rim * ground < 0.0).any():
        raise InputError("expected the rim of a wheel and the ground to run the same way", ("ground",))
    rim, ground = np.abs(rim), np.abs(ground)
    faster = np.maximum(rim, ground)
    return np.divide(rim - ground, faster, out=np.zeros_like(faster), where=faster > 0.0)


def ground_speed(rim: Floats, slip: Floats) -> Floats:
    """The speed of the ground below wheels [...] in m/s, of that of their rims and of their slip [...].

    Exactly what `slip_ratio` is the other way round: rim (1 - s) of a wheel that spins, rim / (1 + s) of one that
    skids.

    Raises:
        InputError: for a slip above 1, or of -1 and below: the rim of a locked wheel says nothing of the ground.
    """
    rim, slip = np.broadcast_arrays(np.asarray(rim, dtype=float), np.asarray(slip, dtype=float))
    if not ((slip > -1.0) & (slip <= 1.0)).all():
        raise InputError("expected a slip above -1, up to 1", ("slip",))
    skids = slip < 0.0
    return np.where(skids, rim / np.where(skids, 1.0 + slip, 1.0), rim * (1.0 - slip))
