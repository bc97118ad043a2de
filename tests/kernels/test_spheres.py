"""Sphere centres: the key-point method and spatial transformation agree with their twins and with each other."""

import numpy as np
import pytest

from ikde.kernels.frames import compute_frames
from ikde.kernels.spheres import compute_centres_from_key_points
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import frame_names, pack_robot
from tests import reference
from tests.conftest import random_q
from tests.kernels.arrays import run_bodies, run_spheres
from tests.random_robots import random_robot

SEEDS = range(30)


def run_key_points(robot, detector, q):
    Ts_frame = np.full((len(frame_names(robot)), 3, 4), np.nan)
    compute_frames(pack_robot(robot), run_bodies(robot, q), Ts_frame)
    packed = CollisionModel(robot=robot, detector=detector).arrays
    centres = np.full((3, len(packed.radius)), np.nan)
    compute_centres_from_key_points(packed, Ts_frame, centres)
    return centres


def stack_centres(spheres):
    return np.array([centre for _, centre, _ in spheres]).T


@pytest.mark.parametrize("seed", SEEDS)
def test_centres_equal_spheres_carried_by_a_frame(seed, rng):
    robot = random_robot(seed)
    detector, q = CollisionModel.of(robot).detector, random_q(robot, rng)
    _, centres, _ = run_spheres(robot, detector, q)
    expected = stack_centres(reference.list_spheres(robot, detector, q, by_transformation=True))
    np.testing.assert_allclose(centres, expected, rtol=0, atol=1e-14)


@pytest.mark.parametrize("seed", SEEDS)
def test_centres_from_key_points_equal_rows_laid_between_them(seed, rng):
    robot = random_robot(seed)
    detector, q = CollisionModel.of(robot).detector, random_q(robot, rng)
    expected = stack_centres(reference.list_spheres(robot, detector, q))
    np.testing.assert_allclose(run_key_points(robot, detector, q), expected, rtol=0, atol=1e-13)


@pytest.mark.parametrize("name", ["single", "typical", "improved"])
def test_both_methods_place_the_paper_robots_spheres_alike(qiao, name, rng):
    detector = qiao.detectors[name]
    for q in random_q(qiao, rng, 5):
        _, centres, _ = run_spheres(qiao, detector, q)
        np.testing.assert_allclose(run_key_points(qiao, detector, q), centres, rtol=0, atol=1e-13)


@pytest.mark.parametrize("seed", SEEDS)
def test_bounding_spheres_hold_every_sphere_of_their_component(seed, rng):
    robot = random_robot(seed)
    detector, centres, bounds = run_spheres(robot, CollisionModel.of(robot).detector, random_q(robot, rng))
    for (_, first, last), middle, bound in zip(detector.components, bounds, detector.bounds, strict=True):
        needed = np.linalg.norm(centres[:, first:last].T - middle, axis=1) + detector.radius[first:last]
        assert needed.max() <= bound[3]
        assert needed.max() >= bound[3] * (1 - 1e-8)


@pytest.mark.parametrize("seed", range(10))
def test_bounds_follow_their_bodies(seed, rng):
    robot = random_robot(seed)
    q = random_q(robot, rng)
    detector, _, bounds = run_spheres(robot, CollisionModel.of(robot).detector, q)
    T_world_body = reference.compute_bodies(pack_robot(robot), q)
    for (body, _, _), p, middle in zip(detector.components, detector.bounds, bounds, strict=True):
        np.testing.assert_allclose(middle, (T_world_body[body] @ [*p[:3], 1.0])[:3], rtol=0, atol=1e-14)
