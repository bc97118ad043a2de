"""What is preferred as figures: the smallest of what is linearised is what is raised, and slopes are derivatives."""

import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from ikde.model.collision_model import CollisionModel
from ikde.solver.measures import MeasureChoice, measure
from ikde.solver.motion import limit_margin
from ikde.solver.objectives import check_prefer, choose_measure, make_objective, measure_manipulability
from ikde.solver.problem import make_problem
from ikde.solver.settings import SolveSettings
from tests.conftest import random_q
from tests.random_robots import make_frame, make_robot
from tests.targets import free_q
from tests.three_joints import ROBOT
from tests.tiny_robot import tiny_robot

STEP = 1e-6
PLANAR = (("a", "world"), ("b", "a"), ("c", "b"))


def problem_of(robot):
    return make_problem(robot, SolveSettings(), collision=None, near=None, freeze=None)


@pytest.mark.parametrize("prefer", ["manipulability", "clearance", "limits", "motion"])
@pytest.mark.parametrize("name", ["panda", "qiao2021", "ur5e_mecanum"])
def test_slopes_are_derivatives_of_what_is_raised(name, prefer, rng):
    robot = ikde.load_robot(name)
    objective, q = make_objective(problem_of(robot), prefer), free_q(robot, rng)
    values, slopes = objective.climb(q)
    assert objective.worth(q) == values.min()
    first = int(values.argmin())
    expected = [
        (objective.worth(q + step) - objective.worth(q - step)) / (2.0 * STEP) for step in STEP * np.eye(len(q))
    ]
    np.testing.assert_allclose(slopes[first], expected, rtol=0, atol=1e-5)


def test_figures_are_those_of_analyses_and_results(qiao, rng):
    q = random_q(qiao, rng)
    show = {
        prefer: make_objective(problem_of(qiao), prefer).show(q) for prefer in ("manipulability", "limits", "motion")
    }
    assert show["manipulability"] == measure(qiao, q, MeasureChoice()).manipulability
    assert show["limits"] == limit_margin(qiao.lower, qiao.upper, q)
    many = random_q(qiao, rng, 4)
    assert measure_manipulability(qiao, many).shape == (4,)


def test_an_arm_of_few_joints_counts_its_translation():
    assert choose_measure(ikde.load_robot("qiao2021")).rows == "pose"
    assert choose_measure(ROBOT).rows == "translation"


def test_what_is_always_singular_has_none():
    """Three joints in a plane never move the tool out of it; a planar arm on a base that turns never rolls it."""
    frames = [make_frame(name, parent, (0.4, 0, 0), joint=name, axis=(0, 0, 1)) for name, parent in PLANAR]
    robot = make_robot({name: "revolute" for name, _ in PLANAR}, [*frames, make_frame("tool", "c", (0.4, 0, 0))])
    with pytest.raises(InputError, match="the manipulability of made is 0 in each of 8 random configurations"):
        choose_measure(robot)
    assert choose_measure(ikde.load_robot("leobot")).rows == "translation"


def test_what_can_have_none_is_refused(qiao):
    with pytest.raises(InputError, match="prefer: expected one of"):
        check_prefer(CollisionModel.of(qiao), "beauty")
    with pytest.raises(InputError, match="prefer: without a detector"):
        check_prefer(CollisionModel.of(qiao, "none"), "clearance")
    with pytest.raises(InputError, match="the manipulability of made is 0 in each of 8 random configurations"):
        check_prefer(CollisionModel.of(tiny_robot()), "manipulability")
