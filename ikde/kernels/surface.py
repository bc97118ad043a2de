"""Self-collision by points on the sphere surfaces [Qiao2021, eq. 11, 14, 17, 18, 20]: the slow way, for comparison."""

import math

from ikde.kernels.arrays import BODY, FIRST, LAST
from ikde.kernels.jit import kernel


@kernel
def compute_surface_from_centres(detector, centres, directions, out_points):
    """Surface points by the key-point method: centre + R * direction, the directions fixed in the world.

    [Qiao2021, eq. 11, 14, 17]. `centres` [3, S] m; `directions` [K, 3] unit vectors; `out_points` [S, K, 3] m.
    """
    for sphere in range(detector.radius.size):
        for k in range(directions.shape[0]):
            for i in range(3):
                out_points[sphere, k, i] = centres[i, sphere] + detector.radius[sphere] * directions[k, i]


@kernel
def compute_surface_by_transformation(detector, T_world_body, directions, out_points):
    """Surface points by spatial transformation: every point, fixed in its body, is mapped to the world."""
    for component in range(detector.components.shape[0]):
        T = T_world_body[detector.components[component, BODY]]
        for sphere in range(detector.components[component, FIRST], detector.components[component, LAST]):
            radius = detector.radius[sphere]
            for k in range(directions.shape[0]):
                x = detector.p_body_sphere[0, sphere] + radius * directions[k, 0]
                y = detector.p_body_sphere[1, sphere] + radius * directions[k, 1]
                z = detector.p_body_sphere[2, sphere] + radius * directions[k, 2]
                for i in range(3):
                    out_points[sphere, k, i] = T[i, 3] + T[i, 0] * x + T[i, 1] * y + T[i, 2] * z


@kernel
def compute_surface_gap(detector, points, covering_angle):
    """Smallest distance between surface points of a pair, less d_i + d_j; and the index of its pair.

    With `covering_angle` 0 this is the quantity of [Qiao2021, eq. 18], which is 0 only if two points coincide, so it
    misses contacts. With the grid's covering angle (rad), d_i = R_i * covering_angle, it is that of eq. 20: two
    spheres whose surfaces touch or cross always have points within d_i + d_j. `points` [S, K, 3] m.
    """
    smallest, closest = math.inf, -1
    for pair in range(detector.pairs.shape[0]):
        a, b = detector.pairs[pair, 0], detector.pairs[pair, 1]
        for i in range(detector.components[a, FIRST], detector.components[a, LAST]):
            for j in range(detector.components[b, FIRST], detector.components[b, LAST]):
                spacing = covering_angle * (detector.radius[i] + detector.radius[j])
                gap = math.sqrt(smallest_squared_distance(points[i], points[j])) - spacing
                if gap < smallest:
                    smallest, closest = gap, pair
    return smallest, closest


@kernel
def smallest_squared_distance(points, others):
    """Smallest squared distance between two clouds [K, 3], m^2."""
    smallest = math.inf
    for k in range(points.shape[0]):
        x, y, z = points[k, 0], points[k, 1], points[k, 2]
        for m in range(others.shape[0]):
            dx, dy, dz = x - others[m, 0], y - others[m, 1], z - others[m, 2]
            smallest = min(smallest, dx * dx + dy * dy + dz * dz)
    return smallest
