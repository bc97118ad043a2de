"""The grader for one configuration: the scalar kernels. With kernels written for a robot they share `trig`, and the
packed tables from which those are written; docs/design.md compares all graders.

For one, the lanes of `kernels/grade_many.py` are mostly overhead: 7 us, where this takes 2. The bits are the same.
"""

import numpy as np

from ikde.kernels.arrays import TargetArrays
from ikde.kernels.attempt import is_inside
from ikde.kernels.clearance import compute_clearance
from ikde.kernels.flat_arguments import unpack_grader
from ikde.kernels.frames import compute_bodies, compute_tool
from ikde.kernels.jit import kernel
from ikde.kernels.pose_error import compute_orientation_error, compute_position_error
from ikde.kernels.spheres import compute_bounds, compute_centres


@kernel
def grade_one(numbers, whole, kinds, T_world_tool, q):
    """Position error in m, orientation error in rad, clearance in m, closest pair, and if it is accepted, of `q` [N].

    The other arguments, and what is given back, are those of `grade_many`, for one target.
    """
    robot, collision, terms = unpack_grader(numbers, whole)
    target = TargetArrays(kinds, T_world_tool)
    T_world_body, tool = np.empty((robot.bodies.shape[0], 3, 4)), np.empty((3, 4))
    bounds, centres = np.empty((collision.components.shape[0], 3)), np.empty((3, collision.radius.size))
    compute_bodies(robot, q, T_world_body)
    compute_tool(robot, T_world_body, tool)
    compute_bounds(collision, T_world_body, bounds)
    compute_centres(collision, T_world_body, centres)
    position, orientation = compute_position_error(target, 0, tool), compute_orientation_error(target, 0, tool)
    clearance, pair = compute_clearance(collision, bounds, centres)
    meets = position <= terms.position_tolerance and orientation <= terms.orientation_tolerance
    accepted = meets and clearance > collision.safe_distance and is_inside(terms.limits, q)
    return position, orientation, clearance, pair, accepted
