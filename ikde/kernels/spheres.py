"""Where the spheres are: by the key-point method of the paper, and by spatial transformation."""

import math

from ikde.kernels.arrays import BODY, FIRST, LAST
from ikde.kernels.jit import inline_kernel


@inline_kernel
def compute_component(collision, component, T_world_body, out_centres):
    """Sphere centres of one component by spatial transformation: p_world = T_world_body @ p_body. Into [3, S] m."""
    T = T_world_body[collision.components[component, BODY]]
    a, b, c, d = T[0, 0], T[0, 1], T[0, 2], T[0, 3]
    e, f, g, h = T[1, 0], T[1, 1], T[1, 2], T[1, 3]
    i, j, k, m = T[2, 0], T[2, 1], T[2, 2], T[2, 3]
    for sphere in range(collision.components[component, FIRST], collision.components[component, LAST]):
        x, y, z = (
            collision.p_body_sphere[0, sphere],
            collision.p_body_sphere[1, sphere],
            collision.p_body_sphere[2, sphere],
        )
        out_centres[0, sphere] = a * x + b * y + c * z + d
        out_centres[1, sphere] = e * x + f * y + g * z + h
        out_centres[2, sphere] = i * x + j * y + k * z + m


@inline_kernel
def compute_centres(collision, T_world_body, out_centres):
    """Sphere centres of every component by spatial transformation. `out_centres` [3, S] m."""
    for component in range(collision.components.shape[0]):
        compute_component(collision, component, T_world_body, out_centres)


@inline_kernel
def compute_bounds(collision, T_world_body, out_bounds):
    """Centre of the bounding sphere of each component, by spatial transformation. `out_bounds` [C, 3] m."""
    for component in range(collision.components.shape[0]):
        body = collision.components[component, BODY]
        x, y, z = collision.bounds[component, 0], collision.bounds[component, 1], collision.bounds[component, 2]
        for i in range(3):
            a, b, c = T_world_body[body, i, 0], T_world_body[body, i, 1], T_world_body[body, i, 2]
            out_bounds[component, i] = T_world_body[body, i, 3] + a * x + b * y + c * z


@inline_kernel
def compute_centres_from_key_points(collision, T_world_frame, out_centres):
    """Sphere centres on the lines between key points: the middle plus an offset along the unit vector.

    [Qiao2021, eq. 12, 13, 16], with eq. 13's missing factor 2R inside the packed offsets. Needs the origins of the
    frames only, no rotation. `T_world_frame` [F, 3, 4]; `out_centres` [3, S] m.
    """
    for row in range(collision.rows.shape[0]):
        start, end, first, last = collision.rows[row]
        x, y, z = T_world_frame[start, 0, 3], T_world_frame[start, 1, 3], T_world_frame[start, 2, 3]
        dx, dy, dz = T_world_frame[end, 0, 3] - x, T_world_frame[end, 1, 3] - y, T_world_frame[end, 2, 3] - z
        x, y, z = x + 0.5 * dx, y + 0.5 * dy, z + 0.5 * dz
        # A single sphere stands in the middle and needs no length: 8 of qiao2021's 14 rows.
        scale = 1.0 / math.sqrt(dx * dx + dy * dy + dz * dz) if last - first > 1 else 0.0
        for sphere in range(first, last):
            along = collision.offset[sphere] * scale
            out_centres[0, sphere] = x + along * dx
            out_centres[1, sphere] = y + along * dy
            out_centres[2, sphere] = z + along * dz
