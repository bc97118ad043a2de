"""Parts solved on this machine: whole parts side by side, each on a thread of its own, given back in order.

What a part costs beside its search is mostly Python, numpy and arrow on thousands of rows; a part a thread shares that
out too. The kernels and arrow let go of Python's lock.
"""

import threading
from collections import deque
from collections.abc import Callable, Generator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace

from ikde.batch.parts import Part, SealedPart, seal_part
from ikde.batch.plan import Batch
from ikde.batch.task import make_task, solve_task
from ikde.solver.cancellation import stoppable
from ikde.solver.engine_table import SEVERAL
from ikde.solver.search import usable_cores

AHEAD = 1  # parts that may wait to be written, beyond one a thread: memory stays flat


def solve_parts(batch: Batch, parts: Sequence[Part], threads: int | None = None) -> Generator[SealedPart]:
    """Solve parts and give them back sealed, in order. The answers do not depend on `threads` (None: all cores)."""
    threads, recipe = threads or usable_cores(), batch.hash

    def solve(part: Part, inside: int) -> SealedPart:
        answer = solve_task(make_task(batch, part), inside)
        return seal_part(part, answer.solutions, answer.timing, recipe=recipe)

    if threads == 1 or len(parts) <= 1:
        yield from (solve(part, threads) for part in parts)
        return
    for part in {part.arm: part for part in reversed(parts)}.values():
        _warm_up(batch, part)
    yield from _solve_side_by_side(solve, parts, threads)


def _warm_up(batch: Batch, part: Part) -> None:
    """Solve a few targets of an arm, so that kernels are compiled or loaded once."""
    task = make_task(batch, replace(part, last=min(part.last, part.first + SEVERAL)))
    once = replace(task.arm, problem=task.arm.problem.with_settings(restarts=1))
    solve_task(replace(task, arm=once, explain=False), 1)


def _solve_side_by_side(
    solve_part: Callable[[Part, int], SealedPart], parts: Sequence[Part], threads: int
) -> Generator[SealedPart]:
    stop, flying, begun = threading.Event(), deque[Future[SealedPart]](), 0

    def solve(part: Part, inside: int) -> SealedPart:
        with stoppable(stop):
            return solve_part(part, inside)

    pool = ThreadPoolExecutor(threads)
    try:
        while begun < len(parts) or flying:
            while begun < len(parts) and len(flying) < threads + AHEAD:
                inside = max(1, threads // (len(parts) - begun))  # the last few parts would leave threads idle
                flying.append(pool.submit(solve, parts[begun], inside))
                begun += 1
            yield flying.popleft().result()
    finally:
        stop.set()  # nothing is under way, unless it was interrupted
        pool.shutdown(cancel_futures=True)
