"""Rows of a world in a step, against plain numpy and its differences."""

import numpy as np
import pytest

import ikde
from ikde.kernels import step_constraints as kernels
from ikde.kernels.flat_arguments import unpack_world
from ikde.kernels.step_constraints import MAX_SOLIDS
from ikde.kernels.world_contacts import choose_place, set_normal
from ikde.model.collision_model import CollisionModel
from ikde.solver.plain import compute_gaps
from tests.conftest import random_q
from tests.kernels.driving import Stand
from tests.kernels.step_rows import DIFFERENCE, end_of, rows_at
from tests.uncompiled import plain

SOLIDS = (
    {"sphere": {"radius": 0.2}},
    {"box": [0.3, 0.2, 0.6]},
    {"capsule": {"radius": 0.1, "height": 0.4}},
    {"hull": {"points": [[0, 0, 0], [0.3, 0, 0], [0, 0.3, 0], [0, 0, 0.5]]}},
    {"cloud": {"points": [[0, 0, 0], [0.1, 0, 0.1], [0, 0.2, 0.1]], "radius": 0.02}},
)


def stand_in(qiao, rng, solids, name="differential", margin_m=0.01):
    """A step among solids about the arm."""
    stand = Stand(qiao, random_q(qiao, rng), name)
    stand.q[:2] = 0.0
    obstacles = {}
    for k, solid in enumerate(solids):
        obstacles[f"o{k}"] = {**solid, "position": rng.uniform([-0.8, -0.8, 0.2], [0.8, 0.8, 1.4]).tolist()}
    world = ikde.load_world({"obstacles": obstacles})
    model = CollisionModel.of(qiao).in_world(world, margin_m, {"M": 0.0})
    stand.spheres = model.arrays
    return stand, model


@pytest.mark.parametrize("name", ["differential", "omnidirectional"])
def test_what_is_near_has_its_room_and_its_slope(qiao, rng, name):
    stand, model = stand_in(qiao, rng, SOLIDS, name)
    stand.track = stand.track._replace(reach=0.3)
    step = rng.uniform(-1, 1, stand.size)
    slack, slope, place = rows_at(stand, step)
    pairs = len(model.pairs)
    of_world = place >= pairs
    gaps = compute_gaps(model, end_of(stand, step))
    near = np.sort(gaps[pairs:][gaps[pairs:] < 0.3])[:MAX_SOLIDS]
    assert len(near) > 2
    np.testing.assert_allclose(np.sort(slack[of_world]), near - stand.track.margin, atol=1e-9)
    np.testing.assert_allclose(slack[of_world], gaps[place[of_world]] - stand.track.margin, atol=1e-9)
    for k in range(stand.size):
        move = DIFFERENCE * np.eye(stand.size)[k]
        ends = [compute_gaps(model, end_of(stand, step + d))[place[of_world]] for d in (move, -move)]
        np.testing.assert_allclose(slope[of_world, k], (ends[0] - ends[1]) / (2 * DIFFERENCE), atol=1e-5)


def test_without_a_world_there_is_no_such_row(qiao, rng):
    stand, model = stand_in(qiao, rng, SOLIDS)
    stand.spheres = model.own.arrays
    stand.track = stand.track._replace(reach=0.3)
    assert (rows_at(stand, np.zeros(stand.size))[2] < len(model.pairs)).all()


def test_the_nearest_are_kept(rng):
    gap = np.array([0.3, 0.1, 0.2])
    choose = plain(choose_place)
    assert [choose(gap, 2, 0.5), choose(gap, 3, 0.25), choose(gap, 3, 0.4)] == [2, 0, -1]


def test_deep_in_a_ball_there_is_a_way_out(qiao, rng):
    world = ikde.load_world({"obstacles": {"ball": {"sphere": {"radius": 0.5}, "position": [0, 0, 5]}}})
    packed = plain(unpack_world)(CollisionModel.of(qiao).in_world(world).arrays.world)
    normal = np.empty(3)
    plain(set_normal)(packed, 0, 0.0, 0.3, 5.0, -0.2, normal)
    np.testing.assert_allclose(normal, [0, 1, 0], atol=1e-6)
    assert kernels.MAX_CONSTRAINTS == kernels.MAX_PAIRS + MAX_SOLIDS + 13
