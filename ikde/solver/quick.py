"""One target at a time, without preparation: everything but target, seed and stream is ready and waits.

The answer is that of the long way (`solver.results`), bit for bit; what this way cannot answer is left to that one.
"""

import time
from functools import lru_cache, partial

import numpy as np

from ikde.kernels.arrays import COLLIDING, COUNTS, REACHED
from ikde.kernels.grade_one import grade_one
from ikde.kernels.jit import compile_clock
from ikde.kernels.turns import unwind
from ikde.model.collision_model import CollisionChoice, CollisionModel
from ikde.model.robot import Robot
from ikde.model.target import KINDS, Target
from ikde.solver.engine_table import ENGINES
from ikde.solver.engines.lm import prepare_search
from ikde.solver.engines.pool import runs_on_tables
from ikde.solver.explain import count_blocking_pairs
from ikde.solver.metrics import pack_grader
from ikde.solver.problem import make_problem
from ikde.solver.result import ResultMaker, SolveResult
from ikde.solver.search import choose_engines
from ikde.solver.settings import SolveSettings, choose_settings

ENGINE = "lm"


class Quick:
    """The engine `lm` and the grader, for one collision model, settings and kind of target."""

    def __init__(self, collision: CollisionModel, settings: SolveSettings, kind: str) -> None:
        problem = make_problem(collision.robot, settings, collision=collision, near=None, freeze=None)
        self._kind = np.array([KINDS.index(kind)])
        self._kind.setflags(write=False)
        self._turns = problem.turns
        self._search = prepare_search(problem, kind)
        self._grade = partial(grade_one, *pack_grader(collision, settings))
        self._last = min(ENGINES[ENGINE].attempts_before_proof, int(settings.budget(ENGINE)))
        self._joints, self._pairs = len(collision.robot.joints), collision.pairs
        self._no_score, self._results = np.full(2, np.inf), ResultMaker(problem, method=ENGINE)
        self._is_ready = False

    def solve(self, target: Target, seed: int, stream: int) -> SolveResult | None:
        """A graded solution, or None if this target needs another engine, more attempts, or a reason."""
        if self._is_ready:
            return self._try(target, seed, stream)
        with compile_clock() as clock:
            self._try(target, seed, stream)
            result = self._try(target, seed, stream)
        if result is not None:
            result.__dict__["compile_seconds"] = clock.seconds
        self._is_ready = True
        return result

    def _try(self, target: Target, seed: int, stream: int) -> SolveResult | None:
        started = time.perf_counter()
        kind, T_world_tool = self._kind, target.T_world_tool[None]
        q, score = np.empty(self._joints), self._no_score.copy()
        counts, blocked = np.zeros(COUNTS, dtype=np.int64), np.zeros(len(self._pairs), dtype=np.int64)
        self._search(kind, T_world_tool, 0, np.uint64(seed), stream, 0, self._last, q, score, counts, blocked)
        if not counts[REACHED]:
            return None
        seconds = time.perf_counter() - started
        unwind(*self._turns, q)
        q.setflags(write=False)
        metrics = self._grade(kind, T_world_tool, q)
        if not metrics[-1]:
            return None
        counted = counts.tolist()
        if not counted[COLLIDING]:
            return self._results.make(target, q, metrics, counted, seed, stream, seconds)
        blocking = {"blocking_pairs": count_blocking_pairs(self._pairs, blocked)}
        return self._results.make(target, q, metrics, counted, seed, stream, seconds, blocking)


@lru_cache(maxsize=64)
def find_quick(
    robot: Robot, settings: SolveSettings | None, method: str, choice: CollisionChoice, kind: str
) -> Quick | None:
    """The quick way of a question, or None: it needs the engine `lm` to be the first to try, and written kernels.

    On tables, engine and grader would share their code.
    """
    chosen, collision = choose_settings(settings, method), CollisionModel.of(robot, choice)
    engines = choose_engines(robot, chosen, {kind})
    if engines[0] != ENGINE or runs_on_tables():
        return None
    return Quick(collision, chosen, kind)
