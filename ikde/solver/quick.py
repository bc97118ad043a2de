"""One target at a time from Python: an answer of `solver.ask` as a result."""

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property, lru_cache, partial
from typing import Any

import numpy as np

from ikde.model.collision_model import CollisionChoice, CollisionModel
from ikde.model.large_worlds import KEPT
from ikde.model.robot import Robot
from ikde.model.target import Target
from ikde.solver.ask import Ask, Layouts, Plan, Settled, Ways, lay_out, make_plan
from ikde.solver.choice import find_free
from ikde.solver.engines.pool import runs_on_tables
from ikde.solver.explain import explain_reach, explain_ruled_out
from ikde.solver.problem import Problem, make_problem
from ikde.solver.result import STOP_REASONS, ResultMaker, SolveResult, StopReason, change_result
from ikde.solver.settings import SolveSettings, choose_settings
from ikde.solver.standing import refuse_touching
from ikde.solver.way import as_word

OUT_OF_REACH = {"reached": False, "stop_reason": StopReason.OUT_OF_REACH, "_explain": explain_reach}


class Quick(Ask):
    """A question about one target after another."""

    def __init__(self, problem: Problem, plan: Plan, ways: Ways, lay_out: Callable[[str], Sequence[Any]]) -> None:
        super().__init__(problem, plan, ways, lay_out)
        self._maker = ResultMaker(problem, self.engine)

    def solve(self, target: Target, seed: int, stream: int, started: float) -> SolveResult | None:
        """A graded solution or a proof that there is none, or None if this target needs another engine, or a reason.

        `started`: when the caller began to wait, by `time.perf_counter`.
        """
        if not self.is_ready:
            return self._solve_first(target, seed, stream, started)
        return self._ask(target, seed, stream, started)

    def in_world(self, collision: CollisionModel) -> "Quick":
        """The same among obstacles; raises `InputError` for what always touches one."""
        refuse_touching(collision)
        problem = replace(self._problem, collision=collision)
        plan = self.plan._replace(size=self.plan.size + len(collision.counted) - len(collision.own.pairs))
        return Quick(problem, plan, self.ways, partial(self._layouts.lay_out, problem))

    @cached_property
    def _layouts(self) -> Layouts:
        """What stays in all worlds."""
        return Layouts(self.ways.kind)

    def _ask(self, target: Target, seed: int, stream: int, started: float) -> SolveResult | None:
        plan, word = self.plan, as_word(seed)
        row = np.empty(plan.size)
        if self.answer(target.T_world_tool, word, stream, 0, plan.first, row):
            return self._maker.make(row, target, seed, stream, time.perf_counter() - started)
        settled = self.settle(row, target, word, stream)
        return settled and self._make(settled, target, seed, stream, time.perf_counter() - started)

    def _make(self, settled: Settled, target: Target, seed: int, stream: int, solve_seconds: float) -> SolveResult:
        """The result of what is settled; a proof is put into words when it is asked for."""
        row, engine, excess, why = settled
        maker = self._maker if engine == self.engine else ResultMaker(self._problem, engine)
        result = maker.make(row, target, seed, stream, solve_seconds)
        if excess != (0.0, 0.0):
            return change_result(result, **OUT_OF_REACH)
        if why < 0:
            return result
        explain = partial(explain_ruled_out, row=row, why=why, seed=seed, stream=stream)
        return change_result(result, reached=False, stop_reason=STOP_REASONS[why], _explain=explain)

    def _solve_first(self, target: Target, seed: int, stream: int, started: float) -> SolveResult | None:
        """An answer while there is no machine code, or the first with it: waiting for it is not solving."""
        result = self._ask(target, seed, stream, started)
        self.bind()
        waited_s, compile_s = self.ways.take_waited_s()
        if result is None or not waited_s:
            return result
        return change_result(result, solve_seconds=result.solve_seconds - waited_s, compile_seconds=compile_s)


@KEPT.add
@lru_cache(maxsize=64)
def find_quick(
    robot: Robot, settings: SolveSettings | None, method: str, choice: CollisionChoice, kind: str
) -> Quick | None:
    """The quick way of a question, or None: without a plan, or on tables, where engine and grader would share code."""
    collision = CollisionModel.of(robot, choice)
    if collision.is_in_world:
        quick = find_quick(robot, settings, method, collision.own, kind)
        return quick and quick.in_world(collision)
    chosen = choose_settings(settings, method)
    plan = make_plan(collision, chosen, kind, find_free(robot.lower, robot.upper))
    if plan is None or runs_on_tables():
        return None
    problem = make_problem(robot, chosen, collision=collision, near=None, freeze=None)
    return Quick(problem, plan, Ways(collision, kind), partial(lay_out, problem, kind))
