"""From targets to the best configuration of each: engine after engine, on all cores, until a target is reached."""

import os
import threading
import time
from collections.abc import Callable, Sequence
from importlib import import_module

import numpy as np
from numpy.typing import NDArray

from ikde.kernels.arrays import ATTEMPTS, REACHED, Floats, Ints
from ikde.model.closed_form import find_still_arm, find_ur_arm
from ikde.model.robot import Robot
from ikde.model.target import KINDS, Target, Targets
from ikde.solver.branches import rule_out
from ikde.solver.cancellation import get_cancel_check
from ikde.solver.engine_table import AUTO, ENGINES, NAMES
from ikde.solver.engines.engine import Engine, SearchInputs
from ikde.solver.engines.search_state import SearchState, make_search_state
from ikde.solver.fixed import look
from ikde.solver.problem import Problem
from ikde.solver.proof import prove_many
from ikde.solver.referee import Referee
from ikde.solver.settings import SolveSettings

REFUSALS = 16  # of one row by the grader, before the next engine takes over


def search(
    problem: Problem,
    targets: Targets | Sequence[Target],
    *,
    seed: int,
    streams: Sequence[int],
    first_attempt: int = 0,
    attempts: int | None = None,
    threads: int | None = None,
    spent_s: float = 0.0,
) -> SearchState:
    """Search every target until it is reached or the attempts are spent; one lane a target, on all cores.

    Reached is what an engine and the grader accept: a refused row goes on with its next attempt, then the next engine.

    `attempts` defaults to the settings' restarts, or to a few for a target that is proved out of reach. `spent_s`: what
    is gone of each target's time, if the settings have a timeout.

    The answer for a target depends on (seed, stream, attempt) only: not on the other targets, the number of threads, or
    how the attempts are cut into calls; with a timeout also on the clock.
    """
    targets = Targets.of(targets)
    found = make_search_state(problem, len(targets))
    if problem.is_fixed:
        look(problem, targets, found)
        return found
    referee = Referee(problem, targets, found)
    left_s = np.inf if problem.settings.timeout_s is None else problem.settings.timeout_s - spent_s
    inputs = SearchInputs(problem, targets, found, seed=seed, streams=streams)
    plan = _plan(problem, inputs, attempts)
    found.engine[:] = NAMES.index(plan[0][0])  # also of rows that no engine has time for
    for name, budget in plan:
        rows = np.flatnonzero((found.counts[:, REACHED] == 0) & ~found.is_excluded() & (found.seconds < left_s))
        if not len(rows):
            break
        before, spent = found.score[rows].copy(), found.counts[:, ATTEMPTS] - first_attempt
        lanes = _Lanes(make_engine(name, inputs), found, threads or usable_cores(), left_s)
        few = min(ENGINES[name].attempts_before_proof, budget)
        lanes.run(first_attempt, np.full(len(targets), first_attempt + few))
        if attempts is None and not (ENGINES[name].is_closed_form and name != plan[-1][0]):
            _exclude(problem, targets, found)
        lanes.run(first_attempt + few, np.full(len(targets), first_attempt + budget))
        _go_on(lanes, referee, found, spent, first_attempt + budget)
        found.engine[rows[(found.score[rows] != before).any(axis=1)]] = NAMES.index(name)
    referee.refuse()  # also what no engine had time for has metrics
    return found


def make_engine(name: str, inputs: SearchInputs) -> Engine:
    """An engine by name; each brings its kernels along, so only the one that is needed is imported."""
    module, maker = ENGINES[name].maker.split(":")
    return getattr(import_module(f"ikde.solver.engines.{module}"), maker)(inputs)


def choose_engines(
    robot: Robot,
    settings: SolveSettings,
    kinds: set[str],
    *,
    inside: bool = True,
    free: set[int] | None = None,
    is_plain: bool = True,
) -> list[str]:
    """Engines in the order in which they try; the later ones take over what the first leaves.

    `kinds` of the targets. `inside`: the joint ranges are within the limits. `free`: the joints that may move; by
    default those that the limits leave free. `is_plain`: `Problem.is_plain`; what is not is asked of `lm` first, which
    takes ranges, weights and what to stay near to of each call's own in microseconds.
    """
    if not inside:
        return [name for name in settings.engines if not ENGINES[name].stays_in_limits] or [AUTO[-1]]
    if len(settings.engines) == 1:
        return [*settings.engines]
    arm, free = find_ur_arm(robot), find_free(robot.lower, robot.upper) if free is None else free
    is_closed = arm is not None and free == set(arm.coordinates)
    rows = {name: ENGINES[name] for name in settings.engines}
    names = [n for n, row in rows.items() if kinds <= {*row.target_kinds} and (is_closed or not row.is_closed_form)]
    return names if is_plain else sorted(names, key=NAMES.index)


def find_free(lower: Floats, upper: Floats) -> set[int]:
    """Joints that may move: all but those that are frozen."""
    return set(np.flatnonzero(upper > lower).tolist())


def _plan(problem: Problem, inputs: SearchInputs, attempts: int | None) -> list[tuple[str, int]]:
    """Engines, each with its attempts; an arm on a base that cannot move has shown all its branches after one."""
    robot, settings = problem.robot, problem.settings
    inside = bool((problem.lower >= robot.lower).all() and (problem.upper <= robot.upper).all())
    kinds = {KINDS[kind] for kind in np.unique(inputs.targets.kind).tolist()}
    free = find_free(problem.lower, problem.upper)
    names = choose_engines(robot, settings, kinds, inside=inside, free=free, is_plain=problem.is_plain)
    stands_still = find_still_arm(robot, problem.lower, problem.upper) is not None

    def budget(name: str) -> int:
        if stands_still and ENGINES[name].is_closed_form:
            return 1
        before_next = ENGINES[name].attempts_before_next if name != names[-1] else None
        return attempts or before_next or settings.budget(name)

    return [(name, budget(name)) for name in names]


def _exclude(problem: Problem, targets: Targets, found: SearchState) -> None:
    """Find out which of the unreached targets are out of reach, or reached by no branch of the closed form."""
    rows = np.flatnonzero(found.counts[:, REACHED] == 0)
    if len(rows):
        found.excess_m[rows], found.excess_rad[rows] = prove_many(problem, targets.take(rows))
        rows = rows[~found.is_excluded()[rows]]
        found.ruled_out[rows] = rule_out(problem, targets.take(rows))


class _Lanes:
    """One engine on all rows, piece by piece, each until its time `left_s` is up; it may go on where it stopped."""

    def __init__(self, engine: Engine, found: SearchState, threads: int, left_s: float) -> None:
        self._engine, self._found, self._threads, self._left_s = engine, found, threads, left_s
        count = len(found.q)
        if left_s < np.inf:
            _hurry(engine, count)
        # No attempts at all: what `run` needs is compiled or loaded, and no clock counts it.
        engine.call(range(min(count, 1)), 0, np.zeros(count, dtype=np.int64))

    def run(self, first: int, last: Ints) -> None:
        """Make attempts `first` .. `last` [T] - 1 of the rows that are not reached yet."""
        stop, check_cancelled, reached = threading.Event(), get_cancel_check(), self._found.counts[:, REACHED]
        open_rows = (reached == 0) & ~self._found.is_excluded() & (last > first)
        last = np.where(open_rows, last, first)
        pieces = _cut(open_rows, self._engine.rows_per_call)

        def run(rows: range) -> None:
            inside = slice(rows.start, rows.stop)
            wanted, seconds = last[inside], self._found.seconds[inside]
            for begin in range(first, int(wanted.max()), self._engine.attempts_per_call):
                searched = (reached[inside] == 0) & (wanted > begin) & (seconds < self._left_s)
                if stop.is_set() or not searched.any():
                    break
                check_cancelled()
                wanted[~searched] = first
                started = time.perf_counter()
                self._engine.call(rows, begin, last)
                seconds[searched] += (time.perf_counter() - started) / np.count_nonzero(searched)

        _on_threads(run, pieces, self._threads, stop)


def _go_on(lanes: _Lanes, referee: Referee, found: SearchState, spent: Ints, last_attempt: int) -> None:
    """Go on with rows that the grader refuses, each with its next attempt; `spent` [T]: those of other engines."""
    refused = referee.refuse()
    for _ in range(REFUSALS):
        if not len(refused):
            break
        begin = found.counts[refused, ATTEMPTS] - spent[refused]
        for first in np.unique(begin).tolist():
            last = np.zeros(len(spent), dtype=np.int64)
            last[refused[begin == first]] = last_attempt
            lanes.run(first, last)
        refused = referee.refuse()


def _hurry(engine: Engine, count: int) -> None:
    """Cut the calls for `count` rows so short that the clock is checked often."""
    attempts = ENGINES[engine.name].attempts_between_clocks
    engine.rows_per_call = size = min(engine.rows_per_call, attempts)
    engine.attempts_per_call = min(engine.attempts_per_call, max(1, attempts // min(size, count)))


def _cut(open_rows: NDArray[np.bool_], size: int) -> list[range]:
    """All rows in pieces of `size`, without pieces that hold no open row."""
    firsts = np.unique(np.flatnonzero(open_rows) // size) * size
    return [range(first, min(first + size, len(open_rows))) for first in firsts.tolist()]


def usable_cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _on_threads(run: Callable[[range], None], pieces: Sequence[range], threads: int, stop: threading.Event) -> None:
    """Call `run` for every piece; the kernels let go of Python's lock, so plain threads use all cores."""
    if len(pieces) <= 1 or threads == 1:
        for piece in pieces:
            run(piece)
        return
    from concurrent.futures import ThreadPoolExecutor  # 0.01 s, which one target need not pay

    with ThreadPoolExecutor(threads) as pool:
        try:
            for _ in pool.map(run, pieces):
                pass
        except BaseException:
            stop.set()
            pool.shutdown(cancel_futures=True)
            raise
