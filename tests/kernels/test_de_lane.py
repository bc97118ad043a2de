"""Whole solves by the papers' search: attempts cut into calls, and what is counted."""

import numpy as np
import pytest

from ikde.kernels.arrays import ATTEMPTS, COLLIDING, COUNTS, EVALUATIONS, OUTSIDE, REACHED
from ikde.kernels.de_lane import solve_lane
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot, pack_targets
from ikde.model.target import Target
from ikde.solver.problem import make_problem, pack_search
from ikde.solver.settings import SolveSettings
from tests import reference

HARD = Target([0.54, -0.131, 0.974])


def run_lane(robot, target, blocks, *, seed=3, detector=None, near=None, **changes):
    """Run the attempts block by block: (q, score, counts, pair counts)."""
    settings = SolveSettings(**{"population": 8, "generations": 40, "update": "generation", **changes})
    problem = make_problem(robot, settings, collision=detector, near=near, freeze=None)
    packed, spheres = pack_robot(robot), CollisionModel(robot=robot, detector=problem.collision.detector).arrays
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
