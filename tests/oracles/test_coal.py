"""Coal as the oracle of clearance: signed distances of all spheres, every detector of every robot that ships.

Sphere centres are laid out here again, from the rows of the robot and the origins of `forward`'s frames,
which `test_pinocchio` checks; coal measures the gaps.
"""

from itertools import product

import coal
import numpy as np
import pytest

import ikde
from ikde.kernels.clearance import compute_clearance, find_closest_spheres
from ikde.kernels.spheres import compute_bounds, compute_centres
from ikde.model.collision_model import CollisionModel
from tests.conftest import ROBOTS, random_q
from tests.kernels.arrays import run_bodies

DETECTORS = [(name, detector) for name in ROBOTS for detector in ikde.load_robot(name).detectors]
COUNT = 25
EXACT = 1e-12  # m; measured: at most 2e-15
NO_TURN = np.eye(3)


def row_points(row, start, end):
    """Centres of a row of spheres: one in the middle, `even` from end to end, or `touching`, 2R apart."""
    if row.count == 1:
        return [(start + end) / 2.0]
    if row.spacing == "even":
        return list(np.linspace(start, end, row.count))
    along = (end - start) / np.linalg.norm(end - start)
    first = (start + end) / 2.0 - (row.count - 1) * row.radius_m * along
    return [first + 2.0 * row.radius_m * k * along for k in range(row.count)]


def place_spheres(robot, detector, q):
    """Component -> its spheres as coal knows them: shape and placement in the world."""
    Ts_world = {"world": np.eye(4), **ikde.forward(robot, q)}
    placed = {}
    for row in robot.approximations[detector.spheres]:
        start, end = Ts_world[row.start][:3, 3], Ts_world[row.end][:3, 3]
        points = row_points(row, start, end)
        spheres = [(coal.Sphere(row.radius_m), coal.Transform3s(NO_TURN, p)) for p in points]
        placed.setdefault(row.component, []).extend(spheres)
    return placed


def coal_gap(a, b):
    """Smallest signed distance between two components by coal, m."""
    request = coal.DistanceRequest()
    request.enable_signed_distance = True
    return min(coal.distance(*one, *other, request, coal.DistanceResult()) for one, other in product(a, b))


def coal_gaps(robot, detector, q):
    """Signed distance of every pair of the detector, in the order of its list [P]."""
    placed = place_spheres(robot, detector, q)
    return np.array([coal_gap(placed[a], placed[b]) for a, b in robot.pair_lists[detector.pairs]])


def kernel_spheres(robot, detector, q):
    """Packed detector, bounding spheres [C, 3] and sphere centres [3, S] by the kernels."""
    packed, T_world_body = CollisionModel(robot=robot, detector=detector).arrays, run_bodies(robot, q)
    bounds, centres = packed.bounds.copy(), np.empty((3, packed.radius.size))
    compute_bounds(packed, T_world_body, bounds)
    compute_centres(packed, T_world_body, centres)
    return packed, bounds, centres


@pytest.fixture(params=DETECTORS, ids="-".join)
def case(request, rng):
    """A robot, one of its detectors, home with some random joint values, and coal's gaps for each of them."""
    name, choice = request.param
    robot = ikde.load_robot(name)
    detector = robot.detectors[choice]
    configurations = np.vstack([robot.home, random_q(robot, rng, COUNT)])
    return robot, detector, configurations, [coal_gaps(robot, detector, q) for q in configurations]


def test_coal_gives_the_depth_of_penetration_as_a_negative_distance():
    ball = coal.Sphere(0.5)
    gap = coal_gap(
        [(ball, coal.Transform3s(NO_TURN, np.zeros(3)))], [(ball, coal.Transform3s(NO_TURN, np.ones(3) / 4))]
    )
    assert gap == pytest.approx(np.sqrt(3.0) / 4.0 - 1.0, abs=1e-15)


def test_configurations_show_contact_and_room(case):
    *_, gaps = case
    assert np.min(gaps) < 0.0 < np.max(gaps)


def test_check_measures_every_pair_as_coal_does(case):
    robot, detector, configurations, gaps = case
    for q, expected in zip(configurations, gaps, strict=True):
        found = {(pair.a, pair.b): pair.clearance_m for pair in ikde.check(robot, q, detector).pairs}
        measured = [found[pair] for pair in robot.pair_lists[detector.pairs]]
        np.testing.assert_allclose(measured, expected, rtol=0, atol=EXACT)


def test_check_sees_a_collision_exactly_where_coal_sees_contact(case):
    robot, detector, configurations, gaps = case
    for q, expected in zip(configurations, gaps, strict=True):
        assert ikde.check(robot, q, detector).collision == bool(expected.min() <= detector.safe_distance_m)


def test_kernel_measures_every_pair_as_coal_does(case):
    robot, detector, configurations, gaps = case
    for q, expected in zip(configurations, gaps, strict=True):
        packed, _, centres = kernel_spheres(robot, detector, q)
        measured = [find_closest_spheres(packed, centres, a, b)[0] for a, b in packed.pairs]
        np.testing.assert_allclose(measured, expected, rtol=0, atol=EXACT)


def test_kernel_finds_the_smallest_clearance_and_its_pair_as_coal_does(case):
    robot, detector, configurations, gaps = case
    for q, expected in zip(configurations, gaps, strict=True):
        clearance, pair = compute_clearance(*kernel_spheres(robot, detector, q))
        assert clearance == pytest.approx(expected.min(), abs=EXACT)
        assert expected[pair] == pytest.approx(expected.min(), abs=EXACT)
