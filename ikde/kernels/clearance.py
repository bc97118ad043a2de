"""Self-collision by the distances between sphere centres [Qiao2021, eq. 19, 21].

Two questions, two kernels: *does it collide* stops at the first contact; *how far apart* finds the smallest clearance,
min over the model's pairs of distance - R_i - R_j, and the pair it belongs to.
"""

import math

import numpy as np

from ikde.kernels.arrays import FIRST, LAST
from ikde.kernels.frames import compute_bodies
from ikde.kernels.jit import inline_kernel, kernel
from ikde.kernels.spheres import compute_bounds, compute_centres
from ikde.kernels.world_grades import compute_world_clearance
from ikde.kernels.world_grid import count_obstacles, find_obstacle

DEPTH_STEP = 1e-9  # m: depths are whole steps, at least one, so that rounding noise cannot decide between equals


@inline_kernel
def bounds_are_apart(collision, bounds, a, b, distance):
    """True if the bounding spheres alone prove that two components are farther apart than `distance`."""
    dx, dy, dz = bounds[a, 0] - bounds[b, 0], bounds[a, 1] - bounds[b, 1], bounds[a, 2] - bounds[b, 2]
    limit = collision.bounds[a, 3] + collision.bounds[b, 3] + distance
    return limit >= 0.0 and dx * dx + dy * dy + dz * dz > limit * limit


@inline_kernel
def is_touched(collision, centres, a, px, py, pz, reach):
    """True if a sphere of component `a` is within `reach` of the point (px, py, pz).

    The loop counts instead of leaving early, so that the compiler can vectorise it.
    """
    x, y, z, radius = centres[0], centres[1], centres[2], collision.radius
    hits = 0
    for i in range(collision.components[a, FIRST], collision.components[a, LAST]):
        dx, dy, dz, limit = x[i] - px, y[i] - py, z[i] - pz, radius[i] + reach
        hits += dx * dx + dy * dy + dz * dz <= limit * limit
    return hits > 0


@inline_kernel
def pair_collides(collision, centres, a, b):
    """True if a sphere of component `a` is within the safe distance of a sphere of component `b`."""
    for j in range(collision.components[b, FIRST], collision.components[b, LAST]):
        reach = collision.radius[j] + collision.safe_distance
        if is_touched(collision, centres, a, centres[0, j], centres[1, j], centres[2, j], reach):
            return True
    return False


@inline_kernel
def find_colliding_pair(collision, bounds, centres):
    """Index of the first pair of components within the safe distance, pairs + obstacle if a world is in the way, or -1.

    The search asks this and `compute_clearance` grades: of the robot's own pairs they share no code.
    """
    pair = find_own_pair(collision, bounds, centres)
    if pair < 0 and collision.world.size > 0:
        return find_obstacle(collision, bounds, centres)
    return pair


@inline_kernel
def find_own_pair(collision, bounds, centres):
    """Index of the first pair of components within the safe distance, or -1."""
    return find_pair_from(collision, bounds, centres, 0)


@inline_kernel
def find_pair_from(collision, bounds, centres, first):
    """The same of the pairs from `first` on.

    From coarse to fine: both bounding spheres, the spheres of one against the bounding sphere of the other, all.
    """
    for pair in range(first, collision.pairs.shape[0]):
        a, b = collision.pairs[pair, 0], collision.pairs[pair, 1]
        x, y, z, reach = bounds[b, 0], bounds[b, 1], bounds[b, 2], collision.bounds[b, 3] + collision.safe_distance
        dx, dy, dz, limit = bounds[a, 0] - x, bounds[a, 1] - y, bounds[a, 2] - z, collision.bounds[a, 3] + reach
        if dx * dx + dy * dy + dz * dz > limit * limit or not is_touched(collision, centres, a, x, y, z, reach):
            continue
        if pair_collides(collision, centres, a, b):
            return np.int64(pair)
    return np.int64(-1)


@inline_kernel
def collides(collision, bounds, centres):
    """True if any pair of components is within the safe distance."""
    return find_colliding_pair(collision, bounds, centres) >= 0


@inline_kernel
def find_closest_spheres(collision, centres, a, b):
    """Smallest distance - R_i - R_j between two components in m, negative where they overlap, and its spheres i, j."""
    smallest, first, second = math.inf, collision.components[a, FIRST], collision.components[b, FIRST]
    for i in range(collision.components[a, FIRST], collision.components[a, LAST]):
        for j in range(collision.components[b, FIRST], collision.components[b, LAST]):
            dx, dy, dz = (
                centres[0, i] - centres[0, j],
                centres[1, i] - centres[1, j],
                centres[2, i] - centres[2, j],
            )
            gap = math.sqrt(dx * dx + dy * dy + dz * dz) - collision.radius[i] - collision.radius[j]
            if gap < smallest:
                smallest, first, second = gap, i, j
    return smallest, first, second


@kernel
def compute_clearance(collision, bounds, centres):
    """Smallest clearance over all pairs in m, and the index of its pair (inf and -1 if there are no pairs).

    Of a world it is that of `compute_world_clearance`, where that is smaller.
    A pair whose bounding spheres are already farther apart than the smallest clearance so far is skipped.
    """
    smallest, closest = math.inf, -1
    for pair in range(collision.pairs.shape[0]):
        a, b = collision.pairs[pair, 0], collision.pairs[pair, 1]
        if bounds_are_apart(collision, bounds, a, b, smallest):
            continue
        gap, _, _ = find_closest_spheres(collision, centres, a, b)
        if gap < smallest:
            smallest, closest = gap, pair
    if collision.world.size > 0:
        gap, place = compute_world_clearance(collision, centres, smallest)
        if gap < smallest:
            smallest, closest = gap, place
    return smallest, closest


@kernel
def compute_depth(collision, T_world_body, bounds, centres):
    """Penetration beyond the safe distance in m, 0 if free. `bounds` [C, 3] and `centres` [3, S] are buffers."""
    compute_bounds(collision, T_world_body, bounds)
    compute_centres(collision, T_world_body, centres)
    if not collides(collision, bounds, centres):
        return 0.0
    clearance, _ = compute_clearance(collision, bounds, centres)
    return max(np.rint((collision.safe_distance - clearance) / DEPTH_STEP), 1.0) * DEPTH_STEP


@kernel
def count_colliding_pairs(collision, bounds, centres, out_counts):
    """Add 1 to `out_counts` [P + O] for each pair within the safe distance, and each obstacle that is too near."""
    for pair in range(collision.pairs.shape[0]):
        if pair_collides(collision, centres, collision.pairs[pair, 0], collision.pairs[pair, 1]):
            out_counts[pair] += 1
    if collision.world.size > 0:
        count_obstacles(collision, bounds, centres, out_counts)


@kernel
def judge_centres(robot, collision, qs, out_collides):
    """Whether each row of `qs` [n, N] collides, into `out_collides` [n]."""
    T_world_body = np.empty((robot.bodies.shape[0], 3, 4))
    bounds = np.empty((collision.components.shape[0], 3))
    centres = np.empty((3, collision.radius.size))
    for row in range(qs.shape[0]):
        compute_bodies(robot, qs[row], T_world_body)
        compute_bounds(collision, T_world_body, bounds)
        compute_centres(collision, T_world_body, centres)
        out_collides[row] = collides(collision, bounds, centres)
