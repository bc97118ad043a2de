"""One constrained step: the minimum without fences in closed form, and inside them by the conditions that it meets."""

import numpy as np
import pytest
from scipy.optimize import nnls

from ikde.kernels import constrained
from ikde.kernels.fences import MOST_FENCES, Fences
from tests.uncompiled import plain_module

kernels = plain_module(constrained)


def make_case(seed, rows=3, size=8, fences=0):
    """Jacobian, error, wish, step, a box, and fences that step 0 is behind."""
    rng = np.random.default_rng(seed)
    system = kernels.make_system(size)
    system.lower[:], system.upper[:] = -rng.uniform(0.1, 1, size), rng.uniform(0.1, 1, size)
    held = Fences(
        rng.uniform(0.0, 0.2, MOST_FENCES),
        rng.standard_normal((MOST_FENCES, size)),
        np.full(MOST_FENCES, -1),
        np.empty(size),
        np.empty((1, 3)),
        np.empty((3, 1)),
    )
    jacobian, error = rng.standard_normal((6, size)), 0.3 * rng.standard_normal(6)
    return jacobian, error, rows, 1e4, 0.3 * rng.standard_normal(size), held, fences, system


def gradient(case, start, step):
    """Half the gradient of |step - wish|^2 + stiffness |error - J (step - start)|^2."""
    jacobian, error, rows, stiffness, wish, *_ = case
    J = jacobian[:rows]
    return step - wish - stiffness * J.T @ (error[:rows] - J @ (step - start))


@pytest.mark.parametrize("rows", [3, 6])
def test_without_fences_it_is_the_minimum(rows, rng):
    case = make_case(1, rows)
    case[-1].lower[:], case[-1].upper[:] = -1e6, 1e6
    start = rng.standard_normal(8)
    step = start.copy()
    assert kernels.solve_step(*case, step)
    np.testing.assert_allclose(gradient(case, start, step), 0.0, atol=1e-8)


@pytest.mark.parametrize("seed", range(25))
def test_behind_fences_only_they_push(seed):
    case = make_case(seed, rows=3 + 3 * (seed % 2), size=8 + seed % 2, fences=seed % 6)
    held, count, system = case[5:]
    start = np.zeros(len(system.lower))
    step = start.copy()
    assert kernels.solve_step(*case, step)
    assert (step >= system.lower).all()
    assert (step <= system.upper).all()
    slack = held.slack[:count] + held.slope[:count] @ (step - start)
    assert slack.min(initial=0.0) > -1e-8
    walls = [row for row, s in zip(held.slope[:count], slack, strict=True) if s < 1e-7]
    unit = np.eye(len(step))
    walls += [unit[k] for k in range(len(step)) if step[k] < system.lower[k] + 1e-9]
    walls += [-unit[k] for k in range(len(step)) if step[k] > system.upper[k] - 1e-9]
    slope = gradient(case, start, step)
    left = nnls(np.array(walls).T, slope)[1] if walls else np.linalg.norm(slope)
    assert left < 1e-5 * max(1.0, np.linalg.norm(slope))


def test_no_way_behind_the_fences_is_told_and_the_box_holds():
    case = make_case(3, fences=2)
    held, system = case[5], case[-1]
    held.slope[1] = -held.slope[0]
    held.slack[:2] = -0.1
    step = np.zeros(8)
    assert not kernels.solve_step(*case, step)
    assert ((step >= system.lower) & (step <= system.upper)).all()


def test_a_fence_that_no_step_moves_is_left_out():
    case = make_case(4, fences=1)
    case[5].slope[0] = 0.0
    case[5].slack[0] = -1.0
    assert kernels.solve_step(*case, np.zeros(8))


def test_weights_of_the_jacobian(rng):
    jacobian = rng.standard_normal((6, 8))
    matrix, inverse, weighted = np.empty((8, 8)), np.empty((8, 8)), np.empty((6, 8))
    for rows in (3, 6):
        J = jacobian[:rows]
        kernels.factor(jacobian, rows, 7.0, matrix, inverse)
        kernels.weigh(jacobian, rows, inverse, weighted)
        np.testing.assert_allclose(weighted[:rows], J @ np.linalg.inv(np.eye(8) + 7.0 * J.T @ J), atol=1e-12)
        np.testing.assert_array_equal(weighted[rows:], 0.0)


def test_travel_is_never_zero():
    assert kernels.measure_travel(np.zeros((6, 8)), 3) > 0.0
    assert kernels.measure_travel(np.ones((6, 8)), 3) == 8.0
