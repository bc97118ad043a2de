"""One target at a time, without preparation: everything but target, seed and stream is ready and waits.

The answer is that of the long way (`solver.rows`), bit for bit; what this way cannot answer is left to that one.
"""

import time
from functools import lru_cache, partial

import numpy as np

from ikde.kernels.arrays import COUNTS, REACHED
from ikde.kernels.flat_arguments import flatten_search
from ikde.kernels.grade_one import grade_one
from ikde.kernels.jit import compile_clock
from ikde.model.collision_model import CollisionChoice, CollisionModel
from ikde.model.robot import Robot
from ikde.model.target import KINDS, Target
from ikde.solver.engine_table import ENGINES
from ikde.solver.engines.engine import make_descent, make_ranges
from ikde.solver.engines.pool import load_kernels, make_seeds, runs_on_tables
from ikde.solver.explain import count_blocking_pairs
from ikde.solver.figures import pack_grader
from ikde.solver.problem import make_problem, pack_searched
from ikde.solver.result import SolveResult, StopReason, reached_reason
from ikde.solver.search import choose_engines
from ikde.solver.settings import SolveSettings, choose_settings
from ikde.solver.verify import verify

ENGINE = "lm"


class Quick:
    """The engine `lm` and the grader, for one collision model, settings and kind of target."""

    def __init__(self, collision: CollisionModel, settings: SolveSettings, kind: str) -> None:
        problem = make_problem(collision.robot, settings, collision=collision, near=None, freeze=None)
        search = (make_ranges(problem), make_descent(problem, kind), make_seeds(problem, kind))
        self._kind = np.array([KINDS.index(kind)])
        self._kind.setflags(write=False)
        self._search = load_kernels(collision, kind).solve_target
        self._block = flatten_search(*pack_searched(collision), *search)
        self._last = min(ENGINES[ENGINE].attempts_before_proof, int(settings.budget(ENGINE)))
        self._grader = pack_grader(collision, settings)
        self._joints, self._pairs = len(collision.robot.joints), collision.pairs
        self._no_score = np.full(2, np.inf)
        self._common = {
            "reached": True,
            "stop_reason": StopReason.REACHED,
            "reason": reached_reason(collision),
            "hint": None,
            "joint_names": collision.robot.joint_names,
            "self_collision": False if self._pairs else None,
            "verified": None,
            "method": ENGINE,
            "settings": settings,
            "detector": collision.name,
            "verify": partial(verify, collision.robot, settings=settings, collision=collision),
            "compile_seconds": 0.0,
        }
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
        T_world_tool = target.T_world_tool[None]
        q, score = np.empty(self._joints), self._no_score.copy()
        counts, blocked = np.zeros(COUNTS, dtype=np.int64), np.zeros(len(self._pairs), dtype=np.int64)
        lane = (np.uint64(seed), stream, 0, self._last, q, score, counts, blocked)
        self._search(self._kind, T_world_tool, 0, *self._block, *lane)
        if not counts[REACHED]:
            return None
        seconds = time.perf_counter() - started
        q.setflags(write=False)
        graded = grade_one(*self._grader, self._kind, T_world_tool, q)
        position, orientation, clearance, pair, accepted = graded
        if not accepted:
            return None
        _, attempts, evaluations, rejected, _ = counts.tolist()
        result = object.__new__(SolveResult)
        result.__dict__.update(  # a frozen dataclass sets its 26 fields one by one, which takes five times as long
            self._common,
            q=q,
            target=target,
            position_error_m=position,
            orientation_error_rad=orientation,
            clearance_m=clearance if pair >= 0 else None,
            closest_pair=self._pairs[pair] if pair >= 0 else None,
            seed=seed,
            stream=stream,
            attempts=attempts,
            evaluations=evaluations,
            rejected=rejected,
            blocking_pairs=count_blocking_pairs(self._pairs, blocked) if rejected else {},
            solve_seconds=seconds,
        )
        return result


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
