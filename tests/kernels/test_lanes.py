"""Whole solves: boxes that grow around `near`, attempts cut into calls, and what is counted."""

import numpy as np
import pytest

from ikde.kernels.arrays import ATTEMPTS, COLLIDING, COUNTS, EVALUATIONS, OUTSIDE, REACHED
from ikde.kernels.lanes import is_inside, set_box, solve_lane
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot, pack_targets
from ikde.model.target import Target
from ikde.solver.problem import pack_search
from ikde.solver.settings import SolveSettings
from tests import reference
from tests.problems import problem_of

RANGES = np.array([[-1.0, 0.0, 2.0], [1.0, 4.0, 2.0], [0.9, 1.0, 2.0]])
HARD = Target([0.54, -0.131, 0.974])


def run_box(attempt, first_box, ranges=RANGES):
    lower, upper = np.full(ranges.shape[1], np.nan), np.full(ranges.shape[1], np.nan)
    set_box(ranges, first_box, attempt, lower, upper)
    return lower, upper


def test_boxes_grow_until_they_are_the_ranges():
    lower, upper = run_box(0, 1 / 64)
    for attempt in range(1, 12):
        next_lower, next_upper = run_box(attempt, 1 / 64)
        assert np.all(next_lower <= lower)
        assert np.all(next_upper >= upper)
        lower, upper = next_lower, next_upper
    np.testing.assert_array_equal([lower, upper], RANGES[:2])


@pytest.mark.parametrize("attempt", range(10))
def test_boxes_stay_inside_the_ranges_and_hold_near(attempt):
    lower, upper = run_box(attempt, 1 / 64)
    assert np.all(RANGES[0] <= lower)
    assert np.all(upper <= RANGES[1])
    assert np.all((lower <= RANGES[2]) & (RANGES[2] <= upper))


@pytest.mark.parametrize("attempt", range(6))
def test_a_box_has_its_share_of_the_range_on_either_side(attempt):
    lower, upper = run_box(attempt, 1 / 64, np.array([[-1.0], [1.0], [0.0]]))
    half_width = 2.0 * 2**attempt / 64
    assert (lower[0], upper[0]) == (max(-1.0, -half_width), min(1.0, half_width))


def test_without_near_the_first_box_is_the_whole_range(qiao):
    problem = problem_of(qiao)
    search = pack_search(problem)
    lower, upper = run_box(0, search.first_box, search.ranges)
    np.testing.assert_array_equal([lower, upper], [qiao.lower, qiao.upper])


def test_on_a_limit_is_inside():
    assert is_inside(RANGES, np.array([-1.0, 4.0, 2.0]))
    assert not is_inside(RANGES, np.array([-1.0, np.nextafter(4.0, 5.0), 2.0]))
    assert not is_inside(RANGES, np.array([np.nan, 1.0, 2.0]))


def run_lane(robot, target, blocks, *, seed=3, detector=None, near=None, **changes):
    """Run the attempts block by block: (q, score, counts, pair counts)."""
    settings = SolveSettings(**{"population": 8, "generations": 40, "update": "generation", **changes})
    problem = problem_of(robot, settings, collision=detector, near=near)
    packed, spheres = pack_robot(robot), problem.collision.arrays
    q, score, counts = np.zeros(len(robot.joints)), np.full(2, np.inf), np.zeros(COUNTS, dtype=np.int64)
    pairs = np.zeros(len(spheres.pairs), dtype=np.int64)
    search, targets = pack_search(problem), pack_targets([target])
    for begin, end in blocks:
        out = (q, score, counts, pairs)
        block = np.array([begin, end])
        if not counts[REACHED]:
            solve_lane(packed, spheres, targets, 0, search, np.uint64(seed), np.int64(0), block, *out)
    return q, score, counts, pairs


@pytest.mark.parametrize(
    ("changes", "reached"),
    [
        ({"collision": "reject"}, False),
        ({"collision": "feasibility"}, False),
        ({"collision": "reject", "position_tolerance_m": 0.05, "generations": 100}, None),
        ({"collision": "feasibility", "position_tolerance_m": 0.05, "generations": 100}, True),
    ],
)
def test_attempts_cut_into_calls_give_the_same_bits(qiao, changes, reached):
    whole = run_lane(qiao, HARD, [(0, 7)], **changes)
    cut = run_lane(qiao, HARD, [(0, 1), (1, 3), (3, 3), (3, 7)], **changes)
    for one, other in zip(whole, cut, strict=True):
        assert one.tobytes() == other.tobytes()
    assert reached is None or bool(whole[2][REACHED]) == reached


def test_no_attempts_touch_nothing(qiao):
    q, score, counts, pairs = run_lane(qiao, HARD, [(0, 0)])
    assert not q.any()
    assert not counts.any()
    assert not pairs.any()
    assert np.all(score == np.inf)


def test_a_start_that_solves_already_is_the_answer(qiao):
    near = np.array([0.4, -0.2, 0.5, 1.0, 0.3, -0.9, 0.4, 0.2, 0.1])
    target = Target(reference.compute_frames(qiao, near)["tool"][:3, 3])
    q, _, counts, _ = run_lane(qiao, target, [(0, 1)], near=near)
    assert counts[REACHED] == 1
    assert counts[EVALUATIONS] == 1
    np.testing.assert_array_equal(q, near)


def test_unreached_attempts_and_evaluations_are_counted(qiao):
    counts = run_lane(qiao, HARD, [(0, 3)], generations=2)[2]
    expected = np.zeros(COUNTS, dtype=np.int64)
    expected[ATTEMPTS], expected[EVALUATIONS] = 3, 3 * 8 * 3
    np.testing.assert_array_equal(counts, expected)


def test_rejected_attempts_are_counted_with_the_pairs_that_blocked_them(qiao):
    changes = {"collision": "reject", "position_tolerance_m": 0.05, "generations": 200}
    _, score, counts, pairs = run_lane(qiao, HARD, [(0, 20)], **changes)
    assert counts[COLLIDING] > 0
    assert counts[COLLIDING] <= pairs.sum()
    assert pairs.max() <= counts[COLLIDING]
    assert score[0] == 0.0


def test_the_score_of_a_reached_target_is_zero(qiao):
    q, score, counts, _ = run_lane(qiao, HARD, [(0, 30)], position_tolerance_m=0.05, generations=200)
    assert counts[REACHED] == 1
    assert tuple(score) == (0.0, 0.0)
    T = reference.compute_frames(qiao, q)["tool"]
    assert reference.compute_position_error(T, HARD) <= 0.05
    assert reference.compute_depth(qiao, CollisionModel.of(qiao).detector, q) == 0.0


def test_the_kept_configuration_has_the_lowest_cost_of_all_attempts(qiao):
    single = [run_lane(qiao, HARD, [(k, k + 1)], generations=5)[1][1] for k in range(8)]
    q, score, _, _ = run_lane(qiao, HARD, [(0, 8)], generations=5)
    assert score[1] == min(single)
    T = reference.compute_frames(qiao, q)["tool"]
    assert reference.compute_position_error(T, HARD) == pytest.approx(score[1], abs=1e-12)


def test_unrepaired_solutions_outside_the_ranges_are_not_reached(qiao):
    lane = {"bounds": "none", "generations": 300, "position_tolerance_m": 0.01, "detector": "none", "weight": 0.9}
    counts = sum(run_lane(qiao, Target([5.5, 0.0, 0.9]), [(0, 5)], seed=seed, **lane)[2] for seed in range(5))
    assert counts[OUTSIDE] > 0


def test_near_keeps_the_first_attempt_in_its_box(qiao):
    q, _, counts, _ = run_lane(qiao, HARD, [(0, 1)], near=qiao.home, generations=3)
    assert counts[ATTEMPTS] == 1
    assert np.all(np.abs(q - qiao.home) <= (qiao.upper - qiao.lower) / 64 + 1e-15)
