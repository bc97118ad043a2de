"""The quick way itself: on the tables, which tests run on, `ikde.solve` goes the long way."""

from functools import partial

from ikde.model.collision_model import CollisionModel
from ikde.solver.ask import Ways, lay_out, make_plan
from ikde.solver.choice import find_free
from ikde.solver.quick import Quick
from ikde.solver.settings import SolveSettings
from tests.problems import problem_of

AUTO = SolveSettings.for_method("auto")


def make_quick(robot, kind, settings=AUTO, detector=None):
    """What answers one kind of target, one after the other."""
    collision, problem = CollisionModel.of(robot, detector), problem_of(robot, settings, collision=detector)
    plan = make_plan(collision, settings, kind, find_free(robot.lower, robot.upper))
    return Quick(problem, plan, Ways(collision, kind), partial(lay_out, problem, kind))
