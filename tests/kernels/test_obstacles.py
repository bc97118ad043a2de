"""The kernels' distances, against plain numpy, which shares nothing with them."""

import numpy as np
import pytest

from ikde.kernels.flat_arguments import unpack_world
from ikde.kernels.obstacles import solid_gap
from ikde.model.pack_world import pack_world
from ikde.model.robot import WORLD
from ikde.model.solids import KINDS, make_solid
from ikde.model.world import make_obstacle, make_world
from ikde.solver.plain_world import measure_obstacle
from tests.solids import random_pose, random_solid

FRAMES = {WORLD: np.eye(4)}


def unpack(obstacle):
    with np.errstate(all="ignore"):
        return unpack_world.plain(pack_world(make_world([obstacle]), ["hand"], FRAMES, 0.5, np.zeros(1)))


def gap(arrays, p, reach=np.inf):
    with np.errstate(all="ignore"):
        return solid_gap.plain(arrays, 0, *p.tolist(), reach, -np.inf)


@pytest.mark.parametrize("kind", KINDS)
def test_distances_are_those_of_plain_numpy(kind, rng):
    for _ in range(6):
        obstacle = make_obstacle("it", [random_solid(kind, rng, random_pose(rng, 0.2))], random_pose(rng))
        arrays, place = unpack(obstacle), obstacle.T_world_obstacle[:, 3]
        P = place + rng.uniform(-0.6, 0.6, (40, 3))
        expected = measure_obstacle(obstacle, P)
        assert np.abs([gap(arrays, p) for p in P] - expected).max() < 1e-12
        for p, exact in zip(P, expected, strict=True):
            for reach in (exact - 1e-9, exact + 1e-9, -0.1, 0.05):
                found = gap(arrays, p, reach)
                assert abs(found - exact) < 1e-12 if exact <= reach else found > reach


@pytest.mark.parametrize(("kind", "size"), [("box", (0.2, 0.2, 0.2)), ("cylinder", (0.1, 0.2)), ("cone", (0.1, 0.2))])
def test_on_edges_and_axes_too(kind, size):
    obstacle = make_obstacle("it", [make_solid(kind, size)])
    arrays, values = unpack(obstacle), (-0.3, -0.1, 0.0, 0.1, 0.3)
    P = np.array([[x, y, z] for x in values for y in values for z in values])
    assert np.abs([gap(arrays, p) for p in P] - measure_obstacle(obstacle, P)).max() < 1e-15


def test_a_point_of_a_cloud_that_is_just_as_far_as_asked_is_found():
    arrays = unpack(make_obstacle("scan", [make_solid("cloud", (0.25,), points=[[0.0, 0.0, 0.0]])]))
    assert gap(arrays, np.array([1.0, 0.0, 0.0]), 0.75) == 0.75


def test_a_cloud_says_nothing_beyond_its_reach(rng):
    points = rng.uniform(-1.0, 1.0, (3000, 3)) * [1.0, 1.0, 0.02]
    obstacle = make_obstacle("scan", [make_solid("cloud", (0.003,), points=points)])
    arrays, P = unpack(obstacle), rng.uniform(-1.5, 1.5, (60, 3)) * [1.0, 1.0, 0.3]
    for p, exact in zip(P, measure_obstacle(obstacle, P), strict=True):
        for reach in (0.0, 0.03, 0.2):
            found = gap(arrays, p, reach)
            assert abs(found - exact) < 1e-12 if exact <= reach else found > reach
