"""What of a world is near a robot, and how the joints change its distances: rows of a step along a path.

Of each component and each solid the nearest sphere counts. The way out is the gradient of the solid's distance, taken
by differences: so every kind of solid, and a cloud, has one.
"""

import math
from typing import NamedTuple

import numpy as np

from ikde.kernels.arrays import BODY, FIRST, LAST, Floats, Ints
from ikde.kernels.contacts import add_chain
from ikde.kernels.flat_arguments import unpack_world
from ikde.kernels.jit import counting_kernel, inline_kernel, kernel
from ikde.kernels.obstacles import OWNER, is_apart, solid_gap

STEP = 1e-6  # m, of a difference
COMPONENT, SPHERE, PLACE = range(3)  # columns of `WorldContacts.found`


class WorldContacts(NamedTuple):
    """The nearest spheres and solids."""

    gap: Floats  # [K] distance less what is asked for, m
    found: Ints  # [K, 3] component, sphere, and place in the table of clearances
    normal: Floats  # [K, 3] out of the solid; 0 where there is no way out


@kernel
def make_world_contacts(size):
    """Room for so many."""
    return WorldContacts(np.empty(size), np.empty((size, 3), dtype=np.int64), np.empty((size, 3)))


@kernel
def set_normal(world, s, x, y, z, gap, out_normal):
    """Gradient of the distance of a point from solid `s`, of length 1 or 0; `gap` is about that distance, m."""
    reach = gap + 10.0 * STEP
    square = 0.0
    for k in range(3):
        dx, dy, dz = STEP if k == 0 else 0.0, STEP if k == 1 else 0.0, STEP if k == 2 else 0.0
        ahead = solid_gap(world, s, x + dx, y + dy, z + dz, reach, -math.inf)
        slope = ahead - solid_gap(world, s, x - dx, y - dy, z - dz, reach, -math.inf)
        out_normal[k] = slope
        square += slope * slope
    if square > 0.0:
        length = math.sqrt(square)
        for k in range(3):
            out_normal[k] /= length


@inline_kernel
def choose_place(gap, count, smallest):
    """Where a contact of this gap goes among the first `count`: the end, in place of the farthest, or -1."""
    if count < gap.size:
        return count
    place = 0
    for other in range(1, count):
        if gap[other] > gap[place]:
            place = other
    return place if smallest < gap[place] else -1


@counting_kernel
def find_world_contacts(collision, bounds, centres, reach, out_gap, out_found, out_normal):
    """Find what is nearer than `reach` beyond what is asked for, the nearest K if there is more; returns how many.

    `bounds` [C, 3] and `centres` [3, S] in the world, m; `out_*`: the arrays of `WorldContacts`.
    """
    world = unpack_world(collision.world)
    pairs, obstacles, count = collision.pairs.shape[0], world.asked.shape[1], 0
    for component in range(collision.components.shape[0]):
        for s in range(world.solids.shape[0]):
            owner = int(world.solids[s, OWNER])
            asked = world.asked[component, owner]
            if asked == -math.inf:
                continue
            x, y, z = bounds[component, 0], bounds[component, 1], bounds[component, 2]
            if is_apart(world, s, x, y, z, collision.bounds[component, 3] + asked + reach):
                continue
            best, sphere = asked + reach, -1
            for i in range(collision.components[component, FIRST], collision.components[component, LAST]):
                limit = best + collision.radius[i]
                gap = solid_gap(world, s, centres[0, i], centres[1, i], centres[2, i], limit, -math.inf)
                if gap - collision.radius[i] < best:
                    best, sphere = gap - collision.radius[i], np.int64(i)
            if sphere < 0:
                continue
            place = choose_place(out_gap, count, best - asked)
            if place < 0:
                continue
            count = max(count, place + 1)
            out_gap[place], out_found[place, COMPONENT], out_found[place, SPHERE] = best - asked, component, sphere
            out_found[place, PLACE] = pairs + component * obstacles + owner
            x, y, z = centres[0, sphere], centres[1, sphere], centres[2, sphere]
            set_normal(world, s, x, y, z, best + collision.radius[sphere], out_normal[place])
    return count


@inline_kernel
def fill_world_gradient(robot, collision, T_world_body, centres, contacts, k, out_row):
    """Gradient of the gap of contact `k` by the joints, into `out_row` [N]."""
    for column in range(out_row.size):
        out_row[column] = 0.0
    i, normal = contacts.found[k, SPHERE], contacts.normal
    body = collision.components[contacts.found[k, COMPONENT], BODY]
    x, y, z = centres[0, i], centres[1, i], centres[2, i]
    add_chain(robot, T_world_body, body, x, y, z, normal[k, 0], normal[k, 1], normal[k, 2], out_row)
