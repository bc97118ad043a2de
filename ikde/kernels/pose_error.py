"""How far the tool is from its target: metres, and the norm of the rotation vector in radians."""

import math

from ikde.kernels.arrays import AXIS, POSITION
from ikde.kernels.jit import inline_kernel
from ikde.kernels.trig import angle_from_sides


@inline_kernel
def compute_position_error(target, index, T_world_tool):
    """Euclidean distance to the target in m. `T_world_tool` [3, 4]."""
    dx = T_world_tool[0, 3] - target.T_world_tool[index, 0, 3]
    dy = T_world_tool[1, 3] - target.T_world_tool[index, 1, 3]
    dz = T_world_tool[2, 3] - target.T_world_tool[index, 2, 3]
    return math.sqrt(dx * dx + dy * dy + dz * dz)


@inline_kernel
def compute_orientation_error(target, index, T_world_tool):
    """Angle in [0, pi] rad between tool and target: of the rotation R_target^T R, of the tool axis, or 0.

    The rotation's angle is atan2 of its sine |S - S^T| / 2 and its cosine (trace - 1) / 2, exact near 0 and pi.
    """
    kind, R, S = target.kind[index], target.T_world_tool[index], T_world_tool
    if kind == POSITION:
        return 0.0
    if kind == AXIS:
        x = R[1, 2] * S[2, 2] - R[2, 2] * S[1, 2]
        y = R[2, 2] * S[0, 2] - R[0, 2] * S[2, 2]
        z = R[0, 2] * S[1, 2] - R[1, 2] * S[0, 2]
        cosine = R[0, 2] * S[0, 2] + R[1, 2] * S[1, 2] + R[2, 2] * S[2, 2]
        return angle_from_sides(math.sqrt(x * x + y * y + z * z), cosine)
    trace, x, y, z = 0.0, 0.0, 0.0, 0.0
    for k in range(3):
        trace += R[k, 0] * S[k, 0] + R[k, 1] * S[k, 1] + R[k, 2] * S[k, 2]
        x += R[k, 2] * S[k, 1] - R[k, 1] * S[k, 2]
        y += R[k, 0] * S[k, 2] - R[k, 2] * S[k, 0]
        z += R[k, 1] * S[k, 0] - R[k, 0] * S[k, 1]
    return angle_from_sides(0.5 * math.sqrt(x * x + y * y + z * z), 0.5 * (trace - 1.0))
