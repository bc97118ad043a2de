"""What written kernels, which hold a robot's own pairs alone, ask of a world: by the tables behind their block."""

import numpy as np

from ikde.kernels.flat_arguments import unpack_models
from ikde.kernels.jit import counting_kernel, inline_kernel
from ikde.kernels.tables import place_bodies, place_spheres
from ikde.kernels.world_grid import find_obstacle

WORLD_SIZE = 6  # of the sizes that `flat_arguments.unpack_models` begins with


@inline_kernel
def stands_in_world(whole):
    """True if something stands around the robot of a block (`flatten_search`)."""
    return whole[whole[3] + WORLD_SIZE] > 0


@counting_kernel
def find_obstacle_at(numbers, whole, q):
    """Pairs + obstacle of the first that is too near at `q` [N], or -1."""
    robot, collision = unpack_models(numbers[whole[2] :], whole[whole[3] :])
    return find_obstacle_of(robot, collision, q)


@counting_kernel
def find_obstacle_of(robot, collision, q):
    """The same of both models as tables."""
    T_world_body = np.empty((robot.bodies.shape[0], 3, 4))
    bounds, centres = np.empty((collision.components.shape[0], 3)), np.empty((3, collision.radius.size))
    place_bodies(robot, q, T_world_body)
    place_spheres(collision, T_world_body, bounds, centres)
    return find_obstacle(collision, bounds, centres)
