"""From targets to the best configuration of each: the one place that calls the search kernels."""

import os
import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, fields

import numpy as np

from ikde.kernels.arrays import Floats, Ints
from ikde.kernels.lanes import COUNTS, REACHED, solve_lane
from ikde.model.pack import pack_detector, pack_robot, pack_targets
from ikde.model.reach import reach_excess_m
from ikde.model.target import Target
from ikde.solver.problem import ROUNDING, Problem, pack_search

ATTEMPTS_PER_CALL = 16  # Python hears Ctrl-C between calls
OUT_OF_REACH_ATTEMPTS = 4


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Found:
    """What the kernels found, a row a target."""

    q: Floats  # [T, N]
    counts: Ints  # [T, COUNTS]
    pair_counts: Ints  # [T, P]
    excess_m: Floats  # [T] how far out of reach each target provably is, beyond the tolerance; 0 if nobody knows
    seconds: Floats  # [T] wall time of each lane

    def row(self, index: int) -> "Found":
        """One target's share."""
        rows = slice(index, index + 1)
        return Found(**{field.name: getattr(self, field.name)[rows] for field in fields(self)})


def search(
    problem: Problem,
    targets: Sequence[Target],
    *,
    seed: int,
    streams: Sequence[int],
    first_attempt: int = 0,
    attempts: int | None = None,
    threads: int | None = None,
) -> Found:
    """Search every target until it is reached or the attempts are spent; one lane a target, on all cores.

    `attempts` defaults to the settings' restarts, or to a few for a target that is proved out of reach;
    0 searches nothing and only compiles or loads the kernel.

    The answer for a target hangs on (seed, stream, attempt) only: not on the other targets, the number of threads, or
    how the attempts are cut into calls.
    """
    robot, detector = pack_robot(problem.robot), pack_detector(problem.robot, problem.detector)
    detector = detector._replace(safe_distance=detector.safe_distance + ROUNDING)
    settings, packed, count = pack_search(problem), pack_targets(targets), len(targets)
    q, score = np.zeros((count, len(problem.robot.joints))), np.full((count, 2), np.inf)
    counts = np.zeros((count, COUNTS), dtype=np.int64)
    pair_counts = np.zeros((count, detector.pairs.shape[0]), dtype=np.int64)
    excess, seconds = _excess_m(problem, targets), np.zeros(count)
    stop = threading.Event()

    def run(index: int) -> None:
        last = first_attempt + (_budget(problem, excess[index]) if attempts is None else attempts)
        started = time.perf_counter()
        # One call at least: with no attempts to make it is empty, and compiles or loads the kernel.
        for begin in range(first_attempt, max(last, first_attempt + 1), ATTEMPTS_PER_CALL):
            if stop.is_set() or counts[index, REACHED]:
                return
            block = np.array([begin, min(begin + ATTEMPTS_PER_CALL, last)])
            outputs = (q[index], score[index], counts[index], pair_counts[index])
            stream = np.int64(streams[index])
            with np.errstate(over="ignore"):  # the random stream wraps around; without the JIT numpy would warn
                solve_lane(robot, detector, packed, index, settings, np.uint64(seed), stream, block, *outputs)
            seconds[index] = time.perf_counter() - started

    _on_threads(run, count, threads or usable_cores(), stop)
    return Found(q=q, counts=counts, pair_counts=pair_counts, excess_m=excess, seconds=seconds)


def _excess_m(problem: Problem, targets: Sequence[Target]) -> Floats:
    """How far each target provably is out of reach, where that is more than the tolerance."""
    positions = np.reshape([target.p_world_tool for target in targets], (-1, 3))
    excess = reach_excess_m(problem.robot, positions, problem.lower, problem.upper)
    return np.where(excess > problem.settings.position_tolerance_m, excess, 0.0)


def _budget(problem: Problem, excess_m: float) -> int:
    """Attempts to make: a target that is proved out of reach only needs showing how close the tool can come."""
    restarts = problem.settings.restarts
    return min(OUT_OF_REACH_ATTEMPTS, restarts) if excess_m > 0.0 else restarts


def usable_cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _on_threads(run: Callable[[int], None], count: int, threads: int, stop: threading.Event) -> None:
    """Call `run(0) .. run(count - 1)`; the kernels let go of Python's lock, so plain threads use all cores."""
    if count == 1 or threads == 1:
        for index in range(count):
            run(index)
        return
    with ThreadPoolExecutor(threads) as pool:
        try:
            for _ in pool.map(run, range(count)):
                pass
        except BaseException:
            stop.set()
            pool.shutdown(cancel_futures=True)
            raise
