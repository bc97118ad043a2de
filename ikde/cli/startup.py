"""What makes a short-lived process start fast."""

import gc
import sys


def collect_garbage_rarely() -> None:
    """Imports allocate much and free nothing: the collector would walk them all again and again, for 0.2 s."""
    gc.set_threshold(1_000_000)


def skip_blas_probe() -> None:
    """Keep numba from importing `scipy.linalg` just to learn whether BLAS is there: 0.2 s of every `ikde solve`.

    No kernel of ikde calls BLAS. Only the command line does this, in its own process; the library leaves numba alone.
    """
    sys.modules.setdefault("scipy.linalg.cython_blas", None)  # type: ignore[arg-type]
