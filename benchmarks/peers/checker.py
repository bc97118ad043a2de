"""The sphere checker that collision-blind peers share, and random seeds: ikde's kernels, compiled for one robot.

The packed arrays are constants of the compiled code, so that a call from Python costs 1.7 us; passed as two flat arrays
it costs 3.2 us and as a dozen arrays more. The price is some seconds of compilation in every process.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numba
import numpy as np

import ikde
from ikde.kernels.clearance import collides
from ikde.kernels.frames import compute_bodies
from ikde.kernels.spheres import compute_bounds, compute_centres
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot

_MADE: dict[tuple[str, bytes, bytes], "Checker"] = {}


@dataclass(frozen=True)
class Checker:
    """Compiled functions of one robot and its default detector."""

    is_free: Callable[[np.ndarray], bool]
    """q [N] -> True without self-collision."""
    draw: Callable[[], np.ndarray]
    """Uniform joint values [N] inside the limits."""
    draw_free: Callable[[], np.ndarray]
    """The same, free of self-collision."""
    begin: Callable[[int], None]
    """Start the random numbers."""


def make_checker(robot: ikde.Robot, seed: int) -> Checker:
    """The checker of a robot and its default detector; compiled once a process and robot."""
    key = (robot.name, robot.lower.tobytes(), robot.upper.tobytes())
    if key not in _MADE:
        _MADE[key] = _compile(robot)
    _MADE[key].begin(seed)
    return _MADE[key]


def _compile(robot: ikde.Robot) -> Checker:
    arrays, spheres = pack_robot(robot), CollisionModel.of(robot).arrays
    lower, upper, joints = robot.lower, robot.upper, len(robot.joints)
    bodies, components, count = len(arrays.bodies), len(spheres.components), spheres.radius.size

    @numba.njit(error_model="numpy")
    def is_free(q):
        T_world_body = np.empty((bodies, 3, 4))
        bounds = np.empty((components, 3))
        centres = np.empty((3, count))
        compute_bodies(arrays, q, T_world_body)
        compute_bounds(spheres, T_world_body, bounds)
        compute_centres(spheres, T_world_body, centres)
        return not collides(spheres, bounds, centres)

    @numba.njit
    def draw():
        q = np.empty(joints)
        for k in range(joints):
            q[k] = np.random.uniform(lower[k], upper[k])
        return q

    @numba.njit
    def draw_free():
        while True:
            q = draw()
            if is_free(q):
                return q

    @numba.njit
    def begin(value):
        np.random.seed(value)

    begin(0)
    is_free(draw_free())
    return Checker(is_free, draw, draw_free, begin)
