"""The figures of one finished configuration, as the kernels see them; `solver.verify` must agree."""

from ikde.kernels.clearance import compute_clearance
from ikde.kernels.evolution import make_workspace
from ikde.kernels.frames import compute_bodies, compute_tool
from ikde.kernels.jit import kernel
from ikde.kernels.pose_error import compute_orientation_error, compute_position_error
from ikde.kernels.spheres import compute_bounds, compute_centres

POSITION_ERROR, ORIENTATION_ERROR, CLEARANCE = range(3)


@kernel
def compute_figures(robot, detector, target, index, q, out_figures):
    """Fill `out_figures` [3]: position error in m, orientation error in rad, clearance in m (inf without pairs)."""
    work = make_workspace(robot, detector, q.size, q.size)
    compute_bodies(robot, q, work.T_world_body)
    compute_tool(robot, work.T_world_body, work.T_world_tool)
    compute_bounds(detector, work.T_world_body, work.bounds)
    compute_centres(detector, work.T_world_body, work.centres)
    out_figures[POSITION_ERROR] = compute_position_error(target, index, work.T_world_tool)
    out_figures[ORIENTATION_ERROR] = compute_orientation_error(target, index, work.T_world_tool)
    out_figures[CLEARANCE], _ = compute_clearance(detector, work.bounds, work.centres)
