"""How near the arm is to a singularity: the smallest singular value of its Jacobian, in plain numpy."""

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.robot import WORLD, Robot
from ikde.solver.plain import compute_frames


def smallest_singular_values(robot: Robot, q: Floats, base_joints: tuple[str, ...] = ()) -> Floats:
    """Of the tool's Jacobian [..., 6, n] in m and rad by the joints of the arm, for `q` [..., N]; 0 in a singularity.

    The joints of a base are left out: with them a mobile robot is hardly ever singular.
    """
    jacobian = arm_jacobian(robot, q, base_joints)
    if not jacobian.size:
        return np.zeros(q.shape[:-1])
    return np.linalg.svd(jacobian, compute_uv=False)[..., -1]  # type: ignore[return-value]


def arm_jacobian(robot: Robot, q: Floats, base_joints: tuple[str, ...] = ()) -> Floats:
    """Velocity and angular velocity of the tool in the world [..., 6, n], by the joints of the arm."""
    Ts_world = compute_frames(robot, q)
    tool = Ts_world[robot.tool][..., :3, 3]
    columns = []
    for name in _chain(robot):
        frame = next(frame for frame in robot.frames if frame.name == name)
        if frame.joint is None or frame.axis is None or frame.joint in base_joints:
            continue
        axis = Ts_world[name][..., :3, :3] @ frame.axis
        if robot.joints[robot.joint_names.index(frame.joint)].kind == "prismatic":
            columns.append(np.concatenate([axis, np.zeros_like(axis)], axis=-1))
        else:
            columns.append(np.concatenate([np.cross(axis, tool - Ts_world[name][..., :3, 3]), axis], axis=-1))
    return np.stack(columns, axis=-1) if columns else np.empty((*q.shape[:-1], 6, 0))


def _chain(robot: Robot) -> list[str]:
    """Frames from the world to the tool."""
    parents = {frame.name: frame.parent for frame in robot.frames}
    chain = [robot.tool]
    while parents[chain[-1]] != WORLD:
        chain.append(parents[chain[-1]])
    return chain[::-1]
