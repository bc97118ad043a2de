"""What written kernels ask of a world is what the tables say."""

import numpy as np

from ikde.kernels.arrays import DescentArrays
from ikde.kernels.flat_arguments import flatten_search
from ikde.kernels.world import find_obstacle_at, find_obstacle_of, stands_in_world
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot
from ikde.solver.engines.pool import no_pool
from ikde.solver.plain import compute_frames, compute_world_gaps
from tests.solids import random_world
from tests.three_joints import ROBOT

OWN = CollisionModel.of(ROBOT)


def lay_out(model):
    ranges = np.array([ROBOT.lower, ROBOT.upper, ROBOT.home])
    return flatten_search(pack_robot(ROBOT), model.arrays, ranges, DescentArrays(), no_pool(ROBOT, 1.0))[:2]


def test_behind_a_block_stands_the_world(rng):
    kinds = ("box", "cylinder", "cone", "hull")
    model, found = OWN.in_world(random_world(rng, 6, kinds=kinds, far=0.9), 0.01, {"post": 0.0}), []
    numbers, whole = lay_out(model)
    assert stands_in_world.plain(whole)
    for q in rng.uniform(ROBOT.lower, ROBOT.upper, (12, 3)):
        with np.errstate(all="ignore"):
            hit = find_obstacle_at.plain(numbers, whole, q)
            assert hit == find_obstacle_of.plain(pack_robot(ROBOT), model.arrays, q)
        gaps = compute_world_gaps(model, q, compute_frames(ROBOT, q))
        hits = model.fold(np.append(np.zeros(len(model.pairs), bool), gaps <= model.limit_m))
        assert hits[hit] if hit >= 0 else not hits.any()
        found.append(hit >= 0)
    assert len(found) == 12


def test_without_a_world_there_is_nothing():
    assert not stands_in_world.plain(lay_out(OWN)[1])
