"""From targets to the best configuration of each: the one place that calls the search kernels."""

import os
import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, fields

import numpy as np

from ikde.kernels.arrays import Floats, Ints
from ikde.kernels.lanes import COUNTS, REACHED, solve_lanes
from ikde.model.pack import pack_detector, pack_robot, pack_targets
from ikde.model.reach import reach_excess_m
from ikde.model.target import Target
from ikde.solver.problem import ROUNDING, Problem, pack_search

ATTEMPTS_PER_CALL = 16  # Python hears Ctrl-C between calls
EVALUATIONS_PER_CALL = 20_000  # some 20 ms: searches that are shorter share a call, up to
LANES_PER_CALL = 64
OUT_OF_REACH_ATTEMPTS = 4


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Found:
    """What the kernels found, a row a target."""

    q: Floats  # [T, N]
    counts: Ints  # [T, COUNTS]
    pair_counts: Ints  # [T, P]
    excess_m: Floats  # [T] how far out of reach each target provably is, beyond the tolerance; 0 if nobody knows
    seconds: Floats  # [T] wall time of each lane; short searches that share a call share its time evenly

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
    last = first_attempt + (_budgets(problem, excess) if attempts is None else np.full(count, attempts))
    lane_streams, stop = np.array(streams, dtype=np.int64), threading.Event()

    def run(lanes: range) -> None:
        rows = slice(lanes.start, lanes.stop)
        started = time.perf_counter()
        # One call at least: with no attempts to make it is empty, and compiles or loads the kernel.
        for begin in range(first_attempt, max(int(last[rows].max()), first_attempt + 1), ATTEMPTS_PER_CALL):
            if stop.is_set() or counts[rows, REACHED].all():
                break
            where, block = np.array([lanes.start, lanes.stop]), np.array([begin, begin + ATTEMPTS_PER_CALL])
            with np.errstate(over="ignore"):  # the random stream wraps around; without the JIT numpy would warn
                solve_lanes(
                    *(robot, detector, packed, where, settings, np.uint64(seed), lane_streams, block, last),
                    *(q, score, counts, pair_counts),
                )
        seconds[rows] = (time.perf_counter() - started) / len(lanes)

    _on_threads(run, _cut(count, _lanes_per_call(problem)), threads or usable_cores(), stop)
    return Found(q=q, counts=counts, pair_counts=pair_counts, excess_m=excess, seconds=seconds)


def _lanes_per_call(problem: Problem) -> int:
    """How many lanes share a call: one, unless the search is very short."""
    settings = problem.settings
    evaluations = settings.population * (settings.generations + 1) * min(settings.restarts, ATTEMPTS_PER_CALL)
    return int(np.clip(EVALUATIONS_PER_CALL // evaluations, 1, LANES_PER_CALL))


def _cut(count: int, size: int) -> list[range]:
    """0 .. count - 1 in pieces of `size`."""
    return [range(first, min(first + size, count)) for first in range(0, count, size)]


def _excess_m(problem: Problem, targets: Sequence[Target]) -> Floats:
    """How far each target provably is out of reach, where that is more than the tolerance."""
    positions = np.reshape([target.p_world_tool for target in targets], (-1, 3))
    excess = reach_excess_m(problem.robot, positions, problem.lower, problem.upper)
    return np.where(excess > problem.settings.position_tolerance_m, excess, 0.0)


def _budgets(problem: Problem, excess_m: Floats) -> Ints:
    """Attempts to make: a target that is proved out of reach only needs showing how close the tool can come."""
    restarts = problem.settings.restarts
    return np.where(excess_m > 0.0, min(OUT_OF_REACH_ATTEMPTS, restarts), restarts)


def usable_cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _on_threads(run: Callable[[range], None], pieces: Sequence[range], threads: int, stop: threading.Event) -> None:
    """Call `run` for every piece; the kernels let go of Python's lock, so plain threads use all cores."""
    if len(pieces) == 1 or threads == 1:
        for piece in pieces:
            run(piece)
        return
    with ThreadPoolExecutor(threads) as pool:
        try:
            for _ in pool.map(run, pieces):
                pass
        except BaseException:
            stop.set()
            pool.shutdown(cancel_futures=True)
            raise
