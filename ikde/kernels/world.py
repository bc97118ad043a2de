"""What written kernels, which hold a robot's own pairs alone, ask of a world: by the tables behind their block.

So are the pairs of what is attached to it, which stand behind the robot's own. Nothing is allocated here, and no view
of an array is counted: on a machine whose other cores are busy that took half of all the time.
"""

import numpy as np

from ikde.kernels.clearance import is_touched, pair_collides
from ikde.kernels.flat_arguments import ATTACHED_PAIRS, cut_models
from ikde.kernels.jit import inline_kernel, leaf_kernel
from ikde.kernels.placing import place_bodies, place_bounds, place_component
from ikde.kernels.world_grid import find_hit

BODIES, COMPONENTS, SPHERES, WORLD_SIZE = 0, 2, 5, 6  # of the sizes that `flat_arguments.unpack_models` begins with


@inline_kernel
def stands_in_world(whole):
    """True if something stands around the robot of a block (`flatten_search`), or is attached to it."""
    return whole[whole[3] + WORLD_SIZE] > 0


@inline_kernel
def count_room(whole):
    """How many numbers `find_obstacle_at` needs room for; none where there is no world."""
    first = whole[3]
    room = 12 * whole[first + BODIES] + 4 * whole[first + COMPONENTS] + 3 * whole[first + SPHERES]
    return room if whole[first + WORLD_SIZE] > 0 else 0


@inline_kernel
def count_room_of(robot, collision):
    """The same of both models as tables."""
    room = 12 * robot.bodies.shape[0] + 4 * collision.components.shape[0] + 3 * collision.radius.size
    return room if collision.world.size > 0 else 0


@leaf_kernel
def find_obstacle_at(numbers, whole, q, room):
    """Of what is attached the first pair that is too near at `q` [N], else pairs + obstacle of the first, or -1.

    `room` is written to: `count_room` numbers, the last of its array.
    """
    robot, collision = cut_models(numbers[whole[2] :], whole[whole[3] :])
    return find_obstacle_of(robot, collision, q, room)


@leaf_kernel
def find_obstacle_of(robot, collision, q, room):
    """The same of both models as tables."""
    bodies, components, spheres = robot.bodies.shape[0], collision.components.shape[0], collision.radius.size
    first = room.size - 12 * bodies - 4 * components - 3 * spheres
    second, third = first + 12 * bodies, first + 12 * bodies + 4 * components
    T_world_body = room[first:second].reshape((bodies, 3, 4))
    bounds, centres = room[second:third].reshape((components, 4)), room[third:].reshape((3, spheres))
    place_bodies(robot, q, T_world_body)
    place_bounds(collision, T_world_body, bounds)
    attached = int(collision.world[ATTACHED_PAIRS])
    if attached > 0:
        pair = find_placed_pair(collision, T_world_body, bounds, centres, collision.pairs.shape[0] - attached)
        if pair >= 0:
            return pair
    return find_placed_obstacle(collision, T_world_body, bounds, centres)


@inline_kernel
def find_placed_pair(collision, T_world_body, bounds, centres, first):
    """Index of the first pair of components from `first` on within the safe distance, or -1.

    As `clearance.find_pair_from`, of bodies and middles that are placed: spheres are, once a component is near another.
    """
    for pair in range(first, collision.pairs.shape[0]):
        a, b = collision.pairs[pair, 0], collision.pairs[pair, 1]
        x, y, z, reach = bounds[b, 0], bounds[b, 1], bounds[b, 2], collision.bounds[b, 3] + collision.safe_distance
        dx, dy, dz, limit = bounds[a, 0] - x, bounds[a, 1] - y, bounds[a, 2] - z, collision.bounds[a, 3] + reach
        if dx * dx + dy * dy + dz * dz > limit * limit:
            continue
        place_component(collision, T_world_body, a, bounds, centres)
        if not is_touched(collision, centres, a, x, y, z, reach):
            continue
        place_component(collision, T_world_body, b, bounds, centres)
        if pair_collides(collision, centres, a, b):
            return np.int64(pair)
    return np.int64(-1)


@inline_kernel
def find_placed_obstacle(collision, T_world_body, bounds, centres):
    """Pairs + obstacle of the first that is found too near, or -1, of bodies and middles that are placed."""
    hit = find_hit(collision, T_world_body, bounds, centres)
    obstacles = np.int64(collision.world[2])
    return np.int64(collision.pairs.shape[0] + hit % obstacles if hit >= 0 else -1)
