"""What the black-box searches minimise: pose error and clearance from ikde's kernels, compiled for one robot."""

from collections.abc import Callable

import numba
import numpy as np
from protocol import TOOL_WEIGHT_M, Setup

from ikde.kernels.clearance import compute_clearance
from ikde.kernels.frames import compute_bodies, compute_tool
from ikde.kernels.spheres import compute_bounds, compute_centres
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot


def make_objective(setup: Setup) -> tuple[Callable[..., tuple[float, float]], float]:
    """A function of q [N], p [3] and R [3, 3], and the value below which every tolerance is kept.

    It gives position error + TOOL_WEIGHT_M x orientation error in m, and the depth of penetration in m, 0 if free.
    """
    robot = setup.robot
    arrays, spheres = pack_robot(robot), CollisionModel.of(robot).arrays
    bodies, components, count = len(arrays.bodies), len(spheres.components), spheres.radius.size
    is_pose, weight = setup.is_pose, TOOL_WEIGHT_M

    @numba.njit(error_model="numpy")
    def evaluate(q, p, R):
        T_world_body, T = np.empty((bodies, 3, 4)), np.empty((3, 4))
        bounds, centres = np.empty((components, 3)), np.empty((3, count))
        compute_bodies(arrays, q, T_world_body)
        compute_tool(arrays, T_world_body, T)
        error = np.sqrt((T[0, 3] - p[0]) ** 2 + (T[1, 3] - p[1]) ** 2 + (T[2, 3] - p[2]) ** 2)
        if is_pose:
            C = np.ascontiguousarray(T[:, :3].T) @ R
            x, y, z = C[2, 1] - C[1, 2], C[0, 2] - C[2, 0], C[1, 0] - C[0, 1]
            error += weight * np.arctan2(np.sqrt(x * x + y * y + z * z), C[0, 0] + C[1, 1] + C[2, 2] - 1.0)
        compute_bounds(spheres, T_world_body, bounds)
        compute_centres(spheres, T_world_body, centres)
        clearance, _ = compute_clearance(spheres, bounds, centres)
        return error, max(0.0, -clearance)

    goal = min(setup.position_tolerance_m, weight * setup.orientation_tolerance_rad)
    return evaluate, goal if is_pose else setup.position_tolerance_m
