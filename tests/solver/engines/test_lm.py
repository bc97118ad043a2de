"""The engine `lm`: all kinds of targets in one question, one by one and side by side."""

import pytest

import ikde
from ikde.solver.engines.lm import ONE_BY_ONE, DampedLeastSquares
from tests.solver.engines.questions import assert_solved, make_question, run

KINDS = ("pose", "position", "axis")


@pytest.mark.parametrize("count", [3, 3 * ONE_BY_ONE])
def test_targets_of_all_kinds_are_solved(qiao, rng, count):
    question, targets = make_question(qiao, rng, (KINDS * ONE_BY_ONE)[:count])
    run(DampedLeastSquares(question), count, 512)
    assert_solved(question, targets)


def test_few_and_many_give_the_same_bits(qiao, rng):
    question, targets = make_question(qiao, rng, KINDS * 4)
    run(DampedLeastSquares(question), len(targets), 256)
    few, _ = make_question(qiao, rng, ())
    for row in range(len(targets)):
        one = ikde.solve(qiao, targets[row], method="lm", seed=1, stream=row)
        assert one.q.tobytes() == question.found.q[row].tobytes()
    del few


def test_frozen_joints_do_not_move(qiao, rng):
    settings = ikde.SolveSettings(method="lm")
    target = ikde.Target((0.9, 0.2, 0.9))
    result = ikde.solve(qiao, target, settings, freeze={"d_x": 0.3, "d_y": 0.1, "q_z": -0.2})
    assert result.reached
    assert result.q[:3].tolist() == [0.3, 0.1, -0.2]


def test_near_gives_the_start_itself_if_it_is_a_solution(qiao):
    near = ikde.solve(qiao, ikde.Target((0.8, 0.5, 1.0))).q
    again = ikde.solve(qiao, ikde.Target((0.8, 0.5, 1.0)), near=near)
    assert (again.q == near).all()
