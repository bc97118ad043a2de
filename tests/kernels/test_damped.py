"""The damped least-squares step against its naive twin, and its laws."""

import itertools

import numpy as np
import pytest

from ikde.kernels.arrays import DescentArrays
from ikde.kernels.damped import make_descent_workspace, solve_symmetric, take_step
from ikde.model.pack import pack_robot, pack_targets
from ikde.model.target import Target
from tests import reference
from tests.conftest import random_q
from tests.random_robots import random_robot
from tests.targets import make_target

KINDS = ("position", "axis", "pose")


def run_steps(robot, target, q, count=1, *, lower=None, upper=None, descent=None):
    """(q after so many steps, [count, 2] errors before each)."""
    lower, upper = robot.lower if lower is None else lower, robot.upper if upper is None else upper
    descent = DescentArrays() if descent is None else descent
    work = make_descent_workspace(pack_robot(robot), len(q), 6)
    ranges, q = np.array([lower, upper]), np.array(q)
    errors = [take_step(pack_robot(robot), pack_targets([target]), 0, ranges, descent, q, work) for _ in range(count)]
    return q, np.array(errors)


def assert_like_twin(robot, target, q, *, lower=None, upper=None, descent=None):
    lower, upper = robot.lower if lower is None else lower, robot.upper if upper is None else upper
    descent = DescentArrays() if descent is None else descent
    after, errors = run_steps(robot, target, q, lower=lower, upper=upper, descent=descent)
    expected, position, orientation = reference.take_step(robot, target, lower, upper, descent, q)
    np.testing.assert_allclose(errors[0], (position, orientation), rtol=0, atol=1e-11)
    np.testing.assert_allclose(after, expected, rtol=0, atol=1e-8)
    return after


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", range(12))
def test_random_robots_step_like_the_twin(seed, kind, rng):
    robot = random_robot(seed)
    for _ in range(4):
        target = make_target(robot, random_q(robot, rng), kind)
        assert_like_twin(robot, target, random_q(robot, rng))


@pytest.mark.parametrize("kind", KINDS)
def test_shipped_robots_step_like_the_twin(any_robot, kind, rng):
    target = make_target(any_robot, random_q(any_robot, rng), kind)
    for change in ({}, {"damping": 0.5}, {"least_damping": 1e-2}, {"rotation_length": 0.1}, {"largest_step": 0.05}):
        assert_like_twin(any_robot, target, random_q(any_robot, rng), descent=DescentArrays(**change))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", range(12))
def test_joints_at_their_bounds_step_like_the_twin(seed, kind, rng):
    robot = random_robot(seed)
    target = make_target(robot, random_q(robot, rng), kind)
    at = rng.integers(3, size=len(robot.joints))
    q = np.choose(at, [robot.lower, robot.upper, random_q(robot, rng)])
    after = assert_like_twin(robot, target, q)
    assert np.all((robot.lower <= after) & (after <= robot.upper))


def test_a_joint_that_is_pulled_outwards_leaves_the_step_to_the_others(qiao, rng):
    q = 0.5 * (qiao.lower + qiao.upper)
    q[0] = qiao.upper[0]
    T = reference.compute_frames(qiao, q)[qiao.tool]
    target = Target(T[:3, 3] + np.array([0.05, 0.0, 0.0]))
    after, errors = run_steps(qiao, target, q, 8)
    assert after[0] == qiao.upper[0]
    assert errors[0, 0] == pytest.approx(0.05)
    assert errors[-1, 0] < 1e-6


@pytest.mark.parametrize("kind", KINDS)
def test_frozen_joints_never_move(qiao, kind, rng):
    target = make_target(qiao, random_q(qiao, rng), kind)
    lower, upper, q = qiao.lower.copy(), qiao.upper.copy(), random_q(qiao, rng)
    frozen = [0, 2, 5]
    lower[frozen] = upper[frozen] = q[frozen]
    after, _ = run_steps(qiao, target, q, 20, lower=lower, upper=upper)
    assert after[frozen].tobytes() == q[frozen].tobytes()
    assert not np.array_equal(after, q)


@pytest.mark.parametrize("kind", KINDS)
def test_it_converges_quadratically(any_robot, kind, rng):
    inside = 0.5 * (any_robot.lower + any_robot.upper) + 0.25 * (any_robot.upper - any_robot.lower) * (
        rng.uniform(size=len(any_robot.joints)) - 0.5
    )
    target = make_target(any_robot, inside, kind)
    start = inside + 0.02 * (rng.uniform(size=len(inside)) - 0.5)
    descent = DescentArrays(least_damping=1e-12)
    _, errors = run_steps(any_robot, target, start, 7, descent=descent)
    totals = errors.sum(axis=1)
    assert totals[-1] < 1e-11
    for before, after in itertools.pairwise(totals):
        assert after < max(50.0 * before * before, 1e-11)


@pytest.mark.parametrize("kind", KINDS)
def test_many_steps_reach_most_targets_of_the_paper_robot(qiao, kind, rng):
    reached = 0
    for _ in range(20):
        target = make_target(qiao, random_q(qiao, rng), kind)
        q, errors = run_steps(qiao, target, random_q(qiao, rng), 40)
        assert np.all((qiao.lower <= q) & (q <= qiao.upper))
        reached += errors[-1].max() < 1e-6
    assert reached >= 12


@pytest.mark.parametrize("kind", KINDS)
def test_errors_are_those_before_the_step(qiao, kind, rng):
    q = random_q(qiao, rng)
    goal = q + 1e-3 * rng.uniform(-1.0, 1.0, len(q))
    target = make_target(qiao, goal, kind)
    _, errors = run_steps(qiao, target, q)
    T = reference.compute_frames(qiao, q)[qiao.tool]
    assert errors[0, 0] == pytest.approx(reference.compute_position_error(T, target), abs=1e-14)
    assert errors[0, 1] == pytest.approx(reference.compute_orientation_error(T, target), rel=1e-5)


def test_within_both_tolerances_it_stays(qiao, rng):
    q = random_q(qiao, rng)
    target = make_target(qiao, q + 1e-4, "pose")
    _, errors = run_steps(qiao, target, q)
    position, orientation = errors[0] * 1.01
    for tolerances, stays in (((position, orientation), True), ((0.0, orientation), False), ((position, 0.0), False)):
        descent = DescentArrays(position_tolerance=tolerances[0], orientation_tolerance=tolerances[1])
        after, _ = run_steps(qiao, target, q, descent=descent)
        assert np.array_equal(after, q) == stays


def test_half_a_turn_away_is_not_met(qiao, rng):
    q = random_q(qiao, rng)
    T = reference.compute_frames(qiao, q)[qiao.tool]
    for extra in ({"R_world_tool": T[:3, :3] @ np.diag([-1.0, 1.0, -1.0])}, {"axis_world_tool": -T[:3, 2]}):
        _, errors = run_steps(qiao, Target(T[:3, 3], **extra), q)
        assert errors[0, 1] == pytest.approx(2.0)


@pytest.mark.parametrize("rows", [1, 3, 6])
def test_symmetric_systems_are_solved(rows, rng):
    for _ in range(20):
        A, right = rng.normal(size=(rows, rows)), rng.normal(size=rows)
        A = A @ A.T + 0.1 * np.eye(rows)
        system, out_x = np.zeros((6, 6)), np.zeros(6)
        system[:rows, :rows] = np.tril(A)
        solve_symmetric(system, np.concatenate([right, np.zeros(6 - rows)]), rows, out_x)
        np.testing.assert_allclose(out_x[:rows], np.linalg.solve(A, right), rtol=1e-9, atol=1e-9)
