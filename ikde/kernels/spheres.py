"""Where the spheres are: by the key-point method of the paper, and by spatial transformation."""

import math

from ikde.kernels.jit import kernel


@kernel
def compute_centres(detector, R_world_body, p_world_body, out_centres):
    """Sphere centres by spatial transformation: p_world = T_world_body @ p_body. `out_centres` [S, 3] m."""
    for sphere in range(detector.sphere_body.size):
        body = detector.sphere_body[sphere]
        x, y, z = detector.p_body_sphere[sphere]
        for i in range(3):
            out_centres[sphere, i] = (
                p_world_body[body, i]
                + R_world_body[body, i, 0] * x
                + R_world_body[body, i, 1] * y
                + R_world_body[body, i, 2] * z
            )


@kernel
def compute_centres_from_key_points(detector, p_world_frame, out_centres):
    """Sphere centres on the lines between key points: the middle plus an offset along the unit vector.

    [Qiao2021, eq. 12, 13, 16], with eq. 13's missing factor 2R inside the packed offsets. Needs the origins of the
    frames only, no rotation. `p_world_frame` [F, 3] m; `out_centres` [S, 3] m.
    """
    for row in range(detector.row_from.size):
        start, end = p_world_frame[detector.row_from[row]], p_world_frame[detector.row_to[row]]
        ex, ey, ez = end[0] - start[0], end[1] - start[1], end[2] - start[2]
        length = math.sqrt(ex * ex + ey * ey + ez * ez)
        per_length = 1.0 / length if length > 0.0 else 0.0
        for sphere in range(detector.row_start[row], detector.row_start[row + 1]):
            along = detector.sphere_offset[sphere] * per_length
            out_centres[sphere, 0] = 0.5 * (start[0] + end[0]) + along * ex
            out_centres[sphere, 1] = 0.5 * (start[1] + end[1]) + along * ey
            out_centres[sphere, 2] = 0.5 * (start[2] + end[2]) + along * ez


@kernel
def compute_bounds(detector, R_world_body, p_world_body, out_bounds):
    """Centre of the bounding sphere of each component, by spatial transformation. `out_bounds` [C, 3] m."""
    for component in range(detector.component_body.size):
        body = detector.component_body[component]
        x, y, z = detector.p_body_bound[component]
        for i in range(3):
            out_bounds[component, i] = (
                p_world_body[body, i]
                + R_world_body[body, i, 0] * x
                + R_world_body[body, i, 1] * y
                + R_world_body[body, i, 2] * z
            )
