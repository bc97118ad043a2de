"""How an attempt begins and ends: boxes that grow around `near`, and what is kept and counted."""

import numpy as np
import pytest

from ikde.kernels.arrays import ATTEMPTS, COLLIDING, COUNTS, OUTSIDE, REACHED
from ikde.kernels.attempt import finish_attempt, is_inside, keep_better, set_box
from ikde.kernels.evolution import make_workspace
from ikde.kernels.frames import compute_bodies
from ikde.model.collision_model import CollisionModel
from ikde.solver.problem import make_problem, pack_search, pack_searched
from ikde.solver.settings import SolveSettings
from tests import reference

RANGES = np.array([[-1.0, 0.0, 2.0], [1.0, 4.0, 2.0], [0.9, 1.0, 2.0]])


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
    problem = make_problem(qiao, SolveSettings(), collision=None, near=None, freeze=None)
    search = pack_search(problem)
    lower, upper = run_box(0, search.first_box, search.ranges)
    np.testing.assert_array_equal([lower, upper], [qiao.lower, qiao.upper])


def test_on_a_limit_is_inside():
    assert is_inside(RANGES, np.array([-1.0, 4.0, 2.0]))
    assert not is_inside(RANGES, np.array([-1.0, np.nextafter(4.0, 5.0), 2.0]))
    assert not is_inside(RANGES, np.array([np.nan, 1.0, 2.0]))


def test_what_is_met_is_kept_before_what_is_not_and_the_better_of_two():
    q, score = np.zeros(1), np.full(2, np.inf)
    for met, badness, kept in [
        (1.0, 0.5, 1),
        (1.0, 0.7, 0),
        (1.0, 0.2, 1),
        (0.0, 9.0, 1),
        (1.0, 0.1, 0),
        (0.0, 0.0, 1),
    ]:
        before, new = q.copy(), np.array([10.0 * met + badness])
        keep_better(met, badness, new, q, score)
        assert q == (new if kept else before)
    assert score.tolist() == [0.0, 0.0]


def finish(robot, q, *, cost=0.3, meets=True, collision=None):
    """(reached, q, score, counts, pairs) after one attempt that ends at `q`."""
    problem = make_problem(robot, SolveSettings(method="de"), collision=collision, near=None, freeze=None)
    packed, spheres = pack_searched(problem.collision)
    work = make_workspace(packed, spheres, len(q), 4)
    compute_bodies(packed, q, work.T_world_body)
    out = (np.zeros(len(q)), np.full(2, np.inf), np.zeros(COUNTS, dtype=np.int64), np.zeros(len(spheres.pairs), int))
    return finish_attempt(spheres, pack_search(problem), q, cost, meets, work, *out), *out


def test_what_meets_its_target_inside_and_free_is_reached(qiao):
    reached, q, score, counts, pairs = finish(qiao, qiao.home)
    assert reached
    np.testing.assert_array_equal(q, qiao.home)
    assert score.tolist() == [0.0, 0.0]
    assert np.flatnonzero(counts).tolist() == [REACHED, ATTEMPTS]
    assert not pairs.any()


def test_what_misses_is_kept_by_its_cost(qiao):
    reached, _, score, counts, _ = finish(qiao, qiao.home, meets=False)
    assert not reached
    assert score.tolist() == [1.0, 0.3]
    assert np.flatnonzero(counts).tolist() == [ATTEMPTS]


def test_what_leaves_its_range_is_counted_as_outside_and_kept_by_its_cost(qiao):
    q = qiao.home.copy()
    q[0] = qiao.upper[0] + 1e-3
    reached, _, score, counts, _ = finish(qiao, q)
    assert not reached
    assert score.tolist() == [1.0, 0.3]
    assert np.flatnonzero(counts).tolist() == [ATTEMPTS, OUTSIDE]


def test_what_collides_is_kept_by_its_depth_and_its_pairs_are_counted(qiao, rng):
    model = CollisionModel.of(qiao)
    chosen = model.detector
    q = next(q for q in rng.uniform(qiao.lower, qiao.upper, (200, 9)) if reference.compute_depth(qiao, chosen, q) > 0)
    reached, _, score, counts, pairs = finish(qiao, q)
    assert not reached
    assert score == pytest.approx([0.0, reference.compute_depth(qiao, chosen, q)], abs=1e-9)
    assert np.flatnonzero(counts).tolist() == [ATTEMPTS, COLLIDING]
    gaps = reference.compute_pair_clearances(reference.list_spheres(qiao, chosen, q), model.pairs)
    np.testing.assert_array_equal(pairs, gaps <= chosen.safe_distance_m)
    assert finish(qiao, q, collision="none")[0]
