"""From targets to the best configuration of each: the one place that calls the search kernels."""

import os
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

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

    def row(self, index: int) -> "Found":
        """One target's share."""
        rows = slice(index, index + 1)
        return Found(q=self.q[rows], counts=self.counts[rows], pair_counts=self.pair_counts[rows])


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
    stop = threading.Event()

    def run(index: int) -> None:
        last = _last_attempt(problem, targets[index], first_attempt) if attempts is None else first_attempt + attempts
        # One call at least: with no attempts to make it is empty, and compiles or loads the kernel.
        for begin in range(first_attempt, max(last, first_attempt + 1), ATTEMPTS_PER_CALL):
            if stop.is_set() or counts[index, REACHED]:
                return
            block = np.array([begin, min(begin + ATTEMPTS_PER_CALL, last)])
            outputs = (q[index], score[index], counts[index], pair_counts[index])
            stream = np.int64(streams[index])
            with np.errstate(over="ignore"):  # the random stream wraps around; without the JIT numpy would warn
                solve_lane(robot, detector, packed, index, settings, np.uint64(seed), stream, block, *outputs)

    _on_threads(run, count, threads or usable_cores(), stop)
    return Found(q=q, counts=counts, pair_counts=pair_counts)


def _last_attempt(problem: Problem, target: Target, first_attempt: int) -> int:
    """Where to stop: a target that is proved out of reach only needs showing how close the tool can come."""
    excess = reach_excess_m(problem.robot, target.p_world_tool, problem.lower, problem.upper)
    if excess > problem.settings.position_tolerance_m:
        return first_attempt + min(OUT_OF_REACH_ATTEMPTS, problem.settings.restarts)
    return first_attempt + problem.settings.restarts


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
