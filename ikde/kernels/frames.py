"""Forward kinematics of every body and frame, and the tool's geometric Jacobian."""

import numpy as np

from ikde.kernels.arrays import COORDINATE, MOVES_TOOL, PARENT, PRISMATIC
from ikde.kernels.jit import inline_kernel, kernel
from ikde.kernels.trig import sin_cos


@inline_kernel
def compute_bodies(robot, q, out_T):
    """Pose of every body in the world: T_world_body = T_world_parent @ T_parent_body @ (Rz(q) or Tz(q)).

    [Qiao2021, eq. 3, 5-9], for any tree. `q` [N]; `out_T` [B, 3, 4].
    """
    bodies, T_local = robot.bodies, robot.T_parent_body
    for i in range(3):
        for j in range(4):
            out_T[0, i, j] = 1.0 if i == j else 0.0
    for body in range(1, bodies.shape[0]):
        parent = np.uint64(bodies[body, PARENT])  # an index without a sign
        value = q[bodies[body, COORDINATE]]
        is_prismatic = bodies[body, PRISMATIC] == 1
        s, c = (0.0, 1.0) if is_prismatic else sin_cos(value)
        along = value if is_prismatic else 0.0
        for i in range(3):
            a, b, d = out_T[parent, i, 0], out_T[parent, i, 1], out_T[parent, i, 2]
            x = a * T_local[body, 0, 0] + b * T_local[body, 1, 0] + d * T_local[body, 2, 0]
            y = a * T_local[body, 0, 1] + b * T_local[body, 1, 1] + d * T_local[body, 2, 1]
            z = a * T_local[body, 0, 2] + b * T_local[body, 1, 2] + d * T_local[body, 2, 2]
            shift = a * T_local[body, 0, 3] + b * T_local[body, 1, 3] + d * T_local[body, 2, 3]
            out_T[body, i, 0] = x * c + y * s
            out_T[body, i, 1] = y * c - x * s
            out_T[body, i, 2] = z
            out_T[body, i, 3] = out_T[parent, i, 3] + shift + z * along


@inline_kernel
def compute_frame(robot, frame, T_world_body, out_T):
    """Pose of one named frame in the world, from the poses of the bodies [B, 3, 4]. `out_T` [3, 4]."""
    body, T_local = robot.frame_body[frame], robot.T_body_frame
    for i in range(3):
        a, b, d = T_world_body[body, i, 0], T_world_body[body, i, 1], T_world_body[body, i, 2]
        for j in range(4):
            out_T[i, j] = a * T_local[frame, 0, j] + b * T_local[frame, 1, j] + d * T_local[frame, 2, j]
        out_T[i, 3] += T_world_body[body, i, 3]


@inline_kernel
def compute_tool(robot, T_world_body, out_T):
    """Pose of the tool in the world, from the poses of the bodies [B, 3, 4]. `out_T` [3, 4]."""
    compute_frame(robot, robot.frame_body.size - 1, T_world_body, out_T)


@kernel
def compute_frames(robot, T_world_body, out_T):
    """Pose of every named frame in the world. `T_world_body` [B, 3, 4]; `out_T` [F, 3, 4]."""
    for frame in range(robot.frame_body.size):
        compute_frame(robot, frame, T_world_body, out_T[frame])


@kernel
def compute_origins(robot, T_world_body, out_T):
    """Origin of every named frame in the world: column 3 of `out_T` [F, 3, 4]; the rest is left as it is."""
    T_local = robot.T_body_frame
    for frame in range(robot.frame_body.size):
        body = robot.frame_body[frame]
        x, y, z = T_local[frame, 0, 3], T_local[frame, 1, 3], T_local[frame, 2, 3]
        for i in range(3):
            a, b, c = T_world_body[body, i, 0], T_world_body[body, i, 1], T_world_body[body, i, 2]
            out_T[frame, i, 3] = a * x + b * y + c * z + T_world_body[body, i, 3]


@kernel
def compute_jacobian(robot, T_world_body, T_world_tool, out_jacobian):
    """Geometric Jacobian of the tool in the world frame: rows v (m/s) then omega (rad/s), a column per joint.

    A revolute joint gives (z x (p_tool - p_joint), z), a prismatic one (z, 0). `out_jacobian` [6, N].
    """
    out_jacobian[:] = 0.0
    for body in range(1, robot.bodies.shape[0]):
        if robot.bodies[body, MOVES_TOOL] == 0:
            continue
        column = robot.bodies[body, COORDINATE]
        x, y, z = T_world_body[body, 0, 2], T_world_body[body, 1, 2], T_world_body[body, 2, 2]
        if robot.bodies[body, PRISMATIC] == 1:
            out_jacobian[0, column], out_jacobian[1, column], out_jacobian[2, column] = x, y, z
            continue
        dx = T_world_tool[0, 3] - T_world_body[body, 0, 3]
        dy = T_world_tool[1, 3] - T_world_body[body, 1, 3]
        dz = T_world_tool[2, 3] - T_world_body[body, 2, 3]
        out_jacobian[0, column] = y * dz - z * dy
        out_jacobian[1, column] = z * dx - x * dz
        out_jacobian[2, column] = x * dy - y * dx
        out_jacobian[3, column], out_jacobian[4, column], out_jacobian[5, column] = x, y, z
