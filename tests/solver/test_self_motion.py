"""Steps along the null space: the tool stays, held joints stay, near pairs keep their distance, and slopes learn."""

import numpy as np
import pytest

import ikde
from ikde.solver.objectives import make_objective
from ikde.solver.problem import make_problem
from ikde.solver.self_motion import SelfMotion, _find_nearest, _scale, _update_bend
from ikde.solver.settings import SolveSettings
from tests.targets import free_q, make_target


def motion_of(robot, target, **words):
    words = {"collision": None, "near": None, "freeze": None} | words
    return SelfMotion(problem=make_problem(robot, SolveSettings(), **words), target=target)


@pytest.mark.parametrize(("kind", "count"), [("position", 6), ("axis", 4), ("pose", 3)])
def test_free_directions_leave_the_tool(qiao, rng, kind, count):
    q = free_q(qiao, rng)
    target = make_target(qiao, q, kind)
    motion = motion_of(qiao, target)
    free = motion._find_free(q)
    assert free.shape == (9, count)
    np.testing.assert_allclose(free.T @ free, np.eye(count), rtol=0, atol=1e-12)
    moved = ikde.verify(qiao, target, q + 1e-6 * free[:, 0] * motion.moving)
    assert max(moved.position_error_m, moved.orientation_error_rad) < 1e-9


def test_held_joints_do_not_move(qiao, rng):
    q = free_q(qiao, rng)
    held = dict(zip(("d_x", "q3"), q[[0, 5]].tolist(), strict=True))
    motion = motion_of(qiao, make_target(qiao, q, "position"), freeze=held)
    assert not motion._find_free(q)[[0, 5]].any()
    end = motion.climb(q, make_objective(motion.problem, "manipulability"))
    assert end.q[[0, 5]].tolist() == q[[0, 5]].tolist()
    assert end.steps > 0


@pytest.mark.parametrize("kind", ["position", "axis", "pose"])
def test_a_step_too_far_comes_back_onto_the_target(qiao, rng, kind):
    q = free_q(qiao, rng)
    target = make_target(qiao, q, kind)
    back = motion_of(qiao, target)._come_back(q, q + rng.uniform(-0.02, 0.02, 9))
    found = ikde.verify(qiao, target, back)
    assert found.accepted
    assert max(found.position_error_m, found.orientation_error_rad) < 1e-11


def test_what_keeps_little_keeps_that(qiao, rng):
    """A millimetre beyond what is asked for, or what there was at first if that is less."""
    q = free_q(qiao, rng)
    motion = motion_of(qiao, make_target(qiao, q, "position"))
    end = motion.climb(q, make_objective(motion.problem, "manipulability"))
    assert motion.kept_m == min(1e-3, ikde.check(qiao, q).clearance_m)
    assert ikde.check(qiao, end.q).clearance_m >= 0.9 * motion.kept_m


def test_the_point_of_a_polytope():
    normals, offsets = np.array([[2.0, 0.0], [0.0, 1.0], [0.0, 0.0]]), np.array([2.0, -1.0, -1.0])
    np.testing.assert_allclose(_find_nearest(normals, offsets, np.zeros(2)), [1.0, 0.0], atol=1e-12)
    assert _find_nearest(np.array([[1.0, 0.0], [-1.0, 0.0]]), np.array([1.0, 1.0]), np.zeros(2)) is None


def test_bends_are_learned_and_scale_steps(rng):
    A = np.diag([1.0, 4.0, 9.0])
    bend = np.eye(3)
    for k in range(30):
        step = rng.standard_normal(3)
        bend = _update_bend(bend, step, A @ step, k == 0)
    np.testing.assert_allclose(bend, A, rtol=0, atol=1e-3)
    assert np.linalg.eigvalsh(_update_bend(bend, np.array([1.0, 0, 0]), np.array([-1.0, 0, 0]), False)).min() > 0.0
    free = np.eye(3)[:, 1:]
    scaled = _scale(free, A)
    np.testing.assert_allclose(scaled.T @ A @ scaled, np.eye(2), atol=1e-12)
