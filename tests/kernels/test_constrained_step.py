"""One constrained step: in closed form without constraints, else by the conditions that it meets."""

import numpy as np
import pytest
from scipy.optimize import nnls

from ikde.kernels import constrained_step
from ikde.kernels.step_constraints import MAX_CONSTRAINTS
from tests.uncompiled import plain_module

kernels = plain_module(constrained_step)


def make_case(seed, rows=3, size=8, constraints=0):
    """Jacobian, error, preferred step, a box, and constraints that step 0 meets."""
    rng = np.random.default_rng(seed)
    system = kernels.make_system(size)
    system.lower[:], system.upper[:] = -rng.uniform(0.1, 1, size), rng.uniform(0.1, 1, size)
    slack, slope = rng.uniform(0.0, 0.2, MAX_CONSTRAINTS), rng.standard_normal((MAX_CONSTRAINTS, size))
    jacobian, error = rng.standard_normal((6, size)), 0.3 * rng.standard_normal(6)
    return jacobian, error, rows, 1e4, 0.3 * rng.standard_normal(size), slack, slope, constraints, system


def gradient(case, start, step):
    """Half the gradient of |step - preferred|^2 + stiffness |error - J (step - start)|^2."""
    jacobian, error, rows, stiffness, preferred, *_ = case
    J = jacobian[:rows]
    return step - preferred - stiffness * J.T @ (error[:rows] - J @ (step - start))


@pytest.mark.parametrize("rows", [3, 6])
def test_without_constraints_it_is_the_minimum(rows, rng):
    case = make_case(1, rows)
    case[-1].lower[:], case[-1].upper[:] = -1e6, 1e6
    start = rng.standard_normal(8)
    step = start.copy()
    assert kernels.solve_step(*case, step)
    np.testing.assert_allclose(gradient(case, start, step), 0.0, atol=1e-8)


@pytest.mark.parametrize("seed", range(25))
def test_only_active_constraints_have_multipliers(seed):
    case = make_case(seed, rows=3 + 3 * (seed % 2), size=8 + seed % 2, constraints=seed % 6)
    all_slack, all_slope, count, system = case[5:]
    start = np.zeros(len(system.lower))
    step = start.copy()
    assert kernels.solve_step(*case, step)
    assert (step >= system.lower).all()
    assert (step <= system.upper).all()
    slack = all_slack[:count] + all_slope[:count] @ (step - start)
    assert slack.min(initial=0.0) > -1e-8
    spaces = [row for row, s in zip(all_slope[:count], slack, strict=True) if s < 1e-7]
    unit = np.eye(len(step))
    spaces += [unit[k] for k in range(len(step)) if step[k] < system.lower[k] + 1e-9]
    spaces += [-unit[k] for k in range(len(step)) if step[k] > system.upper[k] - 1e-9]
    slope = gradient(case, start, step)
    left = nnls(np.array(spaces).T, slope)[1] if spaces else np.linalg.norm(slope)
    assert left < 1e-5 * max(1.0, np.linalg.norm(slope))


def test_infeasible_constraints_are_recognised_and_the_box_holds():
    case = make_case(3, constraints=2)
    slack, slope, _, system = case[5:]
    slope[1] = -slope[0]
    slack[:2] = -0.1
    step = np.zeros(8)
    assert not kernels.solve_step(*case, step)
    assert ((step >= system.lower) & (step <= system.upper)).all()


def test_a_constraint_that_no_step_changes_is_left_out():
    case = make_case(4, constraints=1)
    case[6][0] = 0.0
    case[5][0] = -1.0
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
