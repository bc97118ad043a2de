"""The engine `analytic`: exact answers, and a clear word where there is no closed form."""

import pytest

import ikde
from ikde.errors import InputError
from ikde.solver.engines.analytic import Analytic, check_closed_form
from tests.solver.engines.questions import assert_solved, make_question, run
from tests.targets import free_q, make_target


@pytest.mark.parametrize("name", ["qiao2021", "ur5"])
def test_poses_are_solved_exactly(name, rng):
    question, targets = make_question(ikde.load_robot(name), rng, ("pose",) * 8)
    run(Analytic(question), 8, 256)
    assert_solved(question, targets)
    result = ikde.solve(ikde.load_robot(name), targets[0], method="analytic")
    assert result.position_error_m < 1e-12
    assert result.orientation_error_rad < 1e-7


def test_joints_stay_in_the_turns_that_they_are_near_to(rng):
    robot = ikde.load_robot("ur5")
    for _ in range(10):
        q = free_q(robot, rng)
        result = ikde.solve(robot, make_target(robot, q, "pose"), method="analytic", near=q)
        assert result.q == pytest.approx(q, abs=1e-9)


def test_positions_are_refused(qiao):
    with pytest.raises(InputError, match="needs a whole pose"):
        ikde.solve(qiao, ikde.Target((0.8, 0.5, 1.0)), method="analytic")


def test_robots_without_a_closed_form_are_refused():
    with pytest.raises(InputError, match="panda has no closed form"):
        check_closed_form(ikde.load_robot("panda"))
