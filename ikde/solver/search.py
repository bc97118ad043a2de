"""From targets to the best configuration of each: the one place that calls the search kernels."""

import threading
from collections.abc import Sequence
from dataclasses import dataclass

import numba
import numpy as np

from ikde.kernels.arrays import Floats, Ints
from ikde.kernels.figures import CLEARANCE, ORIENTATION_ERROR, POSITION_ERROR, compute_figures
from ikde.kernels.lanes import COUNTS, REACHED, solve_lane, solve_lanes
from ikde.model.pack import pack_detector, pack_robot, pack_targets
from ikde.model.target import Target
from ikde.solver.problem import Problem, pack_search
from ikde.solver.verify import Verification

ATTEMPTS_PER_CALL = 16  # Python hears Ctrl-C between calls
AGREEMENT = 1e-11  # m, rad: kernels and `verify` must agree to this

_threads_lock = threading.Lock()  # numba's simplest threading layer must not be entered twice at once


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Found:
    """What the kernels found, a row a target."""

    q: Floats  # [T, N]
    counts: Ints  # [T, COUNTS]
    pair_counts: Ints  # [T, P]


def search(
    problem: Problem,
    targets: Sequence[Target],
    *,
    seed: int,
    streams: Sequence[int],
    first_attempt: int = 0,
    threads: int | None = None,
) -> Found:
    """Search every target until it is reached or the restarts are spent.

    The answer for a target hangs on (seed, stream, attempt) only: not on the other targets, the number of threads, or
    how the attempts are cut into calls.
    """
    robot, detector = pack_robot(problem.robot), pack_detector(problem.robot, problem.detector)
    settings, packed, count = pack_search(problem), pack_targets(list(targets)), len(targets)
    lanes = np.array(streams, dtype=np.int64)
    q, score = np.zeros((count, robot.lower.size)), np.full((count, 2), np.inf)
    counts = np.zeros((count, COUNTS), dtype=np.int64)
    pair_counts = np.zeros((count, detector.pair_a.size), dtype=np.int64)
    attempts = np.zeros((count, 2), dtype=np.int64)
    last = first_attempt + problem.settings.restarts
    for begin in range(first_attempt, last, ATTEMPTS_PER_CALL):
        open_targets = counts[:, REACHED] == 0
        if not open_targets.any():
            break
        end = min(begin + ATTEMPTS_PER_CALL, last)
        attempts[:] = np.where(open_targets[:, None], [begin, end], [0, 0])
        common = (robot, detector, packed)
        if count == 1:
            solve_lane(
                *common, 0, settings, np.uint64(seed), lanes[0], attempts[0], q[0], score[0], counts[0], pair_counts[0]
            )
            continue
        with _threads_lock, _thread_count(threads):
            solve_lanes(*common, settings, np.uint64(seed), lanes, attempts, q, score, counts, pair_counts)
    return Found(q=q, counts=counts, pair_counts=pair_counts)


class _thread_count:  # noqa: N801 - a context manager reads as a verb
    """Use `threads` threads inside the block; None leaves numba's choice."""

    def __init__(self, threads: int | None) -> None:
        self.wanted = threads

    def __enter__(self) -> None:
        self.before = numba.get_num_threads()
        if self.wanted is not None:
            numba.set_num_threads(min(self.wanted, numba.config.NUMBA_NUM_THREADS))  # type: ignore[attr-defined]

    def __exit__(self, *_: object) -> None:
        numba.set_num_threads(self.before)


def disagreement(problem: Problem, target: Target, q: Floats, graded: Verification) -> float:
    """Largest gap between the kernels' figures and `verify`'s on the same `q`, in m or rad."""
    figures = np.empty(3)
    robot, detector = pack_robot(problem.robot), pack_detector(problem.robot, problem.detector)
    compute_figures(robot, detector, pack_targets([target]), 0, q, figures)
    gaps = [
        abs(figures[POSITION_ERROR] - graded.position_error_m),
        abs(figures[ORIENTATION_ERROR] - graded.orientation_error_rad),
    ]
    if graded.clearance_m is not None:
        gaps.append(abs(figures[CLEARANCE] - graded.clearance_m))
    return float(max(gaps))
