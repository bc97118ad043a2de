"""How far components move while joints move within their slack: never further than the bound says."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import ikde
from ikde.model.closed_form import find_ur_arm
from ikde.model.collision_model import CollisionModel
from ikde.solver.arm_motions import find_motions
from ikde.solver.plain import compute_frames, compute_gaps
from tests.conftest import random_q

UR5, QIAO = ikde.load_robot("ur5"), ikde.load_robot("qiao2021")
CASES = [(UR5, ()), (QIAO, ()), (QIAO, ("d_x",)), (QIAO, ("q_z",))]
each_case = pytest.mark.parametrize(("robot", "carriers"), CASES, ids=["ur5", "qiao2021", "rail", "turn"])
BALLS = {"left": [1.5, 0.4, 1.0], "right": [-0.8, -0.9, 0.7]}
WORLD = {"obstacles": {name: {"sphere": {"radius": 0.1}, "position": place} for name, place in BALLS.items()}}


def change_of(robot, carriers, rng, size, count=200):
    """Configurations, those beside them, and the joints that differ."""
    joints = [*find_ur_arm(robot).coordinates, *map(robot.joint_names.index, carriers)]
    Q, change = random_q(robot, rng, count), np.zeros((count, len(robot.joints)))
    change[:, joints] = rng.uniform(-size, size, (count, len(joints))) * (rng.random((count, len(joints))) < 0.4)
    return Q, change, joints


def measure_tool(robot, Q, change):
    """How far the tool moves, m, and turns, rad."""
    before, after = (compute_frames(robot, q)[robot.tool] for q in (Q, Q + change))
    moved = np.linalg.norm(after[:, :3, 3] - before[:, :3, 3], axis=1)
    return moved, Rotation.from_matrix(np.einsum("tji,tjk->tik", before[:, :3, :3], after[:, :3, :3])).magnitude()


@each_case
@pytest.mark.parametrize("size", [1e-3, 0.1])
def test_components_move_no_further_than_the_bound_says(robot, carriers, size, rng):
    """Against each other and in a world; from both ends: by the joints alone, and with a tool that hardly moves."""
    collision = CollisionModel.of(robot)
    among = collision.in_world(ikde.load_world(WORLD))
    Q, change, joints = change_of(robot, carriers, rng, size)
    motions, tightest = find_motions(collision, tuple(joints)), np.zeros(2)
    moved, turned = measure_tool(robot, Q, change)
    before, after = compute_gaps(among, Q), compute_gaps(among, Q + change)
    compared = np.isfinite(before)  # not what no joint moves
    gaps = np.abs(np.where(compared, after, 0.0) - np.where(compared, before, 0.0))
    own = len(collision.pairs)
    for row in range(len(Q)):
        given = np.abs(change[row : row + 1, joints]), moved[row], turned[row]
        bounds = motions.bound_m(*given)[0], motions.bound_in_world_m(*given, among)[0]
        for k, (bound, gap) in enumerate(zip(bounds, (gaps[row, :own], gaps[row, own:]), strict=True)):
            assert (gap <= bound + 1e-12).all()
            tightest[k] = max(tightest[k], (gap / np.maximum(bound, 1e-12)).max())
    assert (tightest > 0.3).all()


def test_a_tool_that_may_be_anywhere_says_nothing(rng):
    """Only what the joints say is left, as without a tool."""
    collision = CollisionModel.of(UR5).in_world(ikde.load_world(WORLD))
    motions = find_motions(collision.own, find_ur_arm(UR5).coordinates)
    slack, anywhere = np.full((1, 6), 0.1), np.array([[np.inf]])
    near = motions.bound_in_world_m(slack, 0.0, 0.0, collision)
    far = motions.bound_in_world_m(slack, anywhere, 0.0, collision)
    assert np.isfinite(far).all()
    assert (far >= near).all()
    assert (far > near).any()
