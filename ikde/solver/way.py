"""A kernel that answers one target, and when it is machine code."""

import time
from collections.abc import Callable
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from ikde.kernels.jit import Bound, Kernel
from ikde.kernels.least_motion import descend_row
from ikde.solver.background import Question, answers_plainly
from ikde.solver.compile_note import note_compile

Answer = Callable[..., bool]
"""`answer(T_world_tool, seed, stream, first, last, out)`: attempts `first` .. `last` - 1 and their grade, as
`lm.answer_target`."""
HALF_WORDS = 2**63


def as_word(seed: int) -> int:
    """A seed as numba takes it without another signature: the same 64 bits as a number with a sign."""
    return seed if seed < HALF_WORDS else seed - 2 * HALF_WORDS


class Found(NamedTuple):
    """What `WithDescent` is when its first arguments are there: a search, and the descent from what it finds."""

    search: Bound
    descent: Bound

    @property
    def is_kept(self) -> bool:
        """True if the machine code of both lies in the cache."""
        return self.search.is_kept and self.descent.is_kept

    def plain(self, T_world_tool: Any, *others: Any) -> bool:
        """The answer in plain Python."""
        self.search.plain(T_world_tool, *others)
        return self.descent.plain(T_world_tool, others[-1])


class WithDescent:
    """A search of one target, and behind it the descent to the least motion, as if they were one kernel.

    Before what stays of the search it takes `walk` (`kernels/least_motion.py`).
    """

    def __init__(self, search: Kernel) -> None:
        self._search = search

    @cached_property
    def compiled(self) -> Answer:
        """Machine code: 1 us more than one call of one kernel."""
        search, descend = self._search.compiled, descend_row.compiled

        def answer(walk: Any, numbers: Any, whole: Any, *others: Any) -> bool:
            search(numbers, whole, *others)
            return descend(numbers, whole, walk, others[-6], others[-1])

        return answer

    def bind(self, walk: Any, *search: Any) -> Found:
        """Both with their first arguments."""
        return Found(self._search.bind(*search), descend_row.bind(*search[:2], walk))


class Way:
    """A kernel that answers one target: in plain Python, until there is machine code."""

    def __init__(self, kernel: Kernel | WithDescent, question: Question) -> None:
        self._kernel, self._question = kernel, question
        self.machine: Answer | None = None
        self.waited_s, self.compile_s = 0.0, 0.0

    def begin(self, *arguments: Any) -> bool:
        """A call while machine code is not there, the one that waits for it, or a later part of that question."""
        if self.machine is not None:
            return self.machine(*arguments)
        *block, T_world_tool, seed, stream, first, last, row = arguments
        bound = self._kernel.bind(*block)
        if first > 0 or answers_plainly(bound, self._question):
            return bound.plain(T_world_tool, np.int64(seed), stream, first, last, row)
        started = time.perf_counter()
        with note_compile(self._question.describe) as clock:
            self._kernel.compiled(*arguments)
        self.machine = answer = self._kernel.compiled
        self.waited_s, self.compile_s = time.perf_counter() - started, clock.seconds
        return answer(*arguments)

    def take_waited_s(self) -> tuple[float, float]:
        """For how long machine code has been waited for since this was asked last, and how much of it was compiling."""
        waited, self.waited_s, self.compile_s = (self.waited_s, self.compile_s), 0.0, 0.0
        return waited
