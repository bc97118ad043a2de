"""One target at a time, without preparation: everything but target, seed and stream is ready and waits.

The answer is that of the long way (`solver.results`), bit for bit; what this way cannot answer is left to that one.
"""

import time
from collections.abc import Callable, Sequence
from functools import lru_cache, partial
from typing import Any, NamedTuple

import numpy as np

from ikde.kernels.answer import BLOCKED, FIRST_COUNT, METRICS, SCORE, size_of
from ikde.kernels.arrays import REACHED, Floats
from ikde.model.closed_form import find_ur_arm
from ikde.model.collision_model import CollisionChoice, CollisionModel
from ikde.model.robot import Robot
from ikde.model.target import Target, Targets
from ikde.solver.background import NEAR, ONE, Question
from ikde.solver.branches import rule_out
from ikde.solver.engine_table import ENGINES
from ikde.solver.engines import analytic, lm
from ikde.solver.engines.pool import load_kernels, runs_on_tables
from ikde.solver.explain import explain_reach, explain_ruled_out
from ikde.solver.problem import Problem, make_problem
from ikde.solver.proof import prove
from ikde.solver.result import STOP_REASONS, ResultMaker, SolveResult, StopReason
from ikde.solver.search import choose_engines, find_free
from ikde.solver.settings import SolveSettings, choose_settings
from ikde.solver.way import Answer, Way, as_word

LM, CLOSED = "lm", "analytic"
OUT_OF_REACH = {"reached": False, "stop_reason": StopReason.OUT_OF_REACH, "_explain": explain_reach}


class Ways:
    """Those of one collision model and kind of target, for each engine, with `near` and without."""

    def __init__(self, collision: CollisionModel, kind: str) -> None:
        kernels = load_kernels(collision, kind)
        calls = {(LM, False): "answer_target", (LM, True): "answer_near"}
        calls |= {(CLOSED, False): "answer_pose", (CLOSED, True): "answer_pose_near"}
        self._ways = {
            (engine, is_near): Way(getattr(kernels, call), Question(collision, kind, NEAR if is_near else ONE, engine))
            for (engine, is_near), call in calls.items()
            if hasattr(kernels, call)
        }

    def find(self, engine: str, is_near: bool) -> Way:
        """The way of an engine."""
        return self._ways[engine, is_near]

    def take_waited_s(self) -> tuple[float, float]:
        """For how long machine code has been waited for since this was asked last, and how much of it was compiling."""
        waited_s, compile_s = zip(*(way.take_waited_s() for way in self._ways.values()), strict=True)
        return sum(waited_s), sum(compile_s)


class Plan(NamedTuple):
    """How a question is asked: of the closed form, or of `lm`, a few attempts, a bound, and then all that it has."""

    size: int
    """Of a row."""
    counts: int
    """Where in a row whole numbers begin."""
    is_closed: bool
    has_lm: bool
    few: int
    all: int


def make_plan(collision: CollisionModel, settings: SolveSettings, kind: str, free: set[int]) -> Plan | None:
    """The plan where the joints `free` may move; None if another engine comes first.

    The closed form must be that of an arm that alone may move.
    """
    engines, arm = choose_engines(collision.robot, settings, {kind}, free=free), find_ur_arm(collision.robot)
    if not free or engines[0] not in (LM, CLOSED) or kind not in ENGINES[engines[0]].target_kinds:
        return None
    if engines[0] == CLOSED and (arm is None or not free <= set(arm.coordinates)):
        return None
    joints, row, budget = len(collision.robot.joints), ENGINES[LM], settings.budget(LM)
    few = min(row.attempts_before_proof, budget)
    all_of_it = budget if engines[-1] == LM or row.attempts_before_next is None else row.attempts_before_next
    return Plan(
        size=size_of(joints, len(collision.pairs)),
        counts=joints + METRICS,
        is_closed=engines[0] == CLOSED,
        has_lm=LM in engines,
        few=few,
        all=few if settings.timeout_s is not None else all_of_it,
    )


class Quick:
    """A question with its plan, about one target after another; `lay_out` gives what stays of an engine's call."""

    def __init__(self, problem: Problem, plan: Plan, ways: Ways, lay_out: Callable[[str], Sequence[Any]]) -> None:
        self._problem, self._plan, self._ways, self._lay_out = problem, plan, ways, lay_out
        self._first = CLOSED if plan.is_closed else LM
        self._maker = ResultMaker(problem, self._first)
        self._answer, self._is_ready = self._bind(self._first)

    def solve(self, target: Target, seed: int, stream: int, started: float) -> SolveResult | None:
        """A graded solution or a proof that there is none, or None if this target needs another engine, or a reason.

        `started`: when the caller began to wait, by `time.perf_counter`.
        """
        if not self._is_ready:
            return self._solve_first(target, seed, stream, started)
        return self._ask(target, seed, stream, started)

    def _bind(self, engine: str) -> tuple[Answer, bool]:
        """The call of an engine, and whether it is machine code."""
        way = self._ways.find(engine, self._problem.near is not None)
        return partial(way.machine or way.begin, *self._lay_out(engine)), way.machine is not None

    def _ask(self, target: Target, seed: int, stream: int, started: float) -> SolveResult | None:
        plan, word = self._plan, as_word(seed)
        row = np.empty(plan.size)
        if self._answer(target.T_world_tool, word, stream, 0, 1 if plan.is_closed else plan.few, row):
            return self._maker.make(row, target, seed, stream, time.perf_counter() - started)
        whole = row[plan.counts :].view(np.int64)
        if whole[FIRST_COUNT + REACHED] or not plan.has_lm:
            return None
        made = self._go_on(row, target, word, stream) if plan.is_closed else self._prove(row, target, word, stream)
        return made and made(target, seed, stream, time.perf_counter() - started)

    def _prove(self, row: Floats, target: Target, word: int, stream: int) -> Callable[..., SolveResult] | None:
        """What a few attempts of `lm` did not reach: a proof, or what further ones reach."""
        plan = self._plan
        if prove(self._problem, target) != (0.0, 0.0):
            return partial(make_unreachable, self._maker, row)
        if plan.all > plan.few and self._answer(target.T_world_tool, word, stream, plan.few, plan.all, row):
            return partial(self._maker.make, row)
        return None

    def _go_on(self, tried: Floats, target: Target, word: int, stream: int) -> Callable[..., SolveResult] | None:
        """What no branch reaches: a few attempts of `lm`, counted with those of the closed form, and a proof."""
        plan, problem = self._plan, self._problem
        row, (answer, _) = np.empty(plan.size), self._bind(LM)
        is_reached = answer(target.T_world_tool, word, stream, 0, plan.few, row)
        is_far = not is_reached and prove(problem, target) != (0.0, 0.0)
        why = -1 if is_reached or is_far else int(rule_out(problem, Targets.of([target]))[0])
        if not is_reached and not is_far and why < 0:
            return None
        best, maker = keep_better(plan, tried, row), ResultMaker(problem, LM)
        if best is tried:
            maker = self._maker
        if is_reached:
            return partial(maker.make, best)
        return partial(make_unreachable, maker, best) if is_far else partial(make_ruled_out, maker, best, why)

    def _solve_first(self, target: Target, seed: int, stream: int, started: float) -> SolveResult | None:
        """An answer while there is no machine code, or the first with it: waiting for it is not solving."""
        result = self._ask(target, seed, stream, started)
        self._answer, self._is_ready = self._bind(self._first)
        waited_s, compile_s = self._ways.take_waited_s()
        if result is None or not waited_s:
            return result
        return result.with_changes(solve_seconds=result.solve_seconds - waited_s, compile_seconds=compile_s)


def make_unreachable(
    maker: ResultMaker, row: Floats, target: Target, seed: int, stream: int, solve_seconds: float
) -> SolveResult:
    """A result of what is proved to be out of reach; the proof is put into words when it is asked for."""
    return maker.make(row, target, seed, stream, solve_seconds).with_changes(**OUT_OF_REACH)


def make_ruled_out(
    maker: ResultMaker, row: Floats, why: int, target: Target, seed: int, stream: int, solve_seconds: float
) -> SolveResult:
    """A result of what the closed form rules out for the reason of this number; its words are made when asked for."""
    explain = partial(explain_ruled_out, row=row, why=why, seed=seed, stream=stream)
    known = {"reached": False, "stop_reason": STOP_REASONS[why], "_explain": explain}
    return maker.make(row, target, seed, stream, solve_seconds).with_changes(**known)


def keep_better(plan: Plan, tried: Floats, row: Floats) -> Floats:
    """Of two rows the one whose score is better, the first of equals, with the counts of both."""
    whole = [part[plan.counts :].view(np.int64) for part in (tried, row)]
    scores = [tuple(part[plan.counts + SCORE : plan.counts + BLOCKED].tolist()) for part in (tried, row)]
    for part in (slice(FIRST_COUNT, SCORE), slice(BLOCKED, None)):
        whole[0][part] = whole[1][part] = whole[0][part] + whole[1][part]
    return row if scores[1] < scores[0] else tried


def lay_out(problem: Problem, kind: str, engine: str) -> Sequence[Any]:
    """What stays from target to target of an engine's call."""
    return analytic.pack_answer(problem) if engine == CLOSED else lm.pack_answer(problem, kind)


@lru_cache(maxsize=64)
def find_quick(
    robot: Robot, settings: SolveSettings | None, method: str, choice: CollisionChoice, kind: str
) -> Quick | None:
    """The quick way of a question, or None: without a plan, or on tables, where engine and grader would share code."""
    chosen, collision = choose_settings(settings, method), CollisionModel.of(robot, choice)
    plan = make_plan(collision, chosen, kind, find_free(robot.lower, robot.upper))
    if plan is None or runs_on_tables():
        return None
    problem = make_problem(robot, chosen, collision=collision, near=None, freeze=None)
    return Quick(problem, plan, Ways(collision, kind), partial(lay_out, problem, kind))
