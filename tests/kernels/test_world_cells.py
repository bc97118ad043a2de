"""Cells at their corners, where a point is farthest from the middle of its own, and obstacles of several solids."""

import numpy as np
import pytest

from ikde.kernels.flat_arguments import unpack_world
from ikde.kernels.world_grid import count_obstacles, find_hit
from ikde.model import pack_world as module
from ikde.model.collision_model import CollisionModel
from ikde.model.pack_world import find_fixed_frames, pack_world
from ikde.model.solids import make_solid
from ikde.model.world import make_obstacle, make_world
from tests.three_joints import ROBOT

OWN = CollisionModel.of(ROBOT).arrays
SMALL, R = 0.002, 0.1  # m: of the solids, and of the only sphere of what moves
BALL = OWN._replace(components=np.array([[0, 0, 1]]), radius=np.array([R]), bounds=np.array([[0.0, 0.0, 0.0, R]]))


def sphere(name, p, radius=SMALL, **options):
    return make_obstacle(name, [make_solid("sphere", [radius])], np.column_stack([np.eye(3), p]), **options)


def pack(obstacles):
    return pack_world(make_world(obstacles), ["ball"], find_fixed_frames(ROBOT), R, np.zeros(1))


@pytest.mark.parametrize("margin_m", [0.0, 0.05, 0.4])
def test_what_is_just_near_enough_is_found_from_the_corner_of_a_cell(margin_m, rng, monkeypatch):
    monkeypatch.setattr(module, "MIN_FOR_GRID", 2)
    ends = [sphere("low", (-1.5, -1.5, -1.5)), sphere("high", (1.5, 1.5, 1.5))]
    grid = unpack_world.plain(pack(ends)).grid
    for corner in rng.integers(12, 25, (25, 3)):
        towards = rng.choice([-1.0, 1.0], 3)
        p = grid[:3] + grid[3] * corner - 1e-9 * towards  # in the cell on the other side
        for short_m, is_near in ((1e-7, True), (-1e-7, False)):
            place = p + towards / np.sqrt(3.0) * (R + SMALL + margin_m - short_m)
            world = unpack_world.plain(pack([*ends, sphere("it", place, margin_m=margin_m)]))
            assert (world.grid[:3] == grid[:3]).all()
            with np.errstate(all="ignore"):
                assert (find_hit.plain(world, BALL, p[None], p[:, None]) >= 0) == is_near


def test_an_obstacle_of_several_solids_counts_once():
    twice = make_obstacle("twice", [make_solid("sphere", [0.1]), make_solid("box", [0.1, 0.1, 0.1])])
    world, counts = pack([sphere("away", (1.0, 0.0, 0.0)), twice]), np.zeros(len(OWN.pairs) + 2, dtype=np.int64)
    p = np.array([0.05, 0.0, 0.0])
    with np.errstate(all="ignore"):
        count_obstacles.plain(BALL._replace(world=world), p[None], p[:, None], counts)
    assert counts.tolist() == [0] * len(OWN.pairs) + [0, 1]
