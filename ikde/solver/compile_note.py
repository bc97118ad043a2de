"""What is compiled, in words: said once, on stderr, when it begins, and not at all if it is in the cache."""

import sys
from collections.abc import Callable
from contextlib import AbstractContextManager

from ikde.errors import printable
from ikde.kernels import cache_folder
from ikde.kernels.jit import CompileClock, compile_clock
from ikde.model.collision_model import CollisionModel
from ikde.model.robot import NO_DETECTOR

TAKES = "10 s to a minute"


def name_work(what: str, *collisions: CollisionModel) -> str:
    """What is compiled, in words: `pose targets of ur5, detector default`."""
    robots = ", ".join(dict.fromkeys(c.robot.name for c in collisions))
    detectors = dict.fromkeys(c.detector.name if c.detector else NO_DETECTOR for c in collisions)
    return f"{what} of {robots}, detector {', '.join(detectors)}"


def note_compile(work: Callable[[], str], takes: str = TAKES) -> AbstractContextManager[CompileClock]:
    """Say that kernels must be compiled inside the block, if they must, and for what work: then that is asked for.

    A `compile_clock` with an `announce` about the block speaks in its place.
    """
    return compile_clock(lambda: _say(work(), takes))


def _say(work: str, takes: str) -> None:
    is_kept = cache_folder.CACHE_IS_WRITABLE
    often = "once on this machine" if is_kept else "every time, since no cache folder can be used"
    if sys.stderr is not None:  # as in a program without a console
        sys.stderr.write(f"{printable(f'compiling the kernels for {work}: {often}, {takes} ...')}\n")
        sys.stderr.flush()
