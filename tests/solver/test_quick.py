"""The quick way gives the bits of the long way, and leaves to it what it cannot answer."""

import numpy as np
import pytest

import ikde
from ikde.solver.problem import make_problem
from ikde.solver.quick import find_quick
from ikde.solver.rows import solve_rows
from ikde.solver.search import choose_engines
from ikde.solver.settings import SolveSettings
from tests.solver.test_solve import KINDS, free_q, make_target

AUTO = SolveSettings.for_method("auto")


def solve_long(robot, target, settings, seed, stream):
    problem = make_problem(robot, settings, detector=None, near=None, freeze=None)
    return solve_rows(problem, [target], seed=seed, first_stream=stream).row(0)


@pytest.mark.parametrize("kind", KINDS)
def test_quick_and_long_give_the_same_result(qiao, rng, kind):
    for stream in range(5):
        target = make_target(qiao, free_q(qiao, rng), kind)
        quick, long = ikde.solve(qiao, target, seed=4, stream=stream), solve_long(qiao, target, AUTO, 4, stream)
        assert quick.q.tobytes() == long.q.tobytes()
        assert quick.verification == long.verification
        told = [vars(result) for result in (quick, long)]
        assert told[0].keys() == told[1].keys()
        for name in told[0].keys() - {"q", "target", "solve_seconds", "compile_seconds", "verify", "verification"}:
            assert told[0][name] == told[1][name], name
        assert (quick.target.p_world_tool == long.target.p_world_tool).all()


def test_a_result_of_the_quick_way_cannot_be_changed(qiao):
    result = ikde.solve(qiao, ikde.Target((0.8, 0.5, 1.0)))
    with pytest.raises(ValueError, match="read-only"):
        result.q[0] = 1.0
    with pytest.raises(AttributeError):
        result.reached = False


def test_what_is_not_reached_goes_the_long_way(qiao):
    result = ikde.solve(qiao, ikde.Target((0.0, 0.0, 9.0)))
    assert (result.reached, result.stop_reason) == (False, "out_of_reach")
    assert result.hint


@pytest.mark.parametrize("settings", [SolveSettings(method="memetic"), SolveSettings(strategy="best/1")])
def test_other_engines_have_no_quick_way(qiao, settings):
    assert find_quick(qiao, settings, "auto", None, "pose") is None


def test_a_fixed_arm_falls_back_on_its_closed_form():
    robot = ikde.load_robot("ur5")
    assert choose_engines(robot, AUTO, only_poses=True) == ["lm", "analytic", "memetic"]
    assert choose_engines(robot, AUTO, only_poses=False) == ["lm", "memetic"]
    target = make_target(robot, np.array([0.3, -1.2, 1.4, -1.5, -1.3, 0.4]), "pose")
    assert ikde.solve(robot, target).method == "lm"
