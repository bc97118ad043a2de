"""Priority by the conditions that only the lexicographic optimum meets, judged by scipy."""

import numpy as np
import pytest
from scipy.optimize import nnls

from ikde.solver.priority import Bounds, Level, damped_inverse, null_projector, recurse, solve_levels

NO_DAMPING = 1e-6


def draw_levels(rng, size, rows):
    return [Level(rng.standard_normal((m, size)), 2.0 * rng.standard_normal(m)) for m in rows]


def draw_case(seed):
    """Three levels, some in conflict, in a box with slanted sides; every fourth box leaves 0 out."""
    rng = np.random.default_rng(seed)
    size = int(rng.integers(4, 10))
    levels = draw_levels(rng, size, rng.integers(1, 5, 3))
    if seed % 3 == 0:
        levels[1].matrix[0] = levels[0].matrix[0]
    upper = rng.uniform(0.3, 1.5, size)
    rows, lower = np.eye(size), -upper
    if seed % 4 == 0:
        lower = np.r_[0.1, lower[1:]]
    if seed % 2:
        rows = np.vstack([rows, rng.standard_normal((3, size))])
        lower, upper = np.r_[lower, -np.ones(3)], np.r_[upper, np.ones(3)]
    return levels, Bounds(rows, lower, upper)


def measure_optimality(levels, bounds, x):
    """How far each level's gradient is from a sum of what may hold it: active bounds, and all of the levels before."""
    values = bounds.rows @ x
    low, high = values < bounds.lower + 1e-7, values > bounds.upper - 1e-7
    holding, left = np.vstack([-bounds.rows[low], bounds.rows[high]]).T, []
    for matrix, wanted in levels:
        slope = -matrix.T @ (matrix @ x - wanted)
        left.append(nnls(holding, slope)[1] if holding.size else np.linalg.norm(slope))
        holding = np.hstack([holding, matrix.T, -matrix.T])
    return max(left)


@pytest.mark.parametrize("seed", range(48))
def test_each_level_is_the_best_that_those_before_and_the_bounds_allow(seed):
    levels, bounds = draw_case(seed)
    speeds = solve_levels(levels, bounds, NO_DAMPING)
    values = bounds.rows @ speeds.x
    assert speeds.within
    assert (values > bounds.lower - 1e-8).all()
    assert (values < bounds.upper + 1e-8).all()
    assert measure_optimality(levels, bounds, speeds.x) < 1e-10


@pytest.mark.parametrize("seed", range(12))
def test_whole_numbers_and_bounds_that_say_the_same_are_no_trouble(seed):
    rng = np.random.default_rng(seed)
    levels = [Level(np.round(rng.standard_normal((m, 5))), np.round(3 * rng.standard_normal(m))) for m in (2, 3, 2)]
    rows = np.vstack([np.eye(5), np.round(rng.standard_normal((3, 5)))])
    rows = np.vstack([rows, rows[:3]])
    bounds = Bounds(rows, -np.round(rng.uniform(0, 2, len(rows))), np.round(rng.uniform(0, 2, len(rows))))
    assert measure_optimality(levels, bounds, solve_levels(levels, bounds, NO_DAMPING).x) < 1e-10


@pytest.mark.parametrize("seed", range(8))
def test_without_bounds_it_is_the_recursion_of_the_textbooks(seed):
    levels = draw_levels(np.random.default_rng(seed), 9, (3, 3, 6))
    np.testing.assert_allclose(solve_levels(levels).x, recurse(levels), atol=1e-11)
    wide = Bounds(np.eye(9), np.full(9, -1e3), np.full(9, 1e3))
    np.testing.assert_array_equal(solve_levels(levels, wide).x, solve_levels(levels).x)


def test_many_problems_side_by_side():
    rng = np.random.default_rng(9)
    several = [draw_levels(rng, 7, (2, 3)) for _ in range(4)]
    stacked = [Level(*map(np.array, zip(*own, strict=True))) for own in zip(*several, strict=True)]
    np.testing.assert_allclose(recurse(stacked), [recurse(levels) for levels in several], atol=1e-13)


def test_a_lower_task_disturbs_no_higher_one():
    rng = np.random.default_rng(0)
    for _ in range(200):
        levels = draw_levels(rng, 9, (3, 3, 9))
        x = solve_levels(levels).x
        assert np.abs(levels[0].matrix @ x - levels[0].wanted).max() < 1e-12
        np.testing.assert_allclose(levels[0].matrix @ x, levels[0].matrix @ solve_levels(levels[:1]).x, atol=1e-12)
        np.testing.assert_allclose(levels[1].matrix @ x, levels[1].matrix @ solve_levels(levels[:2]).x, atol=1e-12)


def test_a_damped_projector_would_leak():
    """Why the projector is exact: the leak is of the order of the damping's square."""
    rng = np.random.default_rng(1)
    first, second = draw_levels(rng, 9, (3, 3))
    leaks = []
    for damping in (0.1, 0.05):
        J = first.matrix
        damped = J.T @ np.linalg.inv(J @ J.T + damping**2 * np.eye(3))
        leaks.append(np.abs(J @ (np.eye(9) - damped @ J) @ np.linalg.pinv(second.matrix) @ second.wanted).max())
    assert leaks[1] > 1e-5
    assert leaks[0] / leaks[1] == pytest.approx(4.0, rel=0.02)
    assert np.abs(first.matrix @ null_projector(first.matrix)).max() < 1e-15


def test_at_full_rank_both_orders_are_one():
    rng = np.random.default_rng(2)
    for _ in range(100):
        a, b = draw_levels(rng, 9, (3, 3))
        np.testing.assert_allclose(solve_levels([a, b]).x, solve_levels([b, a]).x, atol=1e-12)


def test_of_tasks_in_conflict_the_first_is_met():
    a = Level(np.array([[1.0, 0.0]]), np.array([1.0]))
    b = Level(np.array([[1.0, 0.0], [0.0, 1.0]]), np.array([-1.0, 2.0]))
    np.testing.assert_allclose(solve_levels([a, b]).x, [1, 2], atol=1e-15)
    np.testing.assert_allclose(solve_levels([b, a]).x, [-1, 2], atol=1e-15)
    assert solve_levels([b, a]).ranks == (2, 0)


def test_the_inverse_is_damped_below_its_threshold_alone():
    Q = np.linalg.qr(np.random.default_rng(3).standard_normal((4, 4)))[0]
    s = np.array([2.0, 0.05, 0.04, 1e-5])
    inverse = damped_inverse(Q * s, 0.05)
    np.testing.assert_allclose(inverse @ Q, np.diag([0.5, 20.0, 16.0, 1e-5 / 0.05**2]), atol=1e-12)
    assert np.linalg.norm(damped_inverse(np.zeros((2, 3)))) == 0.0
    for scale in 10.0 ** np.arange(-12.0, 3.0):
        assert np.linalg.norm(damped_inverse(scale * Q, 0.05), 2) <= 20.0 + 1e-9


def test_a_level_that_nothing_can_serve_leaves_the_rest_alone():
    still = Level(np.zeros((2, 3)), np.ones(2))
    moves = Level(np.eye(3)[:1], np.ones(1))
    speeds = solve_levels([still, moves, Level(np.eye(3), np.zeros(3)), moves])
    np.testing.assert_allclose(speeds.x, [1, 0, 0], atol=1e-15)
    assert speeds.ranks == (0, 1, 2, 0)
    assert speeds.smallest[0] == speeds.smallest[2] == speeds.smallest[3] == 0.0


def test_what_holds_a_level_is_named():
    level = Level(np.array([[1.0, 1.0, 0.0]]), np.array([3.0]))
    box = Bounds(np.eye(3), -np.ones(3), np.array([1.0, 0.5, 0.0]))
    speeds = solve_levels([level, Level(np.eye(3), np.array([0.0, 0.0, 1.0]))], box)
    np.testing.assert_allclose(speeds.x, [1, 0.5, 0], atol=1e-9)
    assert speeds.holding[0] == (0, 1)
    assert speeds.holding[1] == (1, 2)  # where the first keeps x + y, x cannot fall unless y grows
    assert solve_levels([Level(level.matrix, np.array([1.0]))], box).holding == ((),)


def test_what_is_left_open_is_as_small_as_can_be():
    """The box leaves 0 out, so the level's own answer cannot be taken: the rest still rests."""
    level = Level(np.array([[1.0, 1.0, 0.0, 0.0]]), np.array([1.0]))
    box = Bounds(np.eye(4), np.array([0.8, -2.0, -2.0, 0.2]), np.full(4, 2.0))
    np.testing.assert_allclose(solve_levels([level], box).x, [0.8, 0.2, 0.0, 0.2], atol=1e-9)


@pytest.mark.parametrize("seed", [32, 33, 91, 100, 102])
def test_it_is_what_a_last_level_that_asks_for_rest_would_give(seed):
    """Draws in which the first level's detour round a bound is in vain once the second has its say."""
    (first, second, _), bounds = draw_case(seed)
    size = bounds.rows.shape[1]
    rest = Level(np.eye(size), np.zeros(size))
    found = solve_levels([first, second], bounds, NO_DAMPING).x
    np.testing.assert_allclose(found, solve_levels([first, second, rest], bounds, NO_DAMPING).x, atol=1e-10)


def test_a_bound_of_one_value_is_kept():
    box = Bounds(np.eye(2), np.array([0.3, -1.0]), np.array([0.3, 1.0]))
    speeds = solve_levels([Level(np.array([[1.0, 1.0]]), np.array([1.0]))], box)
    np.testing.assert_allclose(speeds.x, [0.3, 0.7], atol=1e-12)


def test_bounds_that_no_speeds_keep_are_said_to_be_broken():
    level = Level(np.eye(2), np.array([1.0, 2.0]))
    for rows, lower, upper in (
        (np.eye(2), [1.0, 0.0], [0.0, 1.0]),
        ([[1.0, 0.0], [1.0, 0.0]], [0.0, 2.0], [1.0, 3.0]),
        (np.zeros((1, 2)), [1.0], [2.0]),
    ):
        speeds = solve_levels([level], Bounds(np.array(rows), np.array(lower), np.array(upper)))
        assert not speeds.within
        np.testing.assert_allclose(speeds.x, [1, 2], atol=1e-15)
