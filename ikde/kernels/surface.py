"""Self-collision by points on the sphere surfaces [Qiao2021, eq. 11, 14, 17, 18, 20]: the slow way, for comparison."""

import math

from ikde.kernels.jit import kernel


@kernel
def compute_surface_from_centres(detector, centres, directions, out_points):
    """Surface points by the key-point method: centre + R * direction, the directions fixed in the world.

    [Qiao2021, eq. 11, 14, 17]. `directions` [K, 3] unit vectors; `out_points` [S, K, 3] m.
    """
    for sphere in range(detector.sphere_body.size):
        radius = detector.sphere_radius[sphere]
        for k in range(directions.shape[0]):
            for i in range(3):
                out_points[sphere, k, i] = centres[sphere, i] + radius * directions[k, i]


@kernel
def compute_surface_by_transformation(detector, R_world_body, p_world_body, directions, out_points):
    """Surface points by spatial transformation: every point, fixed in its body, is mapped to the world."""
    for sphere in range(detector.sphere_body.size):
        body, radius = detector.sphere_body[sphere], detector.sphere_radius[sphere]
        for k in range(directions.shape[0]):
            x = detector.p_body_sphere[sphere, 0] + radius * directions[k, 0]
            y = detector.p_body_sphere[sphere, 1] + radius * directions[k, 1]
            z = detector.p_body_sphere[sphere, 2] + radius * directions[k, 2]
            for i in range(3):
                out_points[sphere, k, i] = (
                    p_world_body[body, i]
                    + R_world_body[body, i, 0] * x
                    + R_world_body[body, i, 1] * y
                    + R_world_body[body, i, 2] * z
                )


@kernel
def compute_surface_gap(detector, points, covering_angle):
    """Smallest distance between surface points of a pair, less d_i + d_j; and the index of its pair.

    With `covering_angle` 0 this is the quantity of [Qiao2021, eq. 18], which is 0 only if two points coincide, so it
    misses contacts. With the grid's covering angle (rad), d_i = R_i * covering_angle, it is that of eq. 20: two
    spheres whose surfaces touch or cross always have points within d_i + d_j.
    """
    smallest, closest = math.inf, -1
    for pair in range(detector.pair_a.size):
        a, b = detector.pair_a[pair], detector.pair_b[pair]
        for i in range(detector.component_start[a], detector.component_start[a + 1]):
            for j in range(detector.component_start[b], detector.component_start[b + 1]):
                spacing = covering_angle * (detector.sphere_radius[i] + detector.sphere_radius[j])
                gap = math.sqrt(_smallest_squared_distance(points[i], points[j])) - spacing
                if gap < smallest:
                    smallest, closest = gap, pair
    return smallest, closest


@kernel
def _smallest_squared_distance(points, others):
    """Smallest squared distance between two clouds [K, 3]."""
    smallest = math.inf
    for k in range(points.shape[0]):
        x, y, z = points[k, 0], points[k, 1], points[k, 2]
        for m in range(others.shape[0]):
            dx, dy, dz = x - others[m, 0], y - others[m, 1], z - others[m, 2]
            smallest = min(smallest, dx * dx + dy * dy + dz * dz)
    return smallest
