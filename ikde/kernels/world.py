"""What written kernels, which hold a robot's own pairs alone, ask of a world: by the tables behind their block.

So are the pairs of what is attached to it, which stand behind the robot's own.
"""

import numpy as np

from ikde.kernels.clearance import find_pair_from
from ikde.kernels.flat_arguments import ATTACHED_PAIRS, unpack_models
from ikde.kernels.jit import counting_kernel, inline_kernel
from ikde.kernels.tables import place_bodies, place_spheres
from ikde.kernels.world_grid import find_obstacle

WORLD_SIZE = 6  # of the sizes that `flat_arguments.unpack_models` begins with


@inline_kernel
def stands_in_world(whole):
    """True if something stands around the robot of a block (`flatten_search`), or is attached to it."""
    return whole[whole[3] + WORLD_SIZE] > 0


@counting_kernel
def find_obstacle_at(numbers, whole, q):
    """Of what is attached the first pair that is too near at `q` [N], else pairs + obstacle of the first, or -1."""
    robot, collision = unpack_models(numbers[whole[2] :], whole[whole[3] :])
    return find_obstacle_of(robot, collision, q)


@counting_kernel
def find_obstacle_of(robot, collision, q):
    """The same of both models as tables."""
    T_world_body = np.empty((robot.bodies.shape[0], 3, 4))
    bounds, centres = np.empty((collision.components.shape[0], 3)), np.empty((3, collision.radius.size))
    place_bodies(robot, q, T_world_body)
    place_spheres(collision, T_world_body, bounds, centres)
    attached = int(collision.world[ATTACHED_PAIRS])
    if attached > 0:
        pair = find_pair_from(collision, bounds, centres, collision.pairs.shape[0] - attached)
        if pair >= 0:
            return pair
    return find_obstacle(collision, bounds, centres)
