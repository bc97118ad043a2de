"""`check`: the clearance of every pair, worst first; collision begins at the safe distance, which belongs to it."""

import pickle
from copy import deepcopy
from dataclasses import replace

import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from tests.conftest import ROBOTS, random_q

DETECTORS = [(name, detector) for name in ROBOTS for detector in ikde.load_robot(name).detectors]
every_detector = pytest.mark.parametrize(("name", "detector"), DETECTORS)


@every_detector
def test_every_pair_is_there_once_and_the_worst_is_first(name, detector, rng):
    robot = ikde.load_robot(name)
    result = ikde.check(robot, random_q(robot, rng), detector)
    clearances = [pair.clearance_m for pair in result.pairs]
    assert clearances == sorted(clearances)
    assert result.clearance_m == clearances[0]
    pairs = robot.pair_lists[robot.detectors[detector].pairs]
    assert sorted((pair.a, pair.b) for pair in result.pairs) == sorted(pairs)
    assert result.detector == detector


@every_detector
def test_a_pair_collides_exactly_from_the_safe_distance_on(name, detector, rng):
    robot = ikde.load_robot(name)
    q = robot.home
    for pair in ikde.check(robot, q, detector).pairs:
        if pair.clearance_m < 0.0:
            continue
        for distance, collides in (
            (pair.clearance_m, True),
            (np.nextafter(pair.clearance_m, np.inf), True),
            (max(0.0, np.nextafter(pair.clearance_m, -np.inf)), False),
        ):
            judge = replace(robot.detectors[detector], safe_distance_m=float(distance))
            result = ikde.check(robot, q, judge)
            found = {(other.a, other.b): other.collides for other in result.pairs}
            assert found[pair.a, pair.b] is collides
            assert result.collision is any(found.values())


def test_collision_means_that_some_pair_collides(qiao, rng):
    verdicts = set()
    for q in random_q(qiao, rng, 60):
        result = ikde.check(qiao, q)
        verdicts.add(result.collision)
        assert result.collision == any(pair.collides for pair in result.pairs) == (result.clearance_m <= 0.0)
        assert all(pair.collides == (pair.clearance_m <= 0.0) for pair in result.pairs)
    assert verdicts == {True, False}


def test_clearance_does_not_depend_on_where_the_base_stands(qiao, rng):
    for q in random_q(qiao, rng, 10):
        moved = q + np.array([1.5, -2.0, 0.7, 0, 0, 0, 0, 0, 0])
        assert ikde.check(qiao, moved).clearance_m == pytest.approx(ikde.check(qiao, q).clearance_m, abs=1e-12)


def test_clearance_is_the_distance_of_the_closest_spheres(qiao):
    """J4 and J6 at home, written out: centres of two single spheres, radius 70 mm each."""
    frames = ikde.forward(qiao, qiao.home)
    distance = np.linalg.norm(frames["O3"][:3, 3] - frames["O6"][:3, 3])
    pairs = {(pair.a, pair.b): pair.clearance_m for pair in ikde.check(qiao, qiao.home).pairs}
    assert pairs["J4", "J6"] == pytest.approx(distance - 0.14, abs=1e-15)


@pytest.mark.parametrize(("name", "choice"), [("qiao2021", "none"), ("qiao2021_dh", None)])
def test_without_a_detector_collision_is_not_checked(name, choice):
    robot = ikde.load_robot(name)
    result = ikde.check(robot, robot.home, choice)
    assert (result.collision, result.clearance_m, result.pairs) == (None, None, ())
    assert (result.detector, result.safe_distance_m) == ("none", 0.0)


def test_values_outside_the_limits_are_named_not_refused(qiao):
    q = qiao.home
    q[0], q[4] = 5.5, -3.0
    assert ikde.check(qiao, q).outside_limits == ("d_x", "q2")
    assert ikde.check(qiao, qiao.home).outside_limits == ()


def test_q_comes_back_in_the_robots_own_convention(qiao):
    said = ikde.to_convention(qiao, qiao.home, "classical")
    result = ikde.check(qiao, said, convention="classical")
    assert result.q == pytest.approx(qiao.home)
    assert result.clearance_m == pytest.approx(ikde.check(qiao, qiao.home).clearance_m, abs=1e-12)


def test_a_detector_of_ones_own_is_used(qiao):
    mine = ikde.Detector(name="mine", spheres="typical", pairs="arm_arm", safe_distance_m=0.01)
    result = ikde.check(qiao, qiao.home, mine)
    assert (result.detector, result.safe_distance_m) == ("mine", 0.01)
    assert len(result.pairs) == len(qiao.pair_lists["arm_arm"])


@pytest.mark.parametrize(
    ("q", "options", "words"),
    [
        ([0.0] * 8, {}, "expected 9 joint values"),
        ([np.nan] * 9, {}, "finite"),
        ([0.0] * 9, {"collision": "improv"}, "no detector 'improv'"),
        ([0.0] * 9, {"convention": "dh"}, "no convention 'dh'"),
        ([0.0] * 9, {"collision": ikde.Detector(name="a", spheres="b", pairs="arm_arm")}, "'b'"),
        ([0.0] * 9, {"collision": ikde.Detector(name="a", spheres="typical", pairs="b")}, "'b'"),
    ],
)
def test_what_does_not_fit_the_robot_is_refused(qiao, q, options, words):
    with pytest.raises(InputError, match=words):
        ikde.check(qiao, q, **options)


@every_detector
def test_many_are_checked_as_one_is(name, detector, rng):
    robot = ikde.load_robot(name)
    Q = np.array([random_q(robot, rng) for _ in range(7)])
    Q[0] += np.where(robot.is_prismatic, 100.0, 9.0)
    many = ikde.check_many(robot, Q, detector)
    for k, q in enumerate(Q):
        one = ikde.check(robot, q, detector)
        assert many.clearance_m[k] == one.clearance_m
        assert bool(many.collision[k]) == one.collision
        assert many.pairs[many.closest_pair[k]] == (one.pairs[0].a, one.pairs[0].b)
        assert sorted(many.gaps_m[k]) == [pair.clearance_m for pair in one.pairs]
        assert many.inside_limits[k] == (not one.outside_limits)
    assert not many.inside_limits[0]


def test_check_of_many_is_what_check_many_finds(qiao, rng):
    Q = random_q(qiao, rng, 3)
    for given in (Q, Q.tolist(), list(Q)):
        one, other = ikde.check(qiao, given), ikde.check_many(qiao, given)
        assert isinstance(one, ikde.CheckResults)
        assert one.gaps_m.tobytes() == other.gaps_m.tobytes()
        assert one.q.tobytes() == other.q.tobytes()
    assert len(ikde.check(qiao, Q[:1])) == 1
    assert len(ikde.check(qiao, Q[:0], "none")) == 0
    counted = ikde.check(qiao, Q, convention="classical").q
    assert counted.tobytes() == ikde.check_many(qiao, Q, convention="classical").q.tobytes()
    with pytest.raises(InputError, match=r"q: expected a configuration \[9\] or many \[K, 9\], got shape \(1, 3, 9\)"):
        ikde.check(qiao, Q[None])


def test_of_many_nothing_is_said_that_was_not_checked(qiao):
    many = ikde.check_many(qiao, [qiao.home] * 3, "none")
    assert many.collision.tolist() == [None] * 3
    assert many.closest_pair.tolist() == [-1] * 3
    assert np.isinf(many.clearance_m).all()
    assert len(ikde.check_many(qiao, np.empty((0, 9)))) == 0
    with pytest.raises(InputError, match=r"q: expected configurations \[K, 9\], got shape \(9,\)"):
        ikde.check_many(qiao, qiao.home)


@pytest.mark.parametrize("travel", [lambda given: given, lambda given: pickle.loads(pickle.dumps(given)), deepcopy])
def test_what_was_checked_stays_what_it_is(qiao, travel):
    many, one = travel(ikde.check_many(qiao, [qiao.home] * 2)), travel(ikde.check(qiao, qiao.home))
    columns = (many.q, many.collision, many.clearance_m, many.closest_pair, many.gaps_m, many.inside_limits, one.q)
    for column in (*columns, many.collision.data):
        with pytest.raises(ValueError, match="read-only"):
            column[0] = column[1]


def test_a_check_in_a_world_reports_distances_and_compares_them_with_what_is_asked_for():
    """By a safe distance above 0, a margin of the obstacle, one of all components, and one of a single component."""
    robot = ikde.load_robot("ur5")
    detector = replace(robot.detectors["default"], safe_distance_m=0.004)
    world = ikde.load_world({"obstacles": {"wall": {"box": [1, 1, 1], "position": [2, 1, 1], "margin": 0.01}}})
    q = np.array([0.0, -1.0, 1.0, 0.0, 0.5, 0.0])
    alone = ikde.CollisionModel.of(robot, detector)
    (wall,) = ikde.check(robot, q, alone.in_world(world)).obstacles
    assert wall.margin_m == 0.01
    for more, collides in ((-1e-9, False), (0.0, False), (1e-9, True)):
        room = wall.clearance_m - 0.01 + more
        ignored = {name: 0.0 for name in alone.components if name != wall.component}
        models = [
            alone.in_world(world, 0.0, {wall.component: room}),
            alone.in_world(world, room, ignored),
            alone.in_world(world, room, {**ignored, wall.component: room}),
        ]
        for model in models:
            one, many = ikde.check(robot, q, model), ikde.check_many(robot, q[None], model)
            place = many.pairs.index((wall.component, "wall"))
            assert many.gaps_m[0, place] == pytest.approx(wall.clearance_m, abs=1e-12)
            assert one.obstacles[0].margin_m == pytest.approx(room + 0.01)
            if more:
                assert (one.collision, bool(many.collision[0]), one.obstacles[0].collides) == (collides,) * 3
            assert one.clearance_m == pytest.approx(many.clearance_m[0], abs=1e-12)
            if collides:
                assert one.closest_pair == (wall.component, "wall")
                assert one.clearance_m == pytest.approx(wall.clearance_m, abs=1e-12)
        kept_by_none = alone.in_world(world, room + 1.0, dict.fromkeys(alone.components, 0.0))
        assert ikde.check(robot, q, kept_by_none).collision is False


def test_what_stands_nearer_than_is_asked_for_is_refused_also_without_touching():
    world = ikde.load_world({"obstacles": {"floor": {"half_space": {}, "position": [0, 0, -0.5]}}})
    model = ikde.CollisionModel.of("ur5").in_world(world, 0.0)
    assert ikde.check("ur5", [0, -1, 0, 0, 0, 0], model).collision is not None
    with pytest.raises(InputError, match=r"base is .* from floor in every configuration, and 600 mm are asked for, so"):
        ikde.check("ur5", np.zeros(6), ikde.CollisionModel.of("ur5").in_world(world, 0.6))


def test_surface_points_are_not_compared_with_a_world():
    world = ikde.load_world({"obstacles": {"ball": {"sphere": {"radius": 1.0}, "position": [5, 0, 0]}}})
    with pytest.raises(InputError, match="not compared with a world"):
        ikde.check_surface("ur5", np.zeros(6), world)
