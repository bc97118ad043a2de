"""From targets to the best configuration of each: engine after engine, on all cores, until a target is reached."""

import os
import threading
import time
from collections import deque
from collections.abc import Callable, Sequence
from importlib import import_module

import numpy as np

from ikde.kernels.arrays import ATTEMPTS, COLLIDING, REACHED, Ints
from ikde.model.target import KINDS, Target, Targets
from ikde.solver.cancellation import get_cancel_check
from ikde.solver.choice import Budgets, choose_budgets
from ikde.solver.engine_table import ENGINES, NAMES
from ikde.solver.engines.engine import Engine, SearchInputs
from ikde.solver.engines.search_state import SearchState, make_search_state
from ikde.solver.few import answer_few
from ikde.solver.fixed import grade_fixed
from ikde.solver.problem import Problem
from ikde.solver.proof import prove_many, rule_out
from ikde.solver.referee import Referee

REFUSALS = 16  # of one row by the grader, before the next engine takes over
PIECE = 2**17  # targets: so many are finished before the next are begun, which bounds what is not kept
PARTS = 16  # of a piece on each thread: their ends, where lanes run empty, cost little, and no thread waits long
MIN_TARGETS = 512  # targets of a part that are worth a thread


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
    targets, few = Targets.of(targets), None
    if problem.is_fixed:
        found = make_search_state(problem, len(targets))
        grade_fixed(problem, targets, found)
        return found
    if attempts is None and first_attempt == 0:
        few = answer_few(problem, targets, seed=seed, streams=streams)
        if few is not None and few.is_settled:
            few.pair_counts.keep(0, few.counts[:, COLLIDING].nonzero()[0])
            few.pair_counts.drop_filled()
            return few
    found = make_search_state(problem, len(targets), PIECE)
    budgets = choose_budgets(problem, _kinds(targets), attempts)
    found.engine[:] = NAMES.index(budgets[0][0])  # also of rows that no engine has time for
    if few is not None:
        found.put(few)
    whole = len(targets) <= PIECE
    for first in range(0, max(len(targets), 1), PIECE):
        rows = slice(first, first + PIECE)
        some, part = (targets, found) if whole else (targets[rows], found.piece(rows))
        inputs = SearchInputs(problem, some, part, seed=seed, streams=streams[rows])
        referee = Referee(problem, some, part, is_graded=few is not None)
        _search_piece(inputs, referee, budgets, (first_attempt, attempts), threads or usable_cores(), spent_s)
        found.pair_counts.keep(first, part.counts[:, COLLIDING].nonzero()[0])
    found.pair_counts.drop_filled()
    return found


def _search_piece(
    inputs: SearchInputs,
    referee: Referee,
    budgets: Budgets,
    cut: tuple[int, int | None],
    threads: int,
    spent_s: float,
) -> None:
    """Search some targets, engine after engine; `cut`: the first attempt, and how many if that is asked for."""
    problem, targets, found = inputs.problem, referee.targets, inputs.found
    first_attempt, attempts = cut
    left_s = np.inf if problem.settings.timeout_s is None else problem.settings.timeout_s - spent_s
    for place, (name, budget) in enumerate(budgets):
        rows = ((found.counts[:, REACHED] == 0) & ~found.is_excluded() & (found.seconds < left_s)).nonzero()[0]
        if not len(rows):
            break
        before = found.score[rows] if place else None
        spent = found.counts[:, ATTEMPTS] - first_attempt
        lanes = _Lanes(make_engine(name, inputs), referee, threads, left_s)
        few = min(ENGINES[name].attempts_before_proof, budget)
        lanes.run(first_attempt, np.full(len(targets), first_attempt + few))
        is_done = bool(found.metrics.accepted.all() and found.counts[:, REACHED].all())  # mostly
        if not is_done:
            if attempts is None and not (ENGINES[name].is_closed_form and name != budgets[-1][0]):
                _exclude(problem, targets, found)
            lanes.run(first_attempt + few, np.full(len(targets), first_attempt + budget))
            _go_on(lanes, referee, found, spent, first_attempt + budget)
        if before is not None:
            found.engine[rows[(found.score[rows] != before).any(axis=1)]] = NAMES.index(name)
        if is_done:
            return
    referee.refuse()  # also what no engine had time for has metrics


def _kinds(targets: Targets) -> tuple[str, ...]:
    """The kinds of target there are."""
    return tuple(KINDS[kind] for kind, count in enumerate(np.bincount(targets.kind).tolist()) if count)


def make_engine(name: str, inputs: SearchInputs) -> Engine:
    """An engine by name; each brings its kernels along, so only the one that is needed is imported."""
    module, maker = ENGINES[name].maker.split(":")
    return getattr(import_module(f"ikde.solver.engines.{module}"), maker)(inputs)


def _exclude(problem: Problem, targets: Targets, found: SearchState) -> None:
    """Find out which of the unreached targets are out of reach, or have no solution for another reason."""
    rows = np.flatnonzero(found.counts[:, REACHED] == 0)
    if len(rows):
        found.excess_m[rows], found.excess_rad[rows] = prove_many(problem, targets.take(rows))
        rows = rows[~found.is_excluded()[rows]]
        found.ruled_out[rows] = rule_out(problem, targets.take(rows))


class _Lanes:
    """One engine on all rows, part by part, each until its time `left_s` is up; it may go on where it stopped."""

    def __init__(self, engine: Engine, referee: Referee, threads: int, left_s: float) -> None:
        self._engine, self._referee, self._threads, self._left_s = engine, referee, threads, left_s
        self._found, count = referee.found, len(referee.found.q)
        if left_s < np.inf:
            _hurry(engine, count)

    def run(self, first: int, last: Ints) -> None:
        """Make attempts `first` .. `last` [T] - 1 of the rows that are not reached yet; grade what they lead to."""
        stop, check_cancelled, reached = threading.Event(), get_cancel_check(), self._found.counts[:, REACHED]
        open_rows = (reached == 0) & ~self._found.is_excluded() & (last > first)
        if not open_rows.any():
            return
        last = np.where(open_rows, last, first)
        if not self._engine.is_ready:  # no attempts: what is needed is compiled or loaded, and no clock counts it
            self._engine.call(range(1), 0, np.zeros(len(last), dtype=np.int64))

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
            self._referee.grade(inside)

        parts = _cut(open_rows.nonzero()[0], self._engine.rows_per_call, self._threads)
        run_on_threads(run, parts, self._threads, stop)


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


def _cut(rows: Ints, most: int, threads: int) -> list[range]:
    """Open rows in parts of at most `most`, each a range that may hold others."""
    size = min(most, max(MIN_TARGETS, len(rows) // (PARTS * threads)))
    parts = (rows[first : first + size] for first in range(0, len(rows), size))
    return [range(int(part[0]), int(part[-1]) + 1) for part in parts]


def usable_cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _wait(threads: Sequence[threading.Thread], stop: threading.Event) -> None:
    """Until all have ended: what interrupts this, Ctrl-C above all, makes them end soon."""
    try:
        for thread in threads:
            thread.join()
    except BaseException:
        stop.set()
        for thread in threads:
            thread.join()
        raise


def run_on_threads(run: Callable[[range], None], parts: Sequence[range], threads: int, stop: threading.Event) -> None:
    """Call `run` for every part, on this thread and others; the kernels let go of Python's lock, so all cores work.

    Whatever is raised sets `stop` and is raised here, when no thread works any more.
    """
    waiting, raised = deque(parts), []

    def work() -> None:
        try:
            while not stop.is_set():
                try:
                    part = waiting.popleft()
                except IndexError:  # none is left
                    return
                run(part)
        except BaseException as error:
            raised.append(error)
            stop.set()

    others = [threading.Thread(target=work) for _ in range(min(threads, len(parts)) - 1)]
    try:
        for thread in others:
            thread.start()
        work()
    finally:
        _wait(others, stop)
    if raised:
        raise raised[0]
