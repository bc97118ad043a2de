"""Whether configurations are free: the yes or no of the search, by the tables of any robot in any world.

One after the other, each left at the first that is too near; compiled once for all robots.
"""

import numpy as np

from ikde.kernels.flat_arguments import unpack_models
from ikde.kernels.jit import kernel, leaf_kernel
from ikde.kernels.placing import place_bodies, place_bounds
from ikde.kernels.world import find_placed_obstacle, find_placed_pair


@leaf_kernel
def is_free_at(robot, collision, q, T_world_body, bounds, centres):
    """True if nothing is too near at `q` [N]; the other arrays are room: [B, 3, 4], [C, 4], [3, S]."""
    place_bodies(robot, q, T_world_body)
    place_bounds(collision, T_world_body, bounds)
    if find_placed_pair(collision, T_world_body, bounds, centres, 0) >= 0:
        return False
    return collision.world.size == 0 or find_placed_obstacle(collision, T_world_body, bounds, centres) < 0


@kernel
def judge_rows(numbers, whole, q, out_free):
    """Whether each row of `q` [K, N] is free, into `out_free` [K]; models as `unpack_models` takes them."""
    robot, collision = unpack_models(numbers, whole)
    T_world_body, centres = np.empty((robot.bodies.shape[0], 3, 4)), np.empty((3, collision.radius.size))
    bounds = np.empty((collision.components.shape[0], 4))
    for row in range(q.shape[0]):
        out_free[row] = is_free_at(robot, collision, q[row], T_world_body, bounds, centres)
