"""Surface points both ways, the gap between them, and what eq. 18 and eq. 20 of the paper see of a contact."""

import numpy as np
import pytest

from ikde.kernels.paper import (
    compute_surface_by_transformation,
    compute_surface_from_centres,
    compute_surface_gap,
    judge_surfaces,
    place_by_key_points,
    place_by_transformation,
    smallest_squared_distance,
    surfaces_collide,
)
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import frame_names, pack_robot
from tests import reference
from tests.conftest import random_q
from tests.kernels.arrays import run_bodies, run_spheres, two_spheres
from tests.random_robots import random_robot

DIRECTIONS, COVERING_ANGLE = reference.make_directions(4, 6)
FINE_DIRECTIONS, FINE_ANGLE = reference.make_directions(24, 48)


def from_centres(detector, centres, directions):
    out_points = np.full((len(detector.radius), len(directions), 3), np.nan)
    compute_surface_from_centres(detector, centres, directions, out_points)
    return out_points


def by_transformation(detector, T_world_body, directions):
    out_points = np.full((len(detector.radius), len(directions), 3), np.nan)
    compute_surface_by_transformation(detector, T_world_body, directions, out_points)
    return out_points


def test_directions_have_length_one_and_none_is_farther_than_the_covering_angle(rng):
    np.testing.assert_allclose(np.linalg.norm(DIRECTIONS, axis=1), 1.0, rtol=1e-15)
    others = rng.normal(size=(5000, 3))
    others /= np.linalg.norm(others, axis=1)[:, None]
    assert np.arccos((others @ DIRECTIONS.T).max(axis=1)).max() <= COVERING_ANGLE


@pytest.mark.parametrize("seed", range(12))
def test_points_from_centres_are_those_of_eq_11(seed, rng):
    robot = random_robot(seed)
    q, name = random_q(robot, rng), CollisionModel.of(robot).detector
    detector, centres, _ = run_spheres(robot, name, q)
    spheres = reference.list_spheres(robot, name, q)
    expected = reference.compute_surface_from_centres(
        [centre for _, centre, _ in spheres], [radius for _, _, radius in spheres], DIRECTIONS
    )
    np.testing.assert_allclose(from_centres(detector, centres, DIRECTIONS), expected, rtol=0, atol=1e-13)


@pytest.mark.parametrize("seed", range(12))
def test_transformed_points_are_fixed_in_their_body(seed, rng):
    robot = random_robot(seed)
    q = random_q(robot, rng)
    detector, _, _ = run_spheres(robot, CollisionModel.of(robot).detector, q)
    points = by_transformation(detector, run_bodies(robot, q), DIRECTIONS)
    T_world_body = reference.compute_bodies(pack_robot(robot), q)
    for body, first, last in detector.components:
        for sphere in range(first, last):
            p_body = detector.p_body_sphere[:, sphere] + detector.radius[sphere] * DIRECTIONS
            expected = [(T_world_body[body] @ [*p, 1.0])[:3] for p in p_body]
            np.testing.assert_allclose(points[sphere], expected, rtol=0, atol=1e-14)


def test_both_ways_put_every_point_on_its_sphere(qiao, rng):
    q = random_q(qiao, rng)
    detector, centres, _ = run_spheres(qiao, CollisionModel.of(qiao).detector, q)
    clouds = from_centres(detector, centres, DIRECTIONS), by_transformation(detector, run_bodies(qiao, q), DIRECTIONS)
    for points in clouds:
        distances = np.linalg.norm(points - centres.T[:, None], axis=2)
        np.testing.assert_allclose(distances, np.broadcast_to(detector.radius[:, None], distances.shape), atol=1e-13)


@pytest.mark.parametrize("covering_angle", [0.0, COVERING_ANGLE])
@pytest.mark.parametrize("seed", range(12))
def test_the_gap_equals_brute_force(seed, covering_angle, rng):
    robot = random_robot(seed)
    detector, centres, _ = run_spheres(robot, CollisionModel.of(robot).detector, random_q(robot, rng))
    points = from_centres(detector, centres, DIRECTIONS)
    sizes = [last - first for _, first, last in detector.components]
    group_of = np.repeat(np.arange(len(sizes)), sizes)
    expected, pair = reference.compute_surface_gap(points, detector.radius, group_of, detector.pairs, covering_angle)
    found, found_pair = compute_surface_gap(detector, points, covering_angle)
    assert found == pytest.approx(expected, abs=1e-14)
    assert found_pair == pair


def test_the_smallest_distance_of_two_clouds_is_over_all_points(rng):
    a, b = rng.normal(size=(30, 3)), rng.normal(size=(20, 3))
    expected = (np.linalg.norm(a[:, None] - b[None], axis=2) ** 2).min()
    assert smallest_squared_distance(a, b) == pytest.approx(expected, rel=1e-14)


def gap_of_two(distance, radii, directions, covering_angle):
    detector, centres, _ = two_spheres(distance, radii)
    return compute_surface_gap(detector, from_centres(detector, centres, directions), covering_angle)[0]


def test_eq_18_misses_a_contact_that_eq_20_finds():
    distance, radii = 1.3, (1.0, 0.7)  # they overlap by 0.4
    assert gap_of_two(distance, radii, FINE_DIRECTIONS, 0.0) > 0.0
    assert gap_of_two(distance, radii, FINE_DIRECTIONS, FINE_ANGLE) <= 0.0


def test_eq_18_sees_spheres_that_touch_exactly_in_a_grid_point():
    assert gap_of_two(1.5, (1.0, 0.5), DIRECTIONS, 0.0) == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize("grid", [(DIRECTIONS, COVERING_ANGLE), (FINE_DIRECTIONS, FINE_ANGLE)], ids=["coarse", "fine"])
def test_eq_20_never_misses_surfaces_that_cross(grid, rng):
    directions, covering_angle = grid
    for _ in range(100):
        r1, r2 = rng.uniform(0.05, 1.0, 2)
        distance = rng.uniform(abs(r1 - r2), r1 + r2)
        turn = reference.Rotation.random(rng=rng).as_matrix()
        assert gap_of_two(distance, (r1, r2), directions @ turn.T, covering_angle) <= 0.0


def test_neither_sees_a_sphere_deep_inside_another():
    assert gap_of_two(0.0, (1.0, 0.2), FINE_DIRECTIONS, FINE_ANGLE) > 0.0


def test_eq_20_sees_distant_spheres_apart():
    assert gap_of_two(3.0, (1.0, 0.7), FINE_DIRECTIONS, FINE_ANGLE) > 0.0


@pytest.mark.parametrize("limit", [0.0, 0.05])
@pytest.mark.parametrize("covering_angle", [0.0, COVERING_ANGLE])
@pytest.mark.parametrize("seed", range(12))
def test_the_quick_verdict_is_that_of_the_gap(seed, covering_angle, limit, rng):
    robot = random_robot(seed)
    detector, centres, _ = run_spheres(robot, CollisionModel.of(robot).detector, random_q(robot, rng))
    gap, _ = compute_surface_gap(detector, from_centres(detector, centres, DIRECTIONS), covering_angle)
    assert surfaces_collide(detector, centres, DIRECTIONS, covering_angle, limit) == (gap <= limit)


@pytest.mark.parametrize("distance", [0.0, 0.1, 0.3, 0.31, 0.8, 1.5, 1.69, 1.7, 1.71, 1.9, 3.0])
def test_the_quick_verdict_holds_from_deep_inside_to_far_apart(distance):
    detector, centres, _ = two_spheres(distance, (1.0, 0.7))
    for covering_angle in (0.0, COVERING_ANGLE):
        seen = gap_of_two(distance, (1.0, 0.7), DIRECTIONS, covering_angle) <= 0.0
        assert surfaces_collide(detector, centres, DIRECTIONS, covering_angle, 0.0) == seen


def test_rows_are_judged_one_by_one(qiao, rng):
    qs, verdicts = random_q(qiao, rng, 50), np.zeros(50, dtype=bool)
    packed = run_spheres(qiao, CollisionModel.of(qiao).detector, qs[0])[0]
    judge_surfaces(pack_robot(qiao), packed, DIRECTIONS, 0.0, 0.01, qs, verdicts)
    expected = [
        surfaces_collide(packed, run_spheres(qiao, CollisionModel.of(qiao).detector, q)[1], DIRECTIONS, 0.0, 0.01)
        for q in qs
    ]
    assert verdicts.tolist() == expected


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
