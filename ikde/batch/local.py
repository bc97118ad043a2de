"""Parts solved on this machine: spans of parts side by side, each on a thread of its own, given back in order.

What a part costs beside its search is mostly Python, numpy and arrow on thousands of rows; a part a thread shares that
out too. The kernels and arrow let go of Python's lock. Whoever takes the parts writes them while the next are solved.
"""

import threading
import time
from collections import deque
from collections.abc import Callable, Generator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace

from ikde.batch.finish import FinishedPart, finish_parts
from ikde.batch.parts import Part
from ikde.batch.plan import Batch
from ikde.batch.task import make_task, solve_task
from ikde.solver.cancellation import stoppable
from ikde.solver.engine_table import SEVERAL
from ikde.solver.search import usable_cores

AHEAD = 1  # spans that may wait to be written, beyond one a thread: memory stays flat
SPAN_SECONDS = 0.2  # parts that take less are solved together: plain numpy's sample costs 2.7 ms, of 50 rows or of 300
SPAN_SOLVES, SPAN_PARTS = 20_000, 16  # at most, for memory's sake and for open files'
SHARES = 8  # spans that are left at least for each thread, while there are parts: the last end together


def solve_parts(batch: Batch, parts: Sequence[Part], threads: int | None = None) -> Generator[list[FinishedPart]]:
    """Solve parts and give them back, in order, those together that were solved together.

    The answers depend neither on `threads` (None: all cores) nor on what is solved together.
    """
    threads, recipe = threads or usable_cores(), batch.hash
    spans = Spans(parts, threads)

    def solve(span: list[Part], inside: int) -> list[FinishedPart]:
        whole, started = replace(span[0], last=span[-1].last), time.perf_counter()
        finished = finish_parts(batch, solve_task(make_task(batch, whole), inside), span, recipe)
        spans.took(whole, time.perf_counter() - started)
        return finished

    if len(parts) <= 1:
        yield from (solve([part], threads) for part in parts)
        return
    if threads > 1:
        for part in {part.arm: part for part in reversed(parts)}.values():
            _warm_up(batch, part)
    yield from _solve_side_by_side(solve, spans, threads)


class Spans:
    """Takes parts from a list, as many consecutive ones of an arm at a time as are soon solved."""

    def __init__(self, parts: Sequence[Part], threads: int) -> None:
        self._left, self._threads = deque(parts), threads
        self._seconds: dict[str, float] = {}  # a solve, of each arm, as its last span took

    @property
    def left(self) -> int:
        """Parts that no thread has taken."""
        return len(self._left)

    def take(self) -> list[Part]:
        """The next parts: one of an arm of which it is not known how long it takes."""
        span = [self._left.popleft()]
        seconds = self._seconds.get(span[0].arm, SPAN_SECONDS)
        solves, most = min(SPAN_SOLVES, SPAN_SECONDS / seconds), min(SPAN_PARTS, self.left // (SHARES * self._threads))
        while len(span) < most and self._goes_on(span) and self._left[0].last - span[0].first <= solves:
            span.append(self._left.popleft())
        return span

    def took(self, span: Part, seconds: float) -> None:
        """Remember how long a span took."""
        self._seconds[span.arm] = seconds / span.rows

    def _goes_on(self, span: list[Part]) -> bool:
        """The next part is that after the last one: finished ones may lie between."""
        return bool(self._left) and (self._left[0].arm, self._left[0].first) == (span[-1].arm, span[-1].last)


def _warm_up(batch: Batch, part: Part) -> None:
    """Solve a few targets of an arm, so that kernels are compiled or loaded once."""
    task = make_task(batch, replace(part, last=min(part.last, part.first + SEVERAL)))
    once = replace(task.arm, problem=task.arm.problem.with_settings(restarts=1))
    solve_task(replace(task, arm=once, explain=False), 1)


def _solve_side_by_side(
    solve_span: Callable[[list[Part], int], list[FinishedPart]], spans: Spans, threads: int
) -> Generator[list[FinishedPart]]:
    stop, flying = threading.Event(), deque[Future[list[FinishedPart]]]()

    def solve(span: list[Part], inside: int) -> list[FinishedPart]:
        with stoppable(stop):
            return solve_span(span, inside)

    pool = ThreadPoolExecutor(threads)
    try:
        while spans.left or flying:
            while spans.left and len(flying) < threads + AHEAD:
                inside = max(1, threads // spans.left)  # the last few parts would leave threads idle
                flying.append(pool.submit(solve, spans.take(), inside))
            yield flying.popleft().result()
    finally:
        stop.set()  # nothing is under way, unless it was interrupted
        pool.shutdown(cancel_futures=True)
