"""`solve_distinct`: solutions far enough apart, best first."""

from itertools import count
from types import SimpleNamespace

import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from ikde.solver.distinct import are_distinct
from ikde.solver.families import FAMILIES
from tests.problems import CHEAP, QUICK, TARGET, are_apart, assert_true_to_its_figures
from tests.targets import free_q, make_target
from tests.tiny_robot import tiny_robot


@pytest.mark.parametrize("method", ["auto", "memetic", "de"])
def test_distinct_solutions_are_pairwise_distinct_and_the_first_found_is_that_of_solve(qiao, method):
    settings = ikde.SolveSettings.for_method(method)
    found = ikde.solve_distinct(qiao, TARGET, 4, settings, rank="found", seed=2)
    assert len(found) == 4
    assert found[0].q.tobytes() == ikde.solve(qiao, TARGET, settings, seed=2).q.tobytes()
    for i, result in enumerate(found):
        assert_true_to_its_figures(qiao, TARGET, result, settings)
        assert all(are_apart(qiao, result.q, other.q) for other in found[:i])


def test_more_solutions_than_there_are_come_as_fewer(qiao, rng):
    q = free_q(qiao, rng)
    frozen = dict(zip(qiao.joint_names, q.tolist(), strict=True))
    found = ikde.solve_distinct(qiao, make_target(qiao, q, "position"), 3, QUICK, freeze=frozen)
    assert len(found) == 1
    assert found[0].reached


def test_without_a_solution_there_is_one_result_with_the_reason(qiao):
    found = ikde.solve_distinct(qiao, ikde.Target((0.0, 0.0, 9.0)), 3, CHEAP)
    assert [result.stop_reason for result in found] == ["out_of_reach"]


@pytest.mark.parametrize("method", ["auto", "memetic"])
def test_a_timeout_is_that_of_the_whole_call(qiao, method, monkeypatch):
    def answer(timeout_s):
        settings = ikde.SolveSettings(method=method, timeout_s=timeout_s)
        return ikde.solve_distinct(qiao, TARGET, 3, settings, seed=2)

    plain, timed = ([result.q.tobytes() for result in answer(timeout_s)] for timeout_s in (None, 1e6))
    assert plain == timed
    assert len(plain) == 3
    assert len(answer(1e-9)) == 1
    seconds = count()
    monkeypatch.setattr("ikde.solver.distinct.time", SimpleNamespace(perf_counter=seconds.__next__))
    answer(10.0)
    assert next(seconds) <= 12


@pytest.mark.parametrize("count", [0, -1, 10_001, 10**30])
def test_a_count_that_makes_no_sense_is_refused(qiao, count):
    with pytest.raises(InputError, match="count: expected a whole number of at least 1"):
        ikde.solve_distinct(qiao, TARGET, count)


@pytest.mark.parametrize(
    ("joint", "difference", "distinct"),
    [
        ("d_x", 0.049, False),
        ("d_x", 0.051, True),
        ("q1", 0.099, False),
        ("q1", 0.101, True),
        ("q_z", 2 * np.pi - 0.099, False),
        ("q_z", 2 * np.pi - 0.101, True),
        ("q_z", 2 * np.pi, False),
    ],
)
def test_distinct_is_0_1_rad_around_the_circle_or_50_mm(qiao, joint, difference, distinct):
    q, other = np.zeros(9), np.zeros(9)
    other[qiao.joint_names.index(joint)] = difference
    for pair in ((q, other), (other, q)):
        assert are_distinct(qiao, *pair) is distinct
        assert are_apart(qiao, *pair) is distinct


@pytest.mark.parametrize(("apart_m", "distinct"), [((0.04, 0.04), False), ((0.051, 0.0), True), ((0.0, 0.051), True)])
def test_each_slide_counts_by_itself(qiao, apart_m, distinct):
    q, other = np.zeros(9), np.zeros(9)
    other[:2] = apart_m
    assert are_distinct(qiao, q, other) is distinct
    assert are_apart(qiao, q, other) is distinct


def test_the_least_motion_from_home_or_near_comes_first(qiao):
    some = {"d_x": 0.2, "q2": 1.0}
    own = [{"d_x": 1.0, "d_y": 1.0}.get(j.name, 1.0 / (j.upper - j.lower)) for j in qiao.joints]
    given = [some.get(j.name, w) for j, w in zip(qiao.joints, own, strict=True)]
    for near, weights, weighed in ((None, None, own), (qiao.home + 0.2, None, own), (None, some, given)):
        found = ikde.solve_distinct(qiao, TARGET, 6, seed=3, near=near, weights=weights)
        assert len(found) == 6
        start = qiao.home if near is None else near
        costs = [np.linalg.norm(np.array(weighed) * (result.q - start)) for result in found]
        assert costs == sorted(costs)
        np.testing.assert_allclose([result.motion for result in found], costs, rtol=1e-12)


def test_the_farthest_from_its_limits_comes_first(qiao):
    found = ikde.solve_distinct(qiao, TARGET, 6, rank="limits", seed=3)
    margins = [np.min(np.minimum(r.q - qiao.lower, qiao.upper - r.q) / (qiao.upper - qiao.lower)) for r in found]
    assert margins == sorted(margins, reverse=True)
    assert len(found) == 6
    assert margins[0] > margins[-1]


def test_the_largest_clearance_comes_first(qiao):
    found = ikde.solve_distinct(qiao, TARGET, 6, rank="clearance", seed=3)
    clearances = [result.clearance_m for result in found]
    assert clearances == sorted(clearances, reverse=True)
    assert clearances[0] > min(
        result.clearance_m for result in ikde.solve_distinct(qiao, TARGET, 6, rank="found", seed=3)
    )


def test_the_most_manipulable_comes_first(qiao):
    found = ikde.solve_distinct(qiao, TARGET, 6, rank="manipulability", seed=3)
    figures = [float(ikde.analyze(qiao, result.q).scaled["whole"]["pose"].manipulability) for result in found]
    assert figures == sorted(figures, reverse=True)
    assert figures[0] > figures[-1]
    with pytest.raises(InputError, match="is 0 in each of 8 random configurations"):
        ikde.solve_distinct(tiny_robot(), TARGET, 2, rank="manipulability")


def test_an_arm_without_a_base_gives_its_families(rng):
    """A pose of a UR5 well inside its reach has several of the eight families, each of which is found."""
    robot = ikde.load_robot("ur5")
    target = make_target(robot, np.array([0.3, -1.2, 1.4, -1.5, -1.3, 0.4]), "pose")
    found = ikde.solve_distinct(robot, target, 8, collision="none")
    assert {result.family for result in found} == set(FAMILIES)


def test_an_unknown_rank_is_refused(qiao):
    with pytest.raises(InputError, match="rank: expected one of motion, clearance, limits, manipulability, found"):
        ikde.solve_distinct(qiao, TARGET, 2, rank="best")


def test_without_a_detector_nothing_is_ranked_by_clearance(qiao):
    with pytest.raises(InputError, match="rank: without a detector no clearance is known to rank by"):
        ikde.solve_distinct(qiao, TARGET, 2, rank="clearance", collision="none")


def test_the_rank_by_clearance_is_what_is_left_beyond_what_is_asked_for():
    """Ranked by distances alone it would be another order: margins differ from obstacle to obstacle."""
    wide = {"cylinder": {"radius": 0.05, "height": 2.0}, "position": [0.6, 0.4, 0.5], "margin": 0.188}
    robot, world = ikde.load_robot("ur5"), ikde.load_world({"obstacles": {"wide": wide}})
    model = ikde.CollisionModel.of(robot).in_world(world)
    found = ikde.solve_distinct(robot, (0.4, 0.2, 0.5), 24, rank="clearance", collision=model)
    spare = []
    for result in found:
        checked = ikde.check(robot, result.q, model)
        own = min(pair.clearance_m for pair in checked.pairs) - model.limit_m
        spare.append(min(own, *(row.clearance_m - row.margin_m for row in checked.obstacles)))
        assert result.room_m == pytest.approx(spare[-1], abs=1e-12)
    assert len({result.closest_pair for result in found}) > 1
    assert (np.diff(spare) <= 1e-12).all()
    assert (np.diff([result.clearance_m for result in found]) > 0.1).any()
