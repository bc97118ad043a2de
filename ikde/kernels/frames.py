"""Forward kinematics of every body and frame, and the tool's geometric Jacobian."""

from ikde.kernels.jit import kernel
from ikde.kernels.trig import sin_cos


@kernel
def compute_bodies(robot, q, out_R, out_p):
    """Pose of every body in the world: T_world_body = T_world_parent @ T_parent_body @ (Rz(q) or Tz(q)).

    [Qiao2021, eq. 3, 5-9], for any tree. `q` [N]; `out_R` [B, 3, 3]; `out_p` [B, 3] m.
    """
    for i in range(3):
        out_p[0, i] = 0.0
        for j in range(3):
            out_R[0, i, j] = 1.0 if i == j else 0.0
    for body in range(1, robot.body_parent.size):
        parent = robot.body_parent[body]
        value = q[robot.body_coordinate[body]]
        slides = robot.body_slides[body] == 1
        s, c = (0.0, 1.0) if slides else sin_cos(value)
        x, y, z = robot.p_parent_body[body]
        for i in range(3):
            a, b, d = out_R[parent, i, 0], out_R[parent, i, 1], out_R[parent, i, 2]
            r0 = a * robot.R_parent_body[body, 0, 0] + b * robot.R_parent_body[body, 1, 0]
            r1 = a * robot.R_parent_body[body, 0, 1] + b * robot.R_parent_body[body, 1, 1]
            r2 = a * robot.R_parent_body[body, 0, 2] + b * robot.R_parent_body[body, 1, 2]
            r0 += d * robot.R_parent_body[body, 2, 0]
            r1 += d * robot.R_parent_body[body, 2, 1]
            r2 += d * robot.R_parent_body[body, 2, 2]
            out_p[body, i] = out_p[parent, i] + a * x + b * y + d * z
            if slides:
                out_p[body, i] += r2 * value
            out_R[body, i, 0] = r0 * c + r1 * s
            out_R[body, i, 1] = r1 * c - r0 * s
            out_R[body, i, 2] = r2


@kernel
def compute_frame(robot, frame, R_world_body, p_world_body, out_R, out_p):
    """Pose of one named frame in the world, from the poses of the bodies. `out_R` [3, 3], `out_p` [3] m."""
    body = robot.frame_body[frame]
    for i in range(3):
        a, b, d = R_world_body[body, i, 0], R_world_body[body, i, 1], R_world_body[body, i, 2]
        x, y, z = robot.p_body_frame[frame]
        out_p[i] = p_world_body[body, i] + a * x + b * y + d * z
        for j in range(3):
            column = robot.R_body_frame[frame, :, j]
            out_R[i, j] = a * column[0] + b * column[1] + d * column[2]


@kernel
def compute_frames(robot, R_world_body, p_world_body, out_R, out_p):
    """Pose of every named frame in the world. `out_R` [F, 3, 3], `out_p` [F, 3] m."""
    for frame in range(robot.frame_body.size):
        compute_frame(robot, frame, R_world_body, p_world_body, out_R[frame], out_p[frame])


@kernel
def compute_jacobian(robot, R_world_body, p_world_body, p_world_tool, out_jacobian):
    """Geometric Jacobian of the tool in the world frame: rows v (m/s) then omega (rad/s), a column per joint.

    A revolute joint gives (z x (p_tool - p_joint), z), a prismatic one (z, 0). `out_jacobian` [6, N].
    """
    out_jacobian[:] = 0.0
    for body in range(1, robot.body_parent.size):
        if robot.body_moves_tool[body] == 0:
            continue
        column = robot.body_coordinate[body]
        x, y, z = R_world_body[body, 0, 2], R_world_body[body, 1, 2], R_world_body[body, 2, 2]
        if robot.body_slides[body] == 1:
            out_jacobian[0, column], out_jacobian[1, column], out_jacobian[2, column] = x, y, z
            continue
        dx = p_world_tool[0] - p_world_body[body, 0]
        dy = p_world_tool[1] - p_world_body[body, 1]
        dz = p_world_tool[2] - p_world_body[body, 2]
        out_jacobian[0, column] = y * dz - z * dy
        out_jacobian[1, column] = z * dx - x * dz
        out_jacobian[2, column] = x * dy - y * dx
        out_jacobian[3, column], out_jacobian[4, column], out_jacobian[5, column] = x, y, z
