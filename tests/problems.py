"""Problems for the search: settings that cost little, and what holds of every answer."""

import numpy as np

import ikde
from ikde.solver.problem import make_problem
from tests.flat_settings import flat_settings

QUICK = ikde.SolveSettings.for_method("auto").with_changes(restarts=8)
CHEAP = flat_settings(population=8, generations=5, restarts=1)
TARGET = ikde.Target((0.8, 0.5, 1.0))


def problem_of(robot, settings=None, **options):
    """A problem with the robot's default detector, nothing near and nothing frozen, but for what is said."""
    given = {"collision": None, "near": None, "freeze": None} | options
    return make_problem(robot, settings or ikde.SolveSettings(), **given)


def are_apart(robot, q, other):
    """More than 0.1 rad in a turn, around the circle, or more than 50 mm in a slide."""
    for joint, a, b in zip(robot.joints, q, other, strict=True):
        if joint.kind == "prismatic" and abs(a - b) > 0.05:
            return True
        if joint.kind == "revolute" and abs(np.angle(np.exp(1j * (a - b)))) > 0.1:
            return True
    return False


def assert_true_to_its_figures(robot, target, result, settings):
    """A reached result is inside, free, within tolerance, and its figures are `verify`'s."""
    graded = ikde.verify(robot, target, result.q, settings=settings)
    assert result.grade == graded
    assert graded.accepted
    assert result.verified
    assert result.reached
    assert result.stop_reason == "reached"
    assert result.hint is None
    assert result.position_error_m <= settings.position_tolerance_m
    assert result.orientation_error_rad <= settings.orientation_tolerance_rad
    assert np.all(robot.lower <= result.q)
    assert np.all(result.q <= robot.upper)
    assert not result.collision
