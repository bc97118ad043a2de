"""Boxes hold their solids, in their own frames and along the axes of the world."""

import numpy as np
import pytest

from ikde.kernels.world_grid import UPRIGHT, find_places, list_near
from ikde.model.pack_world import WorldPacker
from ikde.model.robot import WORLD
from ikde.model.solids import KINDS, make_solid
from ikde.model.world import make_obstacle, make_world
from ikde.model.world_boxes import find_boxes
from ikde.solver.plain_world import measure_obstacle
from tests.solids import random_pose, random_solid


def pack(obstacles):
    return WorldPacker(["hand"], {WORLD: np.eye(4)}, 0.1).pack(make_world(obstacles), np.zeros(1))


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_within_a_radius_is_listed(kind, rng):
    obstacles = [
        make_obstacle(f"o{k}", [random_solid(kind, rng, random_pose(rng, 0.2))], random_pose(rng), margin_m=0.01 * k)
        for k in range(5)
    ]
    whole, listed = pack(obstacles), 0
    places = find_places.plain(whole)
    assert places.columns == find_boxes(whole).shape[1]
    for p in rng.uniform(-1.0, 1.0, (60, 3)):
        gaps = np.array([measure_obstacle(obstacle, p[None])[0] - obstacle.margin_m for obstacle in obstacles])
        for radius in (0.05, 0.4):
            with np.errstate(all="ignore"):
                near = int(list_near.plain(whole, places.columns, places.boxes, *p.tolist(), radius))
            is_listed = np.array([near >> k & 1 == 1 for k in range(5)])
            assert near < 2**5
            assert is_listed[gaps <= radius].all() if kind != "half_space" else not near
            listed += is_listed.sum()
    assert listed < 600


def test_a_turned_box_is_left_out_by_its_own_axes():
    """Its corners along the axes of the world are empty."""
    turn = np.array([[1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, np.sqrt(2.0)]]) / np.sqrt(2.0)
    whole = pack([make_obstacle("board", [make_solid("box", (2.0, 0.01, 1.0))], np.column_stack([turn, np.zeros(3)]))])
    places, upright = find_places.plain(whole), find_boxes(whole)[UPRIGHT:, 0]
    assert (upright[:2] < -0.7).all()
    assert (upright[3:5] > 0.7).all()
    with np.errstate(all="ignore"):
        for x, y, is_near in ((0.6, 0.6, True), (0.6, -0.6, False)):
            assert bool(list_near.plain(whole, places.columns, places.boxes, x, y, 0.0, 0.1)) == is_near


def test_an_empty_world_has_no_boxes():
    assert find_boxes(pack([])).size == 0
