"""One placement of all spheres, again and again: what Table 3 of the paper times [Qiao2021, section 5.3.2].

A placement takes a tenth of what a call from Python takes, so the repetitions stand inside one compiled loop.
"""

from ikde.kernels.frames import compute_bodies, compute_origins
from ikde.kernels.jit import kernel
from ikde.kernels.spheres import compute_centres, compute_centres_from_key_points
from ikde.kernels.surface import compute_surface_by_transformation, compute_surface_from_centres


@kernel
def place_by_transformation(robot, detector, directions, q, moves, times, T_world_body, out_centres, out_points):
    """Place centres [3, S], or surface points [S, K, 3] if there are `directions` [K, 3], `times` times.

    Every point is fixed in its body and mapped by its body's pose: of `q` [N] if it `moves`, else as it stands in
    `T_world_body` [B, 3, 4].
    """
    for _ in range(times):
        if moves:
            compute_bodies(robot, q, T_world_body)
        if directions.shape[0] > 0:
            compute_surface_by_transformation(detector, T_world_body, directions, out_points)
        else:
            compute_centres(detector, T_world_body, out_centres)


@kernel
def place_by_key_points(
    robot, detector, directions, q, moves, times, T_world_body, T_world_frame, out_centres, out_points
):
    """Place centres, or surface points if there are `directions`, on the lines between key points, `times` times.

    The key points are column 3 of `T_world_frame` [F, 3, 4]; the directions to surface points are fixed in the world.
    """
    for _ in range(times):
        if moves:
            compute_bodies(robot, q, T_world_body)
            compute_origins(robot, T_world_body, T_world_frame)
        compute_centres_from_key_points(detector, T_world_frame, out_centres)
        if directions.shape[0] > 0:
            compute_surface_from_centres(detector, out_centres, directions, out_points)
