"""What engines share: rows that are open, ranges, and settings of damped least squares."""

import numpy as np

import ikde
from ikde.solver.engines.engine import make_descent, make_ranges
from ikde.solver.problem import make_problem
from tests.solver.engines.questions import make_question


def test_attempts_go_to_open_rows_of_the_kind_only(qiao, rng):
    question, _ = make_question(qiao, rng, ("pose", "position", "position", "position"))
    question.found.counts[2, 0] = 1  # reached
    question.found.excess_m[3] = 0.5  # proved out of reach
    attempts = question.attempts(range(4), 2, np.array([9, 8, 7, 6]), kind=0)
    assert attempts.tolist() == [[2, 2], [2, 8], [2, 2], [2, 2]]
    assert question.attempts(range(0, 2), 2, np.array([9, 8, 7, 6])).tolist() == [[2, 9], [2, 8]]


def test_ranges_hold_limits_and_the_middle_or_near(qiao):
    settings = ikde.SolveSettings()
    plain = make_ranges(make_problem(qiao, settings, detector=None, near=None, freeze=None))
    assert (plain == [qiao.lower, qiao.upper, 0.5 * (qiao.lower + qiao.upper)]).all()
    near = make_ranges(make_problem(qiao, settings, detector=None, near=qiao.home, freeze={"d_x": 0.25}))
    assert near[:2, 0].tolist() == [0.25, 0.25]
    assert (near[2, 1:] == qiao.home[1:]).all()


def test_tolerances_are_a_hair_smaller_than_asked(qiao):
    asked = ikde.SolveSettings(position_tolerance_m=1e-9, orientation_tolerance_rad=1e-3)
    descent = make_descent(make_problem(qiao, asked, detector=None, near=None, freeze=None))
    assert 0.99e-9 < descent.position_tolerance < 1e-9
    assert 1e-3 - 2e-12 < descent.orientation_tolerance < 1e-3
