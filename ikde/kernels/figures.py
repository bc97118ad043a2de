"""The figures of finished configurations, as the kernels see them; `solver.verify` must agree."""

from ikde.kernels.clearance import compute_clearance
from ikde.kernels.evolution import make_workspace
from ikde.kernels.frames import compute_bodies, compute_tool
from ikde.kernels.jit import kernel
from ikde.kernels.pose_error import compute_orientation_error, compute_position_error
from ikde.kernels.spheres import compute_bounds, compute_centres

POSITION_ERROR, ORIENTATION_ERROR, CLEARANCE = range(3)


@kernel
def compute_figures(robot, detector, target, q, out_figures, out_pairs):
    """Figures of configurations `q` [T, N], a target each.

    `out_figures` [T, 3]: position error in m, orientation error in rad, clearance in m (inf without pairs);
    `out_pairs` [T]: index of the closest pair (-1 without pairs).
    """
    work = make_workspace(robot, detector, q.shape[1], 1)
    for index in range(q.shape[0]):
        compute_bodies(robot, q[index], work.T_world_body)
        compute_tool(robot, work.T_world_body, work.T_world_tool)
        compute_bounds(detector, work.T_world_body, work.bounds)
        compute_centres(detector, work.T_world_body, work.centres)
        out_figures[index, POSITION_ERROR] = compute_position_error(target, index, work.T_world_tool)
        out_figures[index, ORIENTATION_ERROR] = compute_orientation_error(target, index, work.T_world_tool)
        out_figures[index, CLEARANCE], out_pairs[index] = compute_clearance(detector, work.bounds, work.centres)
