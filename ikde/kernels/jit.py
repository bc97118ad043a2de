"""What makes a kernel of a function: machine code by numba when it is called, or the same function in plain Python.

numba and LLVM are imported when the first machine code is asked for, not before: that takes 0.2 s, and loading the code
as much again, where one target is solved in plain Python in two milliseconds. Both ways give the same bits.
`fastmath` stays off: it moved the last bit and bought nothing (168 against 166 us for 90 candidates).
"""

import os
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cached_property, lru_cache, partial, update_wrapper
from types import FunctionType
from typing import Any

import numpy as np

from ikde.kernels.cache_folder import is_kept

COMPILE = "IKDE_COMPILE"
"""Environment variable: `background`, `wait` or `never`."""


def never_compiles() -> bool:
    """True if all kernels are to run as plain Python."""
    return os.environ.get(COMPILE) == "never"


class Kernel:
    """A function with two ways to run it; numba takes it for the compiled one, wherever another kernel calls it."""

    def __init__(self, function: FunctionType, *, is_callee: bool = False, **options: Any) -> None:
        update_wrapper(self, function)
        self.py_func, self._is_callee, self._options = function, is_callee, options

    def __call__(self, *arguments: Any) -> Any:
        """Run machine code: compiled, or loaded, when it is needed first. Hot loops hold on to `compiled` itself."""
        return self.compiled(*arguments)

    @cached_property
    def compiled(self) -> Any:
        """A dispatcher of numba's; where nothing is compiled there is none, and it is `plain`."""
        compiled = self.py_func if never_compiles() else self._compile()
        return self.plain if compiled is self.py_func else compiled

    @cached_property
    def plain(self) -> FunctionType:
        """The function as Python runs it, and so are all kernels that it calls.

        Random streams wrap around, of which numpy's scalars would warn: it is called under `np.errstate`.
        """
        function = self.py_func
        space = _find_twin(function.__globals__)
        return FunctionType(function.__code__, space, function.__name__, function.__defaults__, function.__closure__)

    @property
    def _numba_type_(self) -> Any:
        return self._called._numba_type_

    @cached_property
    def _called(self) -> Any:
        """What other kernels call.

        Of small kernels it cannot be called from Python: to unbox all arrays that they take was a fifth of compiling.
        """
        return self._compile(no_cpython_wrapper=True) if self._is_callee else self.compiled

    def _compile(self, **options: bool) -> Any:
        return _load_compiler()(self.py_func, {**self._options, "no_cfunc_wrapper": True, **options})

    def bind(self, *arguments: Any) -> "Bound":
        """The kernel with its first arguments."""
        return Bound(self, arguments)


class Bound:
    """A kernel with its first arguments, still with two ways to run it."""

    def __init__(self, kernel: Kernel, arguments: tuple[Any, ...]) -> None:
        self._kernel, self._arguments = kernel, arguments

    @property
    def compiled(self) -> Callable[..., Any]:
        """Machine code; what it waits for, it waits for in its first call."""
        return partial(self._kernel.compiled, *self._arguments)

    def plain(self, *arguments: Any) -> Any:
        """The same in plain Python, without numpy's warnings of words that wrap around and of infinite numbers.

        Whole numbers are words of 64 bits, as machine code takes them.
        """
        words = (np.int64(value) if type(value) is int else value for value in arguments)
        with np.errstate(all="ignore"):
            return self._kernel.plain(*self._arguments, *words)

    @property
    def is_kept(self) -> bool:
        """True if its machine code lies in the cache, so that to load it takes 0.4 s, numba included."""
        return is_kept(self._kernel.py_func)


def kernel(function: Callable[..., Any]) -> Kernel:
    """Compile `function` on its first call and keep the machine code on disk. It runs without Python's lock."""
    return _make(function, nogil=True)


def counting_kernel(function: Callable[..., Any]) -> Kernel:
    """Like `kernel`, for what allocates or cuts views and is called by kernels that count no references.

    numba hands that down to callees: views would be counted by one side only.
    """
    return _make(function, nogil=True, _nrt=True)


def leaf_kernel(function: Callable[..., Any]) -> Kernel:
    """Like `kernel`, for what allocates nothing: numba then counts no references to the arrays that it is given.

    Counting them costs atomic instructions at every branch: a seed took 0.60 us with them and 0.23 us without.
    """
    return _make(function, is_callee=True, nogil=True, _nrt=False)


def inline_kernel(function: Callable[..., Any]) -> Kernel:
    """Like `leaf_kernel`, but pasted into its callers: passing the packed arrays costs more than most kernels do.

    Measured on qiao2021: 0.97 against 4.6 us for one trial of the differential evolution.
    """
    return _make(function, is_callee=True, forceinline=True, _nrt=False)


def inline_view_kernel(function: Callable[..., Any]) -> Kernel:
    """Like `inline_kernel`, for what gives back views of its arrays: references are counted (1.95 us for 2.07)."""
    return _make(function, is_callee=True, forceinline=True)


def _make(function: Any, **options: Any) -> Kernel:
    return Kernel(function, error_model="numpy", **options)


_LOCK = threading.RLock()
_TWINS: dict[int, tuple[dict[str, Any], dict[str, Any]]] = {}


def _find_twin(space: dict[str, Any]) -> dict[str, Any]:
    """A module's names with the plain way in place of each kernel; copied once, and again what was defined since."""
    with _LOCK:
        _, twin = _TWINS.setdefault(id(space), (space, {}))  # the module's own is held on to, so that its id stays its
        news = {name: value for name, value in space.items() if name not in twin}
        twin.update(news)  # first, so that kernels which call each other find them
        twin.update({name: value.plain for name, value in news.items() if isinstance(value, Kernel)})
    return twin


@lru_cache(maxsize=1)
def _load_compiler() -> Callable[[FunctionType, dict[str, Any]], Any]:
    """Import numba; from here on it tells the clocks."""
    from ikde.kernels.machine_code import compile_function, listen

    listen(CLOCKS)
    return compile_function


class CompileClock:
    """Adds up the seconds that numba spends compiling, on any thread; loading from the cache does not count.

    `announce` is called once, when the first compilation begins.
    """

    def __init__(self, announce: Callable[[], None] | None = None) -> None:
        self.seconds = 0.0
        self.announces = announce is not None
        self._announce = announce
        self._depth = 0
        self._started = 0.0
        self._made = time.perf_counter()

    @property
    def run_seconds(self) -> float:
        """Wall time since the clock was made, without compiling."""
        return time.perf_counter() - self._made - self.seconds

    def start(self) -> None:
        """Start the clock at the outermost compilation: callees compile inside their callers."""
        if self._depth == 0:
            self._started = time.perf_counter()
            if self._announce is not None:
                self._announce()
                self._announce = None
        self._depth += 1

    def end(self) -> None:
        """Stop the clock when the outermost compilation ends."""
        if self._depth == 1:
            self.seconds += time.perf_counter() - self._started
        self._depth = max(self._depth - 1, 0)  # what another thread began before the clock was made


@contextmanager
def compile_clock(announce: Callable[[], None] | None = None) -> Iterator[CompileClock]:
    """Measure the compile time spent inside the block, and call `announce` once if kernels must be compiled there.

    Of clocks inside one another the outermost that has an `announce` calls it, and it alone.
    """
    clock = CompileClock(None if any(clock.announces for clock in CLOCKS) else announce)
    CLOCKS.append(clock)
    try:
        yield clock
    finally:
        CLOCKS.remove(clock)


CLOCKS: list[CompileClock] = []
"""Those that run: numba need not be there for one to start."""
