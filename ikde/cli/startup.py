"""What makes a short-lived process start fast."""

import gc
import os
import sys
import warnings
from io import TextIOWrapper
from pathlib import Path
from typing import Any

from ikde.cli.output import print_note
from ikde.errors import CacheWarning


def skip_garbage_collection() -> None:
    """Imports allocate much and free nothing: the collector would walk them again and again, for 0.2 s.

    A command that runs for long turns it on again.
    """
    gc.disable()


def use_one_blas_thread() -> None:
    """Products of 4 x 4 matrices need no thread pool, and starting one costs 0.1 s. For this process only."""
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")


def leave_garbage_at_exit() -> None:
    """Python's last collection would walk everything once more, for 0.2 s, only to hand it to the system anyway."""
    gc.freeze()


def skip_blas_probe() -> None:
    """Keep numba from importing `scipy.linalg`, if it is installed, to look for BLAS: 0.2 s of every `ikde solve`.

    No kernel of ikde calls BLAS. Only the command line does this, in its own process; the library leaves numba alone.
    """
    sys.modules.setdefault("scipy.linalg.cython_blas", None)  # type: ignore[arg-type]


def prepare_streams() -> None:
    """Streams that were closed swallow what is written, before a file takes their number.

    A stdout that is not UTF-8, as of a pipe on Windows, shows `?` for the lines of tables, rather than none.
    """
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, Path(os.devnull).open("w", encoding="utf-8"))  # noqa: SIM115
    if isinstance(sys.stdout, TextIOWrapper):
        sys.stdout.reconfigure(errors="replace")


def warn_in_one_line() -> None:
    """What is wrong with the cache, as every other remark; other warnings stay as Python shows them."""
    theirs = warnings.showwarning

    def show(message: Warning | str, category: type[Warning], *where: Any) -> None:
        if issubclass(category, CacheWarning):
            print_note(f"ikde: {message}")
        else:
            theirs(message, category, *where)

    warnings.showwarning = show
