"""How far a robot moves: sqrt(sum (w_j dq_j)^2), with a weight for each joint."""

from collections.abc import Mapping
from functools import lru_cache

import numpy as np

from ikde.errors import InputError, nearest, quoted
from ikde.kernels.arrays import Floats, read_only
from ikde.model.base_motion import find_planar_base
from ikde.model.numbers import is_number
from ikde.model.robot import Robot

Weights = Mapping[str, float]
"""Weights by joint name, per m or rad."""

MIN_WEIGHT, MAX_WEIGHT = (
    1e-6,
    1e6,
)  # of a weight, per m or rad: beyond, a share of rounding would be another joint's motion


def read_weights(robot: Robot, weights: Weights | None) -> Floats:
    """Weights [N] per m or rad, those that are not given by default; raises `InputError` for what does not fit."""
    if weights is None:
        return default_weights(robot)
    if not isinstance(weights, Mapping):
        raise InputError(f"expected weights by joint name, got {weights!r}", ("weights",))
    read, names = default_weights(robot).copy(), robot.joint_names
    for name, value in weights.items():
        if name not in names:
            raise InputError(f"{robot.name} has no joint {name!r}{nearest(str(name), names)}", ("weights", str(name)))
        if not is_number(value) or not MIN_WEIGHT <= value <= MAX_WEIGHT:
            raise InputError(
                f"expected a number from {MIN_WEIGHT:g} to {MAX_WEIGHT:g}, got {quoted(value)}", ("weights", name)
            )
        read[names.index(name)] = value
    return read_only(read)


@lru_cache(maxsize=64)
def default_weights(robot: Robot) -> Floats:
    """Weights [N]: 1 / range, or 1 / (2 pi) for a joint without limits; 1 / m for a planar base.

    So a joint's whole range counts as much as that of any other, and as much as one metre of driving.
    """
    lower, upper = robot.drawn
    widths = upper - lower
    widths[[k for k in find_planar_base(robot)[:2] if k >= 0]] = 1.0
    return read_only(np.clip(1.0 / np.where(widths > 0.0, widths, 1.0), MIN_WEIGHT, MAX_WEIGHT))


def measure_motion(weights: Floats, start: Floats, q: Floats) -> Floats:
    """sqrt(sum (w_j dq_j)^2) [...] from `start` [N] to `q` [..., N], in m and rad, with weights [N] per m or rad."""
    return np.sqrt(np.sum((weights * (q - start)) ** 2, axis=-1))


def limit_margin(lower: Floats, upper: Floats, q: Floats) -> Floats:
    """Smallest distance [...] of a joint of `q` [..., N] from its limits [N], as a share of its range.

    From 0 at a limit to 1/2 in the middle; joints that have no limits or cannot move are left out (1/2 if all are).
    """
    widths = upper - lower
    counts = np.isfinite(widths) & (widths > 0.0)
    room = np.minimum(q - lower, upper - q)[..., counts] / widths[counts]
    return room.min(axis=-1, initial=0.5)
