"""Configurations free of collision, and targets that the tool meets somewhere."""

import ikde
from ikde.model.collision_model import CollisionModel
from ikde.solver.plain import compute_gaps
from tests.conftest import random_q


def free_q(robot, rng):
    """Joint values [N] without self-collision, the base near the origin."""
    while True:
        q = random_q(robot, rng)
        prismatic = [joint.kind == "prismatic" for joint in robot.joints]
        q[prismatic] *= 0.1
        if not ikde.check(robot, q).collision:
            return q


def free_rows(robot, rng, count):
    """Configurations [count, N] anywhere inside the limits that are free of collision."""
    collision, Q = CollisionModel.of(robot), random_q(robot, rng, 20 * count)
    free = (compute_gaps(collision, Q) > collision.limit_m).all(axis=1)
    assert free.sum() >= count
    return Q[free][:count]


def target_at(T_world_tool, kind):
    """The target of a kind that a tool pose [4, 4] meets."""
    p, R = T_world_tool[:3, 3], T_world_tool[:3, :3]
    return ikde.Target(p, **{"position": {}, "axis": {"axis_world_tool": R[:, 2]}, "pose": {"R_world_tool": R}}[kind])


def make_target(robot, q, kind):
    """Where the tool is at `q` [N], so that it can be reached."""
    return target_at(ikde.forward(robot, q)[robot.tool], kind)


def make_targets(robot, Q, kind):
    """Where the tool is at each row of `Q` [T, N]."""
    return ikde.Targets.of([target_at(T, kind) for T in ikde.forward(robot, Q)[robot.tool]])


def targets_near(robot, Q, rng):
    """A target of every kind in turn: what the tool does, or a little beside it, or something else."""
    T = ikde.forward(robot, rng.permutation(Q))[robot.tool].copy()
    T[::4] = ikde.forward(robot, Q[::4])[robot.tool]
    T[1::2, :3, 3] += 1e-9
    return ikde.Targets.of([target_at(pose, ("position", "axis", "pose")[k % 3]) for k, pose in enumerate(T)])
