"""Self-collision by the distances between sphere centres [Qiao2021, eq. 19, 21].

Two questions, two kernels: *does it collide* stops at the first contact; *how far apart* finds the smallest clearance,
min over the detector's pairs of distance - R_i - R_j, and the pair it belongs to.
"""

import math

from ikde.kernels.jit import kernel


@kernel
def _pair_collides(detector, centres, a, b):
    """True if a sphere of component `a` is within the safe distance of a sphere of component `b`."""
    safe = detector.safe_distance[0]
    for i in range(detector.component_start[a], detector.component_start[a + 1]):
        x, y, z = centres[i, 0], centres[i, 1], centres[i, 2]
        reach = detector.sphere_radius[i] + safe
        for j in range(detector.component_start[b], detector.component_start[b + 1]):
            dx, dy, dz = x - centres[j, 0], y - centres[j, 1], z - centres[j, 2]
            limit = reach + detector.sphere_radius[j]
            if dx * dx + dy * dy + dz * dz <= limit * limit:
                return True
    return False


@kernel
def _bounds_overlap(detector, bounds, a, b):
    """False if the bounding spheres alone prove that two components are apart."""
    dx, dy, dz = bounds[a, 0] - bounds[b, 0], bounds[a, 1] - bounds[b, 1], bounds[a, 2] - bounds[b, 2]
    limit = detector.bound_radius[a] + detector.bound_radius[b] + detector.safe_distance[0]
    return dx * dx + dy * dy + dz * dz <= limit * limit


@kernel
def collides(detector, bounds, centres):
    """True at the first pair of components within the safe distance: bounding spheres first, then the spheres."""
    for pair in range(detector.pair_a.size):
        a, b = detector.pair_a[pair], detector.pair_b[pair]
        if _bounds_overlap(detector, bounds, a, b) and _pair_collides(detector, centres, a, b):
            return True
    return False


@kernel
def compute_pair_clearance(detector, centres, a, b):
    """Smallest distance - R_i - R_j between two components, in m; negative is the depth of penetration."""
    smallest = math.inf
    for i in range(detector.component_start[a], detector.component_start[a + 1]):
        x, y, z = centres[i, 0], centres[i, 1], centres[i, 2]
        for j in range(detector.component_start[b], detector.component_start[b + 1]):
            dx, dy, dz = x - centres[j, 0], y - centres[j, 1], z - centres[j, 2]
            gap = math.sqrt(dx * dx + dy * dy + dz * dz) - detector.sphere_radius[i] - detector.sphere_radius[j]
            smallest = min(smallest, gap)
    return smallest


@kernel
def compute_clearance(detector, bounds, centres):
    """Smallest clearance over all pairs in m, and the index of its pair (inf and -1 if there are no pairs).

    A pair whose bounding spheres are already farther apart than the smallest clearance so far is skipped.
    """
    smallest, closest = math.inf, -1
    for pair in range(detector.pair_a.size):
        a, b = detector.pair_a[pair], detector.pair_b[pair]
        dx, dy, dz = bounds[a, 0] - bounds[b, 0], bounds[a, 1] - bounds[b, 1], bounds[a, 2] - bounds[b, 2]
        floor = smallest + detector.bound_radius[a] + detector.bound_radius[b]
        if floor >= 0.0 and dx * dx + dy * dy + dz * dz > floor * floor:
            continue
        gap = compute_pair_clearance(detector, centres, a, b)
        if gap < smallest:
            smallest, closest = gap, pair
    return smallest, closest


@kernel
def count_colliding_pairs(detector, centres, out_counts):
    """Add 1 to `out_counts` [P] for each pair within the safe distance."""
    for pair in range(detector.pair_a.size):
        if _pair_collides(detector, centres, detector.pair_a[pair], detector.pair_b[pair]):
            out_counts[pair] += 1
