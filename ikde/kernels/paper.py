"""Only for the paper's tables: self-collision by points on the sphere surfaces, and placements as Table 3 times them.

The paper compares every point with every point [Qiao2021, eq. 11, 14, 17, 18, 20]; `compute_surface_gap` does so.
`surfaces_collide` comes to the same verdict from the points that can matter, so that thousands of configurations can be
judged.
"""

import math

import numpy as np

from ikde.kernels.arrays import BODY, FIRST, LAST
from ikde.kernels.frames import compute_bodies, compute_origins
from ikde.kernels.jit import kernel
from ikde.kernels.spheres import compute_centres, compute_centres_from_key_points

HAIR = 1e-9  # m: what a bound must leave for rounding before it may decide


@kernel
def compute_surface_from_centres(collision, centres, directions, out_points):
    """Surface points by the key-point method: centre + R * direction, the directions fixed in the world.

    [Qiao2021, eq. 11, 14, 17]. `centres` [3, S] m; `directions` [K, 3] unit vectors; `out_points` [S, K, 3] m.
    """
    for sphere in range(collision.radius.size):
        for k in range(directions.shape[0]):
            for i in range(3):
                out_points[sphere, k, i] = centres[i, sphere] + collision.radius[sphere] * directions[k, i]


@kernel
def compute_surface_by_transformation(collision, T_world_body, directions, out_points):
    """Surface points by spatial transformation: every point, fixed in its body, is mapped to the world."""
    for component in range(collision.components.shape[0]):
        T = T_world_body[collision.components[component, BODY]]
        for sphere in range(collision.components[component, FIRST], collision.components[component, LAST]):
            radius = collision.radius[sphere]
            for k in range(directions.shape[0]):
                x = collision.p_body_sphere[0, sphere] + radius * directions[k, 0]
                y = collision.p_body_sphere[1, sphere] + radius * directions[k, 1]
                z = collision.p_body_sphere[2, sphere] + radius * directions[k, 2]
                for i in range(3):
                    out_points[sphere, k, i] = T[i, 3] + T[i, 0] * x + T[i, 1] * y + T[i, 2] * z


@kernel
def compute_surface_gap(collision, points, covering_angle):
    """Smallest distance between surface points of a pair, less d_i + d_j; and the index of its pair.

    With `covering_angle` 0 this is the quantity of [Qiao2021, eq. 18], which is 0 only if two points coincide, so it
    misses contacts. With the grid's covering angle (rad), d_i = R_i * covering_angle, it is that of eq. 20: two
    spheres whose surfaces touch or cross always have points within d_i + d_j. `points` [S, K, 3] m.
    """
    smallest, closest = math.inf, -1
    for pair in range(collision.pairs.shape[0]):
        a, b = collision.pairs[pair, 0], collision.pairs[pair, 1]
        for i in range(collision.components[a, FIRST], collision.components[a, LAST]):
            for j in range(collision.components[b, FIRST], collision.components[b, LAST]):
                spacing = covering_angle * (collision.radius[i] + collision.radius[j])
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


@kernel
def judge_surfaces(robot, collision, directions, covering_angle, limit, qs, out_collides):
    """Whether each row of `qs` [n, N] collides, with the verdict of `compute_surface_gap` <= `limit` (m), but fast."""
    T_world_body = np.empty((robot.bodies.shape[0], 3, 4))
    centres = np.empty((3, collision.radius.size))
    for row in range(qs.shape[0]):
        compute_bodies(robot, qs[row], T_world_body)
        compute_centres(collision, T_world_body, centres)
        out_collides[row] = surfaces_collide(collision, centres, directions, covering_angle, limit)


@kernel
def surfaces_collide(collision, centres, directions, covering_angle, limit):
    """True at the first two surface points of a pair within d_i + d_j + `limit` [Qiao2021, eq. 20; eq. 18]."""
    for pair in range(collision.pairs.shape[0]):
        a, b = collision.pairs[pair, 0], collision.pairs[pair, 1]
        for i in range(collision.components[a, FIRST], collision.components[a, LAST]):
            for j in range(collision.components[b, FIRST], collision.components[b, LAST]):
                spacing = covering_angle * (collision.radius[i] + collision.radius[j])
                if clouds_touch(collision, centres, directions, i, j, spacing, limit):
                    return True
    return False


@kernel
def clouds_touch(collision, centres, directions, i, j, spacing, limit):
    """Whether two spheres have surface points within `spacing` + `limit`: only points near both surfaces are compared.

    A point p of sphere i is | |p - c_j| - R_j | from the surface of sphere j, so from its points at least that.
    """
    R, r = collision.radius[i], collision.radius[j]
    x, y, z = centres[0, i] - centres[0, j], centres[1, i] - centres[1, j], centres[2, i] - centres[2, j]
    distance = math.sqrt(x * x + y * y + z * z)
    reach = spacing + limit + HAIR
    if max(distance - R - r, abs(R - r) - distance) > reach:
        return False
    for k in range(directions.shape[0]):
        u, v, w = x + R * directions[k, 0], y + R * directions[k, 1], z + R * directions[k, 2]
        if abs(math.sqrt(u * u + v * v + w * w) - r) > reach:
            continue
        px = centres[0, i] + R * directions[k, 0]
        py = centres[1, i] + R * directions[k, 1]
        pz = centres[2, i] + R * directions[k, 2]
        for m in range(directions.shape[0]):
            dx = px - (centres[0, j] + r * directions[m, 0])
            dy = py - (centres[1, j] + r * directions[m, 1])
            dz = pz - (centres[2, j] + r * directions[m, 2])
            if math.sqrt(dx * dx + dy * dy + dz * dz) - spacing <= limit:
                return True
    return False


# ---- placements as Table 3 times them [Qiao2021, section 5.3.2]: a placement takes a tenth of what a call from Python
# takes, so the repetitions stand inside one compiled loop


@kernel
def place_by_transformation(robot, collision, directions, q, moves, times, T_world_body, out_centres, out_points):
    """Place centres [3, S], or surface points [S, K, 3] if there are `directions` [K, 3], `times` times.

    Every point is fixed in its body and mapped by its body's pose: of `q` [N] if it `moves`, else as it stands in
    `T_world_body` [B, 3, 4].
    """
    for _ in range(times):
        if moves:
            compute_bodies(robot, q, T_world_body)
        if directions.shape[0] > 0:
            compute_surface_by_transformation(collision, T_world_body, directions, out_points)
        else:
            compute_centres(collision, T_world_body, out_centres)


@kernel
def place_by_key_points(
    robot, collision, directions, q, moves, times, T_world_body, T_world_frame, out_centres, out_points
):
    """Place centres, or surface points if there are `directions`, on the lines between key points, `times` times.

    The key points are column 3 of `T_world_frame` [F, 3, 4]; the directions to surface points are fixed in the world.
    """
    for _ in range(times):
        if moves:
            compute_bodies(robot, q, T_world_body)
            compute_origins(robot, T_world_body, T_world_frame)
        compute_centres_from_key_points(collision, T_world_frame, out_centres)
        if directions.shape[0] > 0:
            compute_surface_from_centres(collision, out_centres, directions, out_points)
