"""How near the arm is to a singularity: the smallest singular value of its Jacobian, in plain numpy."""

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.robot import WORLD, Robot
from ikde.solver.plain import compute_frames

ASKED_ROWS = {"free": 3, "axis": 5, "pose": 6}
"""How many directions of the tool a path asks for: its velocity, rotations of its axis, the rotation about its axis."""


def smallest_singular_values(
    robot: Robot, q: Floats, base_joints: tuple[str, ...] = (), orientation: str = "pose"
) -> Floats:
    """Of the tool's Jacobian in m and rad by the joints of the arm, for `q` [..., N]; 0 in a singularity.

    Its rows are what a path with this orientation asks for; an arm with fewer joints than that is always singular. The
    joints of a base are left out: with them a mobile robot is hardly ever singular.
    """
    rows = ASKED_ROWS[orientation]
    jacobian = arm_jacobian(robot, q, base_joints)[..., :rows, :]
    if jacobian.shape[-1] < rows or not jacobian.size:
        return np.zeros(q.shape[:-1])
    return np.linalg.svd(jacobian, compute_uv=False)[..., -1]  # type: ignore[return-value]


def arm_jacobian(robot: Robot, q: Floats, base_joints: tuple[str, ...] = ()) -> Floats:
    """Velocity and angular velocity of the tool in its own frame [..., 6, n], by the joints of the arm."""
    Ts_world = compute_frames(robot, q)
    tool, to_tool = Ts_world[robot.tool][..., :3, 3], Ts_world[robot.tool][..., :3, :3].mT
    columns = []
    for name in _chain(robot):
        frame = next(frame for frame in robot.frames if frame.name == name)
        if frame.joint is None or frame.axis is None or frame.joint in base_joints:
            continue
        axis = Ts_world[name][..., :3, :3] @ frame.axis
        arm = tool - Ts_world[name][..., :3, 3]
        if robot.joints[robot.joint_names.index(frame.joint)].kind == "prismatic":
            column = axis, np.zeros_like(axis)
        else:
            column = np.cross(axis, arm), axis
        columns.append(np.concatenate([(to_tool @ part[..., None])[..., 0] for part in column], axis=-1))
    return np.stack(columns, axis=-1) if columns else np.empty((*q.shape[:-1], 6, 0))


def _chain(robot: Robot) -> list[str]:
    """Frames from the world to the tool."""
    parents = {frame.name: frame.parent for frame in robot.frames}
    chain = [robot.tool]
    while parents[chain[-1]] != WORLD:
        chain.append(parents[chain[-1]])
    return chain[::-1]
