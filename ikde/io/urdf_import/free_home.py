"""A home configuration that is free: the given one, or the nearest that is found."""

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.collision_model import CollisionModel
from ikde.solver.plain import compute_gaps

RINGS = tuple(2.0**-k for k in range(8, -1, -1))
"""Half widths around home, as shares of the joints' ranges."""
DRAWS, HALVINGS = 128, 20
MARGIN_M = 1e-3  # beyond the safe distance, of a home that is moved: none stands at a contact


def find_free_home(collision: CollisionModel, home: Floats) -> Floats | None:
    """`home` [N] itself if it is free, else a free configuration near it; None if none is found.

    Configurations are drawn from growing boxes around home, the same every time; the nearest free one of the first box
    that has any gets back each joint's home that leaves it free, one by one, and then moves back towards home as far as
    the straight line stays free.
    """
    if _are_free(collision, home[None], 0.0)[0]:
        return home
    robot = collision.robot
    lower, upper = robot.finite_limits(home, 0.5)
    width = np.where(robot.is_prismatic, np.minimum(upper - lower, 1.0), upper - lower)
    draw = np.random.default_rng(0)
    for share in RINGS:
        steps = draw.uniform(-share, share, (DRAWS, len(home))) * width
        drawn = np.clip(home + steps, lower, upper)
        free = drawn[_are_free(collision, drawn)]
        if len(free):
            far = free[np.argmin(np.abs((free - home) / np.maximum(width, 1e-9)).max(axis=1))]
            return _move_back(collision, home, _restore(collision, home, far))
    return None


def _restore(collision: CollisionModel, home: Floats, free: Floats) -> Floats:
    """Joints at home again, but for those that make it free."""
    for joint in range(len(home)):
        tried = np.where(np.arange(len(home)) == joint, home, free)
        free = tried if _are_free(collision, tried[None])[0] else free
    return free


def _move_back(collision: CollisionModel, home: Floats, free: Floats) -> Floats:
    taken, given = 0.0, 1.0
    for _ in range(HALVINGS):
        middle = 0.5 * (taken + given)
        if _are_free(collision, (home + middle * (free - home))[None])[0]:
            given = middle
        else:
            taken = middle
    rounded = np.round(home + given * (free - home), 4)
    is_good = np.all((rounded >= collision.robot.lower) & (rounded <= collision.robot.upper))
    return rounded if is_good and _are_free(collision, rounded[None])[0] else home + given * (free - home)


def _are_free(collision: CollisionModel, q: Floats, margin_m: float = MARGIN_M) -> np.ndarray:
    """Which of `q` [n, N] are free by more than a margin."""
    return compute_gaps(collision, q).min(axis=-1) > collision.limit_m + margin_m
