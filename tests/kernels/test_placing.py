"""Placements as they are timed give what the single kernels give."""

import numpy as np
import pytest

from ikde.kernels.placing import place_by_key_points, place_by_transformation
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import frame_names, pack_robot
from tests import reference
from tests.conftest import random_q
from tests.kernels.arrays import run_spheres
from tests.random_robots import random_robot

DIRECTIONS, _ = reference.make_directions(4, 6)


@pytest.mark.parametrize("seed", range(6))
def test_both_ways_place_the_same_centres(seed, rng):
    robot = random_robot(seed)
    q = random_q(robot, rng)
    packed, expected, _ = run_spheres(robot, CollisionModel.of(robot).detector, q)
    bodies = np.zeros((len(robot.joints) + 1, 3, 4))
    frames = np.zeros((len(frame_names(robot)), 3, 4))
    for place, poses in ((place_by_transformation, (bodies,)), (place_by_key_points, (bodies, frames))):
        for moves in (True, False):  # the second time at the poses that the first left behind
            centres, points = np.full_like(expected, np.nan), np.empty((packed.radius.size, 0, 3))
            place(pack_robot(robot), packed, np.empty((0, 3)), q, moves, 3, *poses, centres, points)
            np.testing.assert_allclose(centres, expected, rtol=0, atol=1e-13)


@pytest.mark.parametrize("seed", range(6))
def test_both_ways_place_points_on_the_spheres(seed, rng):
    robot = random_robot(seed)
    q = random_q(robot, rng)
    packed, expected, _ = run_spheres(robot, CollisionModel.of(robot).detector, q)
    bodies = np.zeros((len(robot.joints) + 1, 3, 4))
    frames = np.zeros((len(frame_names(robot)), 3, 4))
    for place, poses in ((place_by_transformation, (bodies,)), (place_by_key_points, (bodies, frames))):
        points = np.full((packed.radius.size, len(DIRECTIONS), 3), np.nan)
        place(pack_robot(robot), packed, DIRECTIONS, q, True, 2, *poses, np.empty_like(expected), points)
        distances = np.linalg.norm(points - expected.T[:, None], axis=2)
        np.testing.assert_allclose(distances, np.broadcast_to(packed.radius[:, None], distances.shape), atol=1e-13)
