"""One target at a time, without preparation: everything but target, seed and stream is ready and waits.

The answer is that of the long way (`solver.rows`), bit for bit; what this way cannot answer is left to that one.
"""

import time
from collections.abc import Callable
from functools import lru_cache, partial
from typing import Any

import numpy as np

from ikde.kernels.arrays import ATTEMPTS, COLLIDING, COUNTS, EVALUATIONS, REACHED, Floats, Ints, TargetArrays
from ikde.kernels.figures import CLEARANCE, ORIENTATION_ERROR, POSITION_ERROR, compute_figures
from ikde.kernels.jit import compile_clock
from ikde.model.pack import pack_detector, pack_robot
from ikde.model.robot import Detector, Robot
from ikde.model.target import KINDS, Target
from ikde.solver.engines.engine import make_descent, make_ranges
from ikde.solver.engines.pool import load_kernels, make_seeds
from ikde.solver.explain import count_blocking_pairs
from ikde.solver.figures import pack_terms
from ikde.solver.problem import make_problem
from ikde.solver.result import SolveResult, StopReason, reached_reason
from ikde.solver.search import FEW, choose_engines
from ikde.solver.settings import SolveSettings
from ikde.solver.verify import verify


class Quick:
    """The engine `lm` and the grader, for one robot, detector, settings and kind of target."""

    def __init__(self, robot: Robot, settings: SolveSettings, detector: Detector | None, kind: str) -> None:
        problem = make_problem(robot, settings, detector=detector or "none", near=None, freeze=None)
        module, *tables = load_kernels(robot, detector, kind)
        self._solve, self._tables = module.solve_target, tables
        self._setup = make_ranges(problem), make_descent(problem), make_seeds(problem, kind)
        self._graded = pack_robot(robot), pack_detector(robot, detector)
        self._terms = pack_terms(robot, settings)
        self._no_score = np.full(2, np.inf)
        self._kind = np.array([KINDS.index(kind)])
        self._kind.setflags(write=False)
        self._pairs = robot.pairs(detector)
        self._attempts = np.array([0, min(FEW["lm"], settings.budget("lm"))])
        self._robot, self._settings, self._detector = robot, settings, detector or "none"
        self._common = {
            "reached": True,
            "stop_reason": StopReason.REACHED,
            "reason": reached_reason(detector),
            "hint": None,
            "joint_names": robot.joint_names,
            "self_collision": False,
            "verified": True,
            "method": "lm",
            "settings": settings,
            "detector": detector.name if detector else "none",
        }
        self._is_ready = False

    def solve(
        self, target: Target, seed: int, stream: int, announce_compile: Callable[[], None] | None
    ) -> SolveResult | None:
        """A graded solution, or None if this target needs another engine, more attempts, or a reason."""
        compile_seconds = 0.0
        if not self._is_ready:
            with compile_clock(announce_compile) as clock:
                self._try(target, seed, stream, 0.0)
            compile_seconds, self._is_ready = clock.seconds, True
        return self._try(target, seed, stream, compile_seconds)

    def _try(self, target: Target, seed: int, stream: int, compile_seconds: float) -> SolveResult | None:
        started = time.perf_counter()
        T_world_tool = np.empty((1, 3, 4))
        T_world_tool[0, :, :3], T_world_tool[0, :, 3] = target.R_world_tool, target.p_world_tool
        T_world_tool.setflags(write=False)  # as all targets are: for others numba would compile once more
        packed = TargetArrays(self._kind, T_world_tool)
        q, score = np.empty((1, len(self._robot.joints))), self._no_score.copy()
        counts = np.zeros(COUNTS, dtype=np.int64)
        blocked = np.zeros(len(self._pairs), dtype=np.int64)
        lane = (np.uint64(seed), stream, self._attempts, q[0], score, counts, blocked)
        self._solve(*self._tables, packed, 0, *self._setup, *lane)
        if not counts[REACHED]:
            return None
        seconds = time.perf_counter() - started
        figures, closest, accepted = np.empty((1, 3)), np.empty(1, dtype=np.int64), np.empty(1, dtype=np.bool_)
        compute_figures(*self._graded, packed, self._terms, q, figures, closest, accepted)
        if not accepted[0]:
            return None
        return self._make_result(
            target,
            q[0],
            figures[0].tolist(),
            int(closest[0]),
            counts.tolist(),
            blocked,
            seed=seed,
            stream=stream,
            solve_seconds=seconds,
            compile_seconds=compile_seconds,
        )

    def _make_result(
        self,
        target: Target,
        q: Floats,
        figures: list[float],
        closest: int,
        counts: list[int],
        blocked: Ints,
        **cost: Any,
    ) -> SolveResult:
        q.setflags(write=False)
        result = object.__new__(SolveResult)
        result.__dict__.update(  # a frozen dataclass sets its 26 fields one by one, which takes five times as long
            self._common,
            q=q,
            target=target,
            position_error_m=figures[POSITION_ERROR],
            orientation_error_rad=figures[ORIENTATION_ERROR],
            clearance_m=figures[CLEARANCE] if closest >= 0 else None,
            closest_pair=self._pairs[closest] if closest >= 0 else None,
            attempts=counts[ATTEMPTS],
            evaluations=counts[EVALUATIONS],
            rejected=counts[COLLIDING],
            blocking_pairs=count_blocking_pairs(self._pairs, blocked) if counts[COLLIDING] else {},
            verify=partial(verify, self._robot, target, q, settings=self._settings, detector=self._detector),
            **cost,
        )
        return result


@lru_cache(maxsize=64)
def find_quick(robot: Robot, settings: SolveSettings, detector: Detector | None, kind: str) -> Quick | None:
    """The quick way of a question, or None if it has none: it needs the engine `lm` to be the first to try."""
    engines = choose_engines(robot, settings, only_poses=kind == "pose")
    return Quick(robot, settings, detector, kind) if engines[0] == "lm" else None
