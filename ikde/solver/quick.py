"""One target at a time, without preparation: everything but target, seed and stream is ready and waits.

The answer is that of the long way (`solver.results`), bit for bit; what this way cannot answer is left to that one.
"""

import time
from collections.abc import Callable
from functools import lru_cache, partial

import numpy as np

from ikde.kernels.answer import FIRST_COUNT, METRICS, size_of
from ikde.kernels.arrays import REACHED
from ikde.kernels.jit import compile_clock
from ikde.model.collision_model import CollisionChoice, CollisionModel
from ikde.model.robot import Robot
from ikde.model.target import Target
from ikde.solver.background import Question, answers_plainly
from ikde.solver.engine_table import ENGINES
from ikde.solver.engines.lm import pack_answer
from ikde.solver.engines.pool import load_kernels, runs_on_tables
from ikde.solver.explain import explain_reach
from ikde.solver.problem import make_problem
from ikde.solver.proof import prove
from ikde.solver.result import ResultMaker, SolveResult, StopReason
from ikde.solver.search import choose_engines
from ikde.solver.settings import SolveSettings, choose_settings

ENGINE = "lm"
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
        self._answer = load_kernels(collision, kind).answer_target.bind(*pack_answer(problem, kind))
        self._stages, self._maker = Stages(collision, settings, is_last=is_last), ResultMaker(problem, ENGINE)
        self._question = Question(collision, kind)
        self._ask: Callable[..., SolveResult | None] | None = None  # by machine code

    def solve(self, target: Target, seed: int, stream: int, started: float) -> SolveResult | None:
        """As `Stages.ask`; the first one compiles, or the first ones are answered in plain Python."""
        if self._ask is not None:
            return self._ask(target, seed, stream, started)
        if answers_plainly(self._answer, self._question):
            return self._stages.ask(self._answer.plain, self._maker, target, seed, stream, started)
        self._ask = partial(self._stages.ask, self._answer.compiled, self._maker)
        return compile_first(self._ask, target, seed, stream)


def compile_first(ask: Callable[..., SolveResult | None], target: Target, seed: int, stream: int) -> SolveResult | None:
    """The first answer, whose time is that of a second try."""
    with compile_clock() as clock:
        ask(target, seed, stream, 0.0)
    result = ask(target, seed, stream, time.perf_counter())
    return result and result.with_changes(compile_seconds=clock.seconds)


@lru_cache(maxsize=64)
def find_quick(
    robot: Robot, settings: SolveSettings | None, method: str, choice: CollisionChoice, kind: str
) -> Quick | None:
    """The quick way of a question, or None: it needs the engine `lm` to be the first to try, and written kernels.

    On tables, engine and grader would share their code.
    """
    chosen, collision = choose_settings(settings, method), CollisionModel.of(robot, choice)
    engines = choose_engines(robot, chosen, {kind})
    may_move = bool((robot.lower < robot.upper).any())
    if engines[0] != ENGINE or runs_on_tables() or not may_move:
        return None
    return Quick(collision, chosen, kind, is_last=len(engines) == 1)
