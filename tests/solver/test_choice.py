"""Which engines answer what, with how many attempts."""

import numpy as np
import pytest

import ikde
from ikde.solver.choice import choose_budgets, choose_engines, find_free, is_inside
from ikde.solver.settings import SolveSettings
from tests.problems import problem_of

AUTO = SolveSettings.for_method("auto")
FROZEN_BASE, BASE_AND_ELBOW = {"d_x", "d_y", "q_z"}, {"d_x", "d_y", "q_z", "q3"}


@pytest.mark.parametrize(
    ("frozen", "engines"),
    [
        (set(), ["lm", "memetic"]),
        ({"d_x", "d_y"}, ["lm", "memetic"]),
        ({"q1", "q2", "q3"}, ["lm", "memetic"]),
        (FROZEN_BASE, ["analytic", "lm", "memetic"]),
        (BASE_AND_ELBOW, ["lm", "memetic"]),
    ],
)
def test_auto_takes_the_closed_form_where_the_arm_alone_may_move(qiao, frozen, engines):
    free = {k for k, name in enumerate(qiao.joint_names) if name not in frozen}
    assert choose_engines(qiao, AUTO, {"pose"}, free=free) == engines
    assert choose_engines(qiao, AUTO, {"pose", "axis"}, free=free) == ["lm", "memetic"]


def test_an_arm_without_a_base_is_answered_by_its_closed_form_and_mixed_kinds_are_not():
    ur5 = ikde.load_robot("ur5")
    assert choose_engines(ur5, AUTO, {"pose"}) == ["analytic", "lm", "memetic"]
    assert choose_engines(ur5, AUTO, {"pose", "axis"}) == ["lm", "memetic"]


def test_beyond_the_limits_only_engines_are_asked_that_may_leave_them(qiao):
    assert choose_engines(qiao, AUTO, {"position"}, inside=False) == ["memetic"]
    assert choose_engines(qiao, SolveSettings(method="de"), {"position"}, inside=False) == ["de"]
    problem = problem_of(qiao, AUTO)
    for shift, inside in ((0.0, True), (1e-9, False), (-1e-9, True)):
        assert is_inside(problem.with_ranges(problem.lower, problem.upper + shift)) is inside
        assert is_inside(problem.with_ranges(problem.lower - shift, problem.upper)) is inside


def test_what_may_move(qiao):
    problem = problem_of(qiao, AUTO, freeze={"d_x": 0.1, "q5": 0.2})
    assert find_free(problem.lower, problem.upper) == {*range(9)} - {0, 7}
    assert find_free(np.zeros(2), np.zeros(2)) == set()


def test_each_engine_has_its_attempts(qiao):
    problem = problem_of(qiao, AUTO)
    assert choose_budgets(problem, ("position",), None) == (("lm", 300), ("memetic", 20))
    assert choose_budgets(problem, ("position",), 7) == (("lm", 7), ("memetic", 7))
    assert choose_budgets(problem_of(qiao, AUTO.with_changes(restarts=5)), ("axis",), None)[-1] == ("memetic", 5)
    still = problem_of(qiao, AUTO, freeze=dict.fromkeys(FROZEN_BASE, 0.0))
    assert choose_budgets(still, ("pose",), None)[0] == ("analytic", 1)
