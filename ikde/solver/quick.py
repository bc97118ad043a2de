"""One target at a time, without preparation: everything but target, seed and stream is ready and waits.

The answer is that of the long way (`solver.results`), bit for bit; what this way cannot answer is left to that one.
"""

import time
from collections.abc import Callable
from functools import cached_property, lru_cache, partial

import numpy as np

from ikde.kernels.answer import BLOCKED, FIRST_COUNT, METRICS, SCORE, size_of
from ikde.kernels.arrays import REACHED
from ikde.kernels.jit import compile_clock
from ikde.model.closed_form import find_still_arm
from ikde.model.collision_model import CollisionChoice, CollisionModel
from ikde.model.robot import Robot
from ikde.model.target import Target
from ikde.solver.engine_table import ENGINES
from ikde.solver.engines.analytic import prepare_answer
from ikde.solver.engines.lm import pack_answer
from ikde.solver.engines.pool import load_kernels, runs_on_tables
from ikde.solver.explain import explain_reach
from ikde.solver.problem import make_problem
from ikde.solver.proof import prove
from ikde.solver.result import ResultMaker, SolveResult, StopReason
from ikde.solver.search import choose_engines
from ikde.solver.settings import SolveSettings, choose_settings

ENGINE, CLOSED = "lm", "analytic"
HALF_WORDS = 2**63
OUT_OF_REACH = {"reached": False, "stop_reason": StopReason.OUT_OF_REACH, "_explain": explain_reach}

Answer = Callable[..., bool]
"""`answer(T_world_tool, seed, stream, first, last, out)`: attempts `first` .. `last` - 1 and their grade, as
`lm.answer_target`."""


class Stages:
    """How one question is asked of the engine `lm`: a few attempts, a bound, and then all that it has."""

    def __init__(self, collision: CollisionModel, settings: SolveSettings, *, is_last: bool) -> None:
        joints, row, budget = len(collision.robot.joints), ENGINES[ENGINE], settings.budget(ENGINE)
        self._size, self._reached = size_of(joints, len(collision.pairs)), joints + METRICS + FIRST_COUNT + REACHED
        self._few = min(row.attempts_before_proof, budget)
        self._all = budget if is_last or row.attempts_before_next is None else row.attempts_before_next
        if settings.timeout_s is not None:
            self._all = self._few

    def ask(
        self, answer: Answer, maker: ResultMaker, target: Target, seed: int, stream: int, started: float
    ) -> SolveResult | None:
        """A graded solution or a proof that there is none, or None if this target needs another engine, or a reason.

        `started`: when the caller began to wait, by `time.perf_counter`.
        """
        row, word = np.empty(self._size), seed if seed < HALF_WORDS else seed - 2 * HALF_WORDS
        if answer(target.T_world_tool, word, stream, 0, self._few, row):
            return maker.make(row, target, seed, stream, time.perf_counter() - started)
        if row.view(np.int64)[self._reached]:
            return None
        if prove(maker.problem, target) != (0.0, 0.0):
            made = maker.make(row, target, seed, stream, time.perf_counter() - started)
            return made.with_changes(**OUT_OF_REACH)
        if self._all > self._few and answer(target.T_world_tool, word, stream, self._few, self._all, row):
            return maker.make(row, target, seed, stream, time.perf_counter() - started)
        return None


class Quick:
    """The engine `lm` and the grader, for one collision model, settings and kind of target."""

    def __init__(self, collision: CollisionModel, settings: SolveSettings, kind: str, *, is_last: bool = False) -> None:
        problem = make_problem(collision.robot, settings, collision=collision, near=None, freeze=None)
        answer = partial(load_kernels(collision, kind).answer_target.compiled, *pack_answer(problem, kind))
        stages, maker = Stages(collision, settings, is_last=is_last), ResultMaker(problem, ENGINE)
        self._ask, self._is_ready = partial(stages.ask, answer, maker), False

    def solve(self, target: Target, seed: int, stream: int, started: float) -> SolveResult | None:
        """As `Stages.ask`; the first one compiles."""
        if self._is_ready:
            return self._ask(target, seed, stream, started)
        self._is_ready = True
        return compile_first(self._ask, target, seed, stream)


def compile_first(ask: Callable[..., SolveResult | None], target: Target, seed: int, stream: int) -> SolveResult | None:
    """The first answer, whose time is that of a second try."""
    with compile_clock() as clock:
        ask(target, seed, stream, 0.0)
    result = ask(target, seed, stream, time.perf_counter())
    return result and result.with_changes(compile_seconds=clock.seconds)


class QuickPose:
    """The closed form of an arm that alone may move, and the grader; where no branch is free a few attempts of `lm`."""

    def __init__(self, collision: CollisionModel, settings: SolveSettings, has_next: bool = True) -> None:
        self._problem = make_problem(collision.robot, settings, collision=collision, near=None, freeze=None)
        self._answer, self._results = prepare_answer(self._problem), ResultMaker(self._problem, CLOSED)
        self._counts = len(collision.robot.joints) + METRICS
        self._size, self._has_next = size_of(len(collision.robot.joints), len(collision.pairs)), has_next
        self._is_ready = False

    def solve(self, target: Target, seed: int, stream: int, started: float) -> SolveResult | None:
        """As `Stages.ask`; the first one compiles."""
        if self._is_ready:
            return self._ask(target, seed, stream, started)
        self._is_ready = True
        return compile_first(self._ask, target, seed, stream)

    def _ask(self, target: Target, seed: int, stream: int, started: float) -> SolveResult | None:
        row, word = np.empty(self._size), seed if seed < HALF_WORDS else seed - 2 * HALF_WORDS
        if self._answer(target.T_world_tool, word, stream, 0, 1, row):
            return self._results.make(row, target, seed, stream, time.perf_counter() - started)
        tried = row[self._counts :].view(np.int64)
        if tried[FIRST_COUNT + REACHED] or not self._has_next:
            return None
        row, (answer, results) = np.empty(self._size), self._next
        is_reached = answer(target.T_world_tool, word, stream, 0, ENGINES[ENGINE].attempts_before_proof, row)
        is_far = not is_reached and prove(self._problem, target) != (0.0, 0.0)
        if not is_reached and not is_far:
            return None
        for part in (slice(FIRST_COUNT, SCORE), slice(BLOCKED, None)):
            row[self._counts :].view(np.int64)[part] += tried[part]
        made = results.make(row, target, seed, stream, time.perf_counter() - started)
        return made.with_changes(**OUT_OF_REACH) if is_far else made

    @cached_property
    def _next(self) -> tuple[Answer, ResultMaker]:
        """What is seldom needed: `lm`, whose seeds have to be drawn or loaded."""
        kernels = load_kernels(self._problem.collision, "pose")
        answer = partial(kernels.answer_target.compiled, *pack_answer(self._problem, "pose"))
        return answer, ResultMaker(self._problem, ENGINE)


@lru_cache(maxsize=64)
def find_quick(
    robot: Robot, settings: SolveSettings | None, method: str, choice: CollisionChoice, kind: str
) -> Quick | QuickPose | None:
    """The quick way of a question, or None: it needs written kernels, and as the first to try `lm` or the closed form.

    On tables, engine and grader would share their code.
    """
    chosen, collision = choose_settings(settings, method), CollisionModel.of(robot, choice)
    engines = choose_engines(robot, chosen, {kind})
    may_move = bool((robot.lower < robot.upper).any())
    if runs_on_tables() or not may_move or kind not in ENGINES[engines[0]].target_kinds:
        return None
    if engines[0] == CLOSED and find_still_arm(robot, robot.lower, robot.upper) is not None:
        return QuickPose(collision, chosen, has_next=ENGINE in engines)
    if engines[0] != ENGINE:
        return None
    return Quick(collision, chosen, kind, is_last=len(engines) == 1)
