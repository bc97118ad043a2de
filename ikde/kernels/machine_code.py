"""One numba set-up for every kernel, and the machine code on disk, one file a kernel and types of its arguments.

numba does not notice an edited callee in another file, so the cache folder carries a hash of all kernels. `MachineCode`
takes the place of numba's own cache, which loads what lies in its folder as it is: a file that was cut raises errors of
many kinds from every later call, and a flipped bit is run. Here a checksum stands in front of every file, and whatever
cannot be loaded is removed and compiled again.
"""

import hashlib
import pickle
import sys
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from types import FunctionType
from typing import Any, Protocol

import llvmlite
import numba
from numba.core import event
from numba.core.caching import NullCache
from numba.core.compiler import CompileResult
from numba.core.serialize import dumps

from ikde.kernels import cache_folder
from ikde.kernels.cache_files import discard, read_sealed, write_sealed

VERSIONS = (sys.implementation.cache_tag, numba.__version__, llvmlite.__version__)


class Clock(Protocol):
    """What is reported of each compilation."""

    def start(self) -> None:
        """One begins, perhaps inside another."""
        ...

    def end(self) -> None:
        """One ends."""
        ...


class MachineCode(NullCache):
    """What numba asks for compiled code and reports of it: the methods of its own caches that a dispatcher calls."""

    def __init__(self, function: FunctionType, source: str, folder: Path, options: dict[str, Any]) -> None:
        code = function.__code__
        self._folder = folder
        self._name = cache_folder.name_code(function)
        body = hashlib.sha256(code.co_code).hexdigest()
        self._identity = (*VERSIONS, source, function.__qualname__, code.co_firstlineno, body, *sorted(options.items()))

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Compiled code for types of arguments, or None if there is none that can be used."""
        target_context.refresh()
        path, key = self._find(sig, target_context)
        content = read_sealed(path)
        if content is None:
            return None
        try:
            written_for, parts = pickle.loads(content)
            return CompileResult._rebuild(target_context, *parts) if written_for == key else None
        except Exception as error:  # numba and LLVM have many ways to fail, and all are mended in one
            discard(path, f"cannot be loaded ({type(error).__name__})")
            return None

    def save_overload(self, sig: Any, cres: Any) -> None:
        """Keep compiled code, unless it holds addresses of this process."""
        if not cres.library.has_dynamic_globals and not cres.lifted:
            path, key = self._find(sig, cres.target_context)
            write_sealed(path, dumps((key, cres._reduce())))

    def _find(self, sig: Any, target_context: Any) -> tuple[Path, Any]:
        """Where code for these types and this processor is kept, and what it is for."""
        key = (sig, target_context.codegen().magic_tuple(), self._identity)
        return self._folder / f"{self._name}{hashlib.sha256(repr(key).encode()).hexdigest()[:24]}.nbc", key


def compile_function(function: FunctionType, options: dict[str, Any]) -> Any:
    """A dispatcher of numba's, whose machine code is kept if the function stands in a file; without a JIT itself."""
    compiled: Any = numba.njit(**options)(function)
    source = hash_source(function.__code__.co_filename) if cache_folder.CACHE_IS_WRITABLE else None
    if source and not function.__closure__ and compiled is not function:
        folder = cache_folder.CACHE_FOLDER / cache_folder.MACHINE_CODE
        compiled._cache = MachineCode(function, source, folder, options)
    return compiled


class _Relay(event.Listener):
    """Tells clocks of compilations, on any thread; loading from the cache is none."""

    def __init__(self, clocks: Sequence[Clock]) -> None:
        self._clocks = clocks

    def on_start(self, event: Any) -> None:
        for clock in tuple(self._clocks):
            clock.start()

    def on_end(self, event: Any) -> None:
        for clock in tuple(self._clocks):
            clock.end()


def listen(clocks: Sequence[Clock]) -> None:
    """Tell the clocks that are in the list from now on of every compilation."""
    event.register("numba:compile", _Relay(clocks))


@lru_cache(maxsize=1024)
def hash_source(file: str) -> str | None:
    """SHA-256 of a source file, hex; None if there is none, as for code that was compiled from memory."""
    try:
        return hashlib.sha256(Path(file).read_bytes()).hexdigest()
    except OSError:
        return None
