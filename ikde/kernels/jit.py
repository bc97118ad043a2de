"""One numba set-up for every kernel: cached on disk, strict IEEE arithmetic, compile time on the record.

Two facts shape this file:

* numba does not notice an edited callee in another file, so the cache folder carries a hash of all kernels;
* `fastmath` stays off: it moved the last bit and bought nothing (168 against 166 us for 90 candidates).
"""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, TypeVar

import numba
from numba.core import event

from ikde.kernels import cache_folder
from ikde.kernels.machine_code import MachineCode, hash_source

F = TypeVar("F", bound=Callable[..., Any])


def kernel(function: F) -> F:
    """Compile `function` on its first call and keep the machine code on disk. It runs without Python's lock."""
    return _compile(function, nogil=True)


def leaf_kernel(function: F) -> F:
    """Like `kernel`, for what allocates nothing: numba then counts no references to the arrays that it is given.

    Counting them costs atomic instructions at every branch: a seed took 0.60 us with them and 0.23 us without.
    """
    return _compile(function, nogil=True, _nrt=False)


def inline_kernel(function: F) -> F:
    """Like `leaf_kernel`, but pasted into its callers: passing the packed arrays costs more than most kernels do.

    Measured on qiao2021: 0.97 against 4.6 us for one trial of the differential evolution.
    """
    return _compile(function, forceinline=True, _nrt=False)


def inline_view_kernel(function: F) -> F:
    """Like `inline_kernel`, for what gives back views of its arrays: references are counted (1.95 us for 2.07)."""
    return _compile(function, forceinline=True)


def _compile(function: F, **options: Any) -> F:
    """Machine code is kept for what stands in a file, and without a compiler there is none."""
    compiled: Any = numba.njit(error_model="numpy", **options)(function)
    source = hash_source(function.__code__.co_filename) if cache_folder.CACHE_IS_WRITABLE else None
    if source and not function.__closure__ and compiled is not function:
        compiled._cache = MachineCode(function, source, cache_folder.CACHE_FOLDER / cache_folder.MACHINE_CODE)
    return compiled


class CompileClock(event.Listener):
    """Adds up the seconds that numba spends compiling, on any thread; loading from the cache does not count.

    `announce` is called once, when the first compilation begins.
    """

    def __init__(self, announce: Callable[[], None] | None = None) -> None:
        self.seconds = 0.0
        self._announce = announce
        self._depth = 0
        self._started = 0.0
        self._made = time.perf_counter()

    @property
    def run_seconds(self) -> float:
        """Wall time since the clock was made, without compiling."""
        return time.perf_counter() - self._made - self.seconds

    def on_start(self, event: Any) -> None:
        """Start the clock at the outermost compilation: callees compile inside their callers."""
        if self._depth == 0:
            self._started = time.perf_counter()
            if self._announce is not None:
                self._announce()
                self._announce = None
        self._depth += 1

    def on_end(self, event: Any) -> None:
        """Stop the clock when the outermost compilation ends."""
        self._depth -= 1
        if self._depth == 0:
            self.seconds += time.perf_counter() - self._started


@contextmanager
def compile_clock(announce: Callable[[], None] | None = None) -> Iterator[CompileClock]:
    """Measure the compile time spent inside the block, and call `announce` once if kernels must be compiled there."""
    clock = CompileClock(announce)
    with event.install_listener("numba:compile", clock):
        yield clock
