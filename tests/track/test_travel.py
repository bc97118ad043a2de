"""How far joints move points: never less than what differences of the kinematics say."""

import numpy as np
import pytest

from ikde.model.collision_model import CollisionModel
from ikde.model.tree import build_tree
from ikde.solver.plain import compute_components
from ikde.track.certify_world import reach_radii
from ikde.track.travel import chain_of, list_centres, max_radius
from tests.random_robots import random_robot

STEP = 1e-6


@pytest.mark.parametrize("seed", range(6))
def test_no_centre_moves_faster_than_the_radius(seed):
    robot, rng = random_robot(seed), np.random.default_rng(seed)
    model = CollisionModel.of(robot)
    for _ in range(3):
        q = rng.uniform(*robot.drawn)
        radii = reach_radii(model, np.abs(q) + STEP)
        for joint in range(len(q)):
            move = STEP * np.eye(len(q))[joint]
            ahead, behind = compute_components(model, q + move), compute_components(model, q - move)
            for name, row in zip(model.components, radii, strict=True):
                speed = np.linalg.norm(ahead[name][0] - behind[name][0], axis=-1).max() / (2.0 * STEP)
                assert speed <= row[joint] + 1e-6


def test_a_chain_runs_from_a_body_to_the_first_that_the_world_carries(qiao):
    tree, model = build_tree(qiao), CollisionModel.of(qiao)
    centres = list_centres(model)
    assert list(centres) == list(model.components)
    body = centres["LT"][0][0]
    chain = chain_of(tree, body)
    assert (chain[0], chain[-1], tree.bodies[chain[-1]].parent) == (body, 1, 0)
    assert chain_of(tree, 0) == []
    assert max_radius(qiao, tree, qiao.upper, chain, 1, centres["LT"][0][1]) == 1.0  # a base slides
