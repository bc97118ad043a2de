"""How far the tool is from its target: metres, and the norm of the rotation vector in radians."""

import math

from ikde.kernels.jit import kernel
from ikde.kernels.trig import angle_from_sides

POSITION, AXIS, POSE = 0, 1, 2


@kernel
def compute_position_error(target, index, p_world_tool):
    """Euclidean distance to the target in m."""
    dx = p_world_tool[0] - target.p_world_tool[index, 0]
    dy = p_world_tool[1] - target.p_world_tool[index, 1]
    dz = p_world_tool[2] - target.p_world_tool[index, 2]
    return math.sqrt(dx * dx + dy * dy + dz * dz)


@kernel
def compute_orientation_error(target, index, R_world_tool):
    """Angle in [0, pi] rad between tool and target: of the rotation R_target^T R, of the tool axis, or 0.

    The rotation's angle is atan2 of its sine |S - S^T| / 2 and its cosine (trace - 1) / 2, exact near 0 and pi.
    """
    kind = target.kind[index]
    if kind == POSITION:
        return 0.0
    R = target.R_world_tool[index]
    if kind == AXIS:
        ax, ay, az = R[0, 2], R[1, 2], R[2, 2]
        bx, by, bz = R_world_tool[0, 2], R_world_tool[1, 2], R_world_tool[2, 2]
        x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
        return angle_from_sides(math.sqrt(x * x + y * y + z * z), ax * bx + ay * by + az * bz)
    trace, x, y, z = 0.0, 0.0, 0.0, 0.0
    for k in range(3):
        trace += R[k, 0] * R_world_tool[k, 0] + R[k, 1] * R_world_tool[k, 1] + R[k, 2] * R_world_tool[k, 2]
        x += R[k, 2] * R_world_tool[k, 1] - R[k, 1] * R_world_tool[k, 2]
        y += R[k, 0] * R_world_tool[k, 2] - R[k, 2] * R_world_tool[k, 0]
        z += R[k, 1] * R_world_tool[k, 0] - R[k, 0] * R_world_tool[k, 1]
    return angle_from_sides(0.5 * math.sqrt(x * x + y * y + z * z), 0.5 * (trace - 1.0))
