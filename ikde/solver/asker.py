"""Questions with `near`, frozen joints or weights, which may be others at every call.

What stays is laid out once; ranges and `near` are written into a copy of it, in 2 us.
"""

from collections.abc import Callable, Hashable, Sequence
from functools import cached_property, lru_cache, partial
from typing import Any, TypeVar

import numpy as np

from ikde.kernels.arrays import Floats, Ints
from ikde.model.collision_model import CollisionModel
from ikde.model.large_worlds import KEPT
from ikde.solver.ask import CLOSED, LM, Ask, Plan, Ways, make_plan
from ikde.solver.choice import find_free
from ikde.solver.engines import analytic, lm
from ikde.solver.engines.engine import make_ranges, make_walk
from ikde.solver.engines.pool import make_seeds, runs_on_tables
from ikde.solver.joined import JOINS
from ikde.solver.problem import Problem
from ikde.solver.settings import SolveSettings

Asked = TypeVar("Asked", bound=Ask)


class Asker:
    """One collision model, settings and kind of target, in ranges that change."""

    def __init__(self, collision: CollisionModel, settings: SolveSettings, kind: str) -> None:
        self._collision, self._settings, self._kind = collision, settings, kind
        self._plans = lru_cache(maxsize=64)(self._make_plan)
        self._kept: dict[Hashable, tuple[Any, Any]] = {}

    def make(self, problem: Problem, way: type[Asked]) -> Asked | None:
        """The question of a problem, or None if it has no plan, or on tables, where engine and grader share code."""
        plan = self._plans(problem.frozen)
        if plan is None or runs_on_tables():
            return None
        return way(problem, plan, self._ways, partial(self._lay_out, problem))

    @cached_property
    def _ways(self) -> Ways:
        """Loads kernels, which are written first for a new robot."""
        return Ways(self._collision, self._kind)

    def _make_plan(self, frozen: tuple[str, ...]) -> Plan | None:
        robot = self._collision.robot
        free = {k for k in find_free(robot.lower, robot.upper) if robot.joint_names[k] not in frozen}
        return make_plan(self._collision, self._settings, self._kind, free)

    def _lay_out(self, problem: Problem, engine: str) -> Sequence[Any]:
        """The call of an engine as it was laid out for the one before, with the ranges of this one."""
        near = problem.near
        is_near = near is not None
        if engine == CLOSED:
            numbers, whole, *others = self._keep((CLOSED, is_near), problem.weights, analytic.pack_answer, problem)
        else:
            seeds = make_seeds(problem, self._kind)
            numbers, whole, *others = self._keep((LM, is_near), seeds, lm.pack_answer, problem, self._kind, seeds)
        world = problem.collision.arrays.world
        own = JOINS.join(numbers[: len(numbers) - len(world)], world)
        if near is None:
            ranges = analytic.make_still_ranges(problem) if engine == CLOSED else make_ranges(problem)
            set_ranges(own, whole, ranges.ravel(), problem.centre)
            return own, whole, *others
        walk = self._keep("walk", problem.weights, make_walk, problem, self._kind)
        ranges = np.concatenate((problem.lower, problem.upper, near))  # where both engines begin
        set_ranges(own, whole, ranges, near)
        return walk, own, whole, *others

    def _keep(self, name: Hashable, source: Any, make: Callable[..., Any], *arguments: Any) -> Any:
        """What was made of the same source by the call before, else made now."""
        kept = self._kept.get(name)
        if kept is None or kept[0] is not source:
            kept = self._kept[name] = source, make(*arguments)
        return kept[1]


def set_ranges(numbers: Floats, whole: Ints, ranges: Floats, centre: Floats) -> None:
    """Write other ranges [3 N], and turns between them to `centre` [N], into the block of `flatten_answer`."""
    grader = whole[-2]  # where its numbers begin: those of turns are before them
    numbers[1 : 1 + len(ranges)] = numbers[grader - len(ranges) : grader] = ranges
    numbers[grader - len(centre) : grader] = centre


@KEPT.add
@lru_cache(maxsize=64)
def find_asker(collision: CollisionModel, settings: SolveSettings, kind: str) -> Asker:
    """What asks questions whose ranges change."""
    return Asker(collision, settings, kind)
