"""Clearance and collision against brute force, and the laws between them."""

import math

import numpy as np
import pytest

from ikde.kernels.clearance import (
    DEPTH_STEP,
    collides,
    compute_clearance,
    compute_depth,
    count_colliding_pairs,
    find_closest_spheres,
    judge_centres,
)
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot
from tests import reference
from tests.conftest import random_q
from tests.kernels.arrays import run_bodies, run_spheres, two_spheres
from tests.random_robots import random_robot

SEEDS = range(40)


def sample(seed, rng, count=8):
    """Configurations of a random robot: (robot, detector, q, packed detector, centres, bounds)."""
    robot = random_robot(seed)
    detector = CollisionModel.of(robot).detector
    for q in random_q(robot, rng, count):
        yield robot, detector, q, *run_spheres(robot, detector, q)


@pytest.mark.parametrize("seed", SEEDS)
def test_clearance_equals_brute_force(seed, rng):
    for robot, detector, q, packed, centres, bounds in sample(seed, rng):
        clearance, pair = compute_clearance(packed, bounds, centres)
        expected, expected_pair = reference.compute_clearance(robot, detector, q)
        assert clearance == pytest.approx(expected, abs=1e-14)
        assert pair == expected_pair


@pytest.mark.parametrize("name", ["single", "typical", "improved"])
def test_clearance_of_the_paper_robot_equals_brute_force(qiao, name, rng):
    detector = qiao.detectors[name]
    for q in random_q(qiao, rng, 10):
        packed, centres, bounds = run_spheres(qiao, detector, q)
        clearance, pair = compute_clearance(packed, bounds, centres)
        expected, expected_pair = reference.compute_clearance(qiao, detector, q)
        assert clearance == pytest.approx(expected, abs=1e-13)
        assert pair == expected_pair


@pytest.mark.parametrize("seed", SEEDS)
def test_pair_clearance_equals_brute_force(seed, rng):
    for robot, detector, q, packed, centres, _ in sample(seed, rng, 2):
        spheres = reference.list_spheres(robot, detector, q)
        expected = reference.compute_pair_clearances(spheres, robot.pair_lists[detector.pairs])
        found = [find_closest_spheres(packed, centres, a, b) for a, b in packed.pairs]
        np.testing.assert_allclose([gap for gap, _, _ in found], expected, rtol=0, atol=1e-14)
        for gap, i, j in found:
            apart = np.linalg.norm(centres[:, i] - centres[:, j])
            assert gap == pytest.approx(apart - packed.radius[i] - packed.radius[j], abs=1e-14)


@pytest.mark.parametrize("seed", SEEDS)
def test_early_exit_equals_brute_force(seed, rng):
    for robot, detector, q, packed, centres, bounds in sample(seed, rng):
        clearance, _ = reference.compute_clearance(robot, detector, q)
        assert bool(collides(packed, bounds, centres)) == (clearance <= detector.safe_distance_m)


@pytest.mark.parametrize("seed", SEEDS)
def test_it_collides_exactly_when_the_clearance_is_within_the_safe_distance(seed, rng):
    for _, _, _, packed, centres, bounds in sample(seed, rng):
        clearance, _ = compute_clearance(packed, bounds, centres)
        for safe_distance in (0.0, 0.1, max(0.0, clearance - 1e-9), max(0.0, clearance + 1e-9)):
            detector = packed._replace(safe_distance=safe_distance)
            assert bool(collides(detector, bounds, centres)) == (clearance <= safe_distance)


def test_random_robots_show_both_collisions_and_freedom(rng):
    seen = [bool(collides(packed, b, c)) for seed in SEEDS for *_, packed, c, b in sample(seed, rng)]
    assert 0.1 < np.mean(seen) < 0.9


@pytest.mark.parametrize("seed", SEEDS)
def test_counted_pairs_are_those_within_the_safe_distance(seed, rng):
    for robot, detector, q, packed, centres, bounds in sample(seed, rng, 2):
        out_counts = np.zeros(len(packed.pairs), dtype=np.int64)
        count_colliding_pairs(packed, bounds, centres, out_counts)
        spheres = reference.list_spheres(robot, detector, q)
        clearances = reference.compute_pair_clearances(spheres, robot.pair_lists[detector.pairs])
        np.testing.assert_array_equal(out_counts, clearances <= detector.safe_distance_m)


@pytest.mark.parametrize("seed", SEEDS)
def test_depth_is_how_far_the_clearance_misses_the_safe_distance(seed, rng):
    for robot, detector, q, packed, centres, bounds in sample(seed, rng, 4):
        depth = compute_depth(packed, run_bodies(robot, q), bounds, centres)
        assert depth == pytest.approx(reference.compute_depth(robot, detector, q), abs=1e-14)


@pytest.mark.parametrize("name", ["single", "typical", "improved"])
def test_clearance_is_the_same_wherever_the_base_stands(qiao, name, rng):
    for q in random_q(qiao, rng, 10):
        moved = np.concatenate([random_q(qiao, rng)[:3], q[3:]])
        packed, centres, bounds = run_spheres(qiao, qiao.detectors[name], q)
        _, moved_centres, moved_bounds = run_spheres(qiao, qiao.detectors[name], moved)
        here, _ = compute_clearance(packed, bounds, centres)
        there, _ = compute_clearance(packed, moved_bounds, moved_centres)
        assert here == pytest.approx(there, abs=1e-13)


@pytest.mark.parametrize(("distance", "expected"), [(2.0, 0.5), (1.5, 0.0), (1.0, -0.5), (0.0, -1.5)])
def test_clearance_of_two_spheres_is_known(distance, expected):
    detector, centres, bounds = two_spheres(distance, (1.0, 0.5))
    assert compute_clearance(detector, bounds, centres) == (expected, 0)
    assert bool(collides(detector, bounds, centres)) == (expected <= 0.0)


def test_touching_at_the_safe_distance_collides_with_the_smallest_depth():
    detector, centres, bounds = two_spheres(2.0, (1.0, 0.5), safe_distance=0.5)
    world = np.eye(3, 4)[None]
    assert collides(detector, bounds, centres)
    assert compute_depth(detector, world, bounds, centres) == DEPTH_STEP


def test_without_pairs_the_clearance_is_infinite(qiao):
    detector = CollisionModel.of(qiao, "none").arrays
    bounds, centres = np.zeros((0, 3)), np.zeros((3, 0))
    assert compute_clearance(detector, bounds, centres) == (math.inf, -1)
    assert not collides(detector, bounds, centres)


@pytest.mark.parametrize("seed", range(12))
def test_rows_are_judged_one_by_one(seed, rng):
    robot = random_robot(seed)
    qs, verdicts = random_q(robot, rng, 20), np.zeros(20, dtype=bool)
    packed = CollisionModel.of(robot).arrays
    judge_centres(pack_robot(robot), packed, qs, verdicts)
    seen = [run_spheres(robot, CollisionModel.of(robot).detector, q) for q in qs]
    assert verdicts.tolist() == [bool(collides(packed, bounds, centres)) for packed, centres, bounds in seen]
