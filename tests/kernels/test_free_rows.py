"""Rows are judged one after the other: what one leaves behind does not count for the next."""

import numpy as np

from ikde.kernels.flat_arguments import flatten_models
from ikde.kernels.free_rows import judge_rows
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot
from tests.solids import random_world
from tests.three_joints import ROBOT


def test_the_order_of_rows_does_not_matter(rng):
    model = CollisionModel.of(ROBOT).in_world(random_world(rng, 4, kinds=("box", "half_space"), far=0.9))
    block, rows = flatten_models(pack_robot(ROBOT), model.arrays), rng.uniform(ROBOT.lower, ROBOT.upper, (15, 3))
    forth, back = np.empty(15, dtype=bool), np.empty(15, dtype=bool)
    with np.errstate(all="ignore"):
        judge_rows.plain(*block, rows, forth)
        judge_rows.plain(*block, rows[::-1], back)
    assert forth.tolist() == back[::-1].tolist()
