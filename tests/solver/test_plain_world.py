"""Distances to solids, against dense samples of their surfaces and against each other."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

from ikde.model.solids import make_solid
from ikde.model.world import make_obstacle
from ikde.solver.plain_world import measure_obstacle, measure_solid
from tests.solids import CONVEX, random_pose, random_solid

BOX = [[x, y, z] for x in (-0.1, 0.1) for y in (-0.2, 0.2) for z in (-0.3, 0.3)]


def sample_surface(kind, size, rng, count=400_000):
    """Points of the surface of a solid about its z axis, of a box or a sphere."""
    turn, height = rng.uniform(-np.pi, np.pi, count), rng.uniform(-0.5, 0.5, count)
    ball = rng.standard_normal((count, 3))
    ball /= np.linalg.norm(ball, axis=1, keepdims=True)
    if kind == "sphere":
        return size[0] * ball
    if kind == "box":
        P = rng.uniform(-0.5, 0.5, (count, 3))
        P[np.arange(count), rng.integers(0, 3, count)] = rng.choice([-0.5, 0.5], count)
        return P * size
    radius, tall = size
    disk = np.sqrt(rng.random(count)) * radius
    if kind == "capsule":
        return np.vstack(
            [radius * ball + np.sign(ball[:, 2:]) * [0.0, 0.0, 0.5 * tall], wrap(radius, turn, tall * height)]
        )
    caps = [wrap(disk, turn, np.full(count, -0.5 * tall))]
    if kind == "cylinder":
        return np.vstack([*caps, wrap(disk, turn, np.full(count, 0.5 * tall)), wrap(radius, turn, tall * height)])
    return np.vstack([*caps, wrap(disk, turn, 0.5 * tall - tall * disk / radius)])


def wrap(radius, turn, z):
    return np.column_stack([radius * np.cos(turn), radius * np.sin(turn), z])


@pytest.mark.parametrize("kind", ["sphere", "box", "cylinder", "capsule", "cone"])
def test_a_distance_is_that_of_the_nearest_point_of_the_surface(kind, rng):
    size = {"sphere": (0.2,), "box": (0.2, 0.3, 0.4)}.get(kind, (0.2, 0.3))
    tree, P = cKDTree(sample_surface(kind, size, rng)), rng.uniform(-0.5, 0.5, (200, 3))
    gaps = measure_solid(make_solid(kind, size), P)
    assert np.abs(np.abs(gaps) - tree.query(P)[0]).max() < 4e-3  # the sample is as coarse as that
    assert 0 < (gaps < 0.0).sum() < len(P)


@pytest.mark.parametrize("kind", CONVEX)
def test_distances_grow_by_no_more_than_one_goes(kind, rng):
    solid = random_solid(kind, rng)
    P, step = rng.uniform(-0.6, 0.6, (300, 3)), rng.normal(0.0, 0.05, (300, 3))
    change = np.abs(measure_solid(solid, P + step) - measure_solid(solid, P))
    assert (change <= np.linalg.norm(step, axis=1) + 1e-12).all()


def test_a_box_is_the_hull_of_its_corners(rng):
    P = rng.uniform(-0.5, 0.5, (300, 3))
    gaps = measure_solid(make_solid("box", (0.2, 0.4, 0.6)), P), measure_solid(make_solid("hull", points=BOX), P)
    assert np.abs(gaps[0] - gaps[1]).max() < 1e-15


def test_a_half_space_is_all_below_its_plane():
    assert measure_solid(make_solid("half_space"), np.array([[5.0, 6.0, 0.25], [0.0, 0.0, -2.0]])).tolist() == [
        0.25,
        -2.0,
    ]


def test_a_cloud_is_as_near_as_its_nearest_ball(rng):
    points, P = rng.uniform(-1.0, 1.0, (5000, 3)), rng.uniform(-1.5, 1.5, (50, 3))
    gaps = measure_solid(make_solid("cloud", (0.01,), points=points), P)
    assert np.allclose(gaps, cKDTree(points).query(P)[0] - 0.01, atol=1e-15, rtol=0.0)


def test_an_obstacle_is_where_its_poses_say_and_as_near_as_its_nearest_solid(rng):
    solids = [random_solid(kind, rng, random_pose(rng, 0.2)) for kind in ("box", "cone")]
    T, own = random_pose(rng), rng.uniform(-0.5, 0.5, (40, 3))
    P = own @ T[:, :3].T + T[:, 3]
    gaps = measure_obstacle(make_obstacle("both", solids, T), P)
    assert np.allclose(gaps, np.minimum(*(measure_solid(solid, own) for solid in solids)), atol=1e-14, rtol=0.0)
