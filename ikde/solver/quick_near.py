"""The quick way of a target with `near`, frozen joints or weights, which may be others at every call.

What stays is laid out once; ranges and `near` are written into a copy of it, in 2 us. The answer is that of the long
way (`solver.results`), bit for bit, and what this way cannot answer is left to that one.
"""

from collections.abc import Callable, Sequence
from functools import lru_cache, partial
from typing import Any

import numpy as np

from ikde.kernels.flat_arguments import set_ranges
from ikde.model.collision_model import CollisionModel
from ikde.model.target import Target
from ikde.solver.engines import analytic, lm
from ikde.solver.engines.engine import make_descent, make_ranges
from ikde.solver.engines.pool import make_seeds, runs_on_tables
from ikde.solver.problem import Problem
from ikde.solver.quick import CLOSED, LM, Plan, Quick, Ways, make_plan
from ikde.solver.result import SolveResult
from ikde.solver.search import find_free
from ikde.solver.settings import SolveSettings


class QuickNear:
    """One collision model, settings and kind of target, in ranges that change."""

    def __init__(self, collision: CollisionModel, settings: SolveSettings, kind: str) -> None:
        self._collision, self._settings, self._kind = collision, settings, kind
        self._ways, self._plans = Ways(collision, kind), lru_cache(maxsize=64)(self._make_plan)
        self._kept: dict[str, tuple[Any, Sequence[Any]]] = {}

    def solve(self, problem: Problem, target: Target, seed: int, stream: int, started: float) -> SolveResult | None:
        """As `Quick.solve`."""
        plan = self._plans(problem.frozen)
        if plan is None or runs_on_tables():
            return None
        return Quick(problem, plan, self._ways, partial(self._lay_out, problem)).solve(target, seed, stream, started)

    def _make_plan(self, frozen: tuple[str, ...]) -> Plan | None:
        robot = self._collision.robot
        free = {k for k in find_free(robot.lower, robot.upper) if robot.joint_names[k] not in frozen}
        return make_plan(self._collision, self._settings, self._kind, free)

    def _lay_out(self, problem: Problem, engine: str) -> Sequence[Any]:
        """The call of an engine as it was laid out for the one before, with the ranges of this one."""
        is_near = problem.near is not None
        if engine == CLOSED:
            numbers, whole = self._keep(CLOSED, problem.weights, lambda: analytic.pack_answer(problem))
            block = set_ranges(numbers, analytic.make_still_ranges(problem), problem.turns), whole
            return (*block, np.array(make_descent(problem, self._kind)), problem.weights) if is_near else block
        seeds = make_seeds(problem, self._kind)
        numbers, *others = self._keep(LM, seeds, lambda: lm.pack_answer(problem, self._kind, seeds))
        block = set_ranges(numbers, make_ranges(problem), problem.turns), *others
        return (*block, problem.weights) if is_near else block

    def _keep(self, engine: str, source: Any, make: Callable[[], Sequence[Any]]) -> Sequence[Any]:
        """What was made of the same source by the call before, else made now."""
        kept = self._kept.get(engine)
        if kept is None or kept[0] is not source:
            kept = self._kept[engine] = source, make()
        return kept[1]


@lru_cache(maxsize=64)
def find_quick_near(collision: CollisionModel, settings: SolveSettings, kind: str) -> QuickNear:
    """The quick way of a question whose ranges change."""
    return QuickNear(collision, settings, kind)
