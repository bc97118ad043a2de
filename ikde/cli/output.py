"""Where words go: results to stdout, everything else to stderr."""

import json
import sys
from contextlib import AbstractContextManager, nullcontext
from shutil import get_terminal_size
from typing import TYPE_CHECKING, Any

from ikde.errors import printable

if TYPE_CHECKING:
    from ikde.model.collision_model import CollisionModel


def print_result(text: str) -> None:
    """Write a result to stdout."""
    sys.stdout.write(text if text.endswith("\n") else f"{text}\n")
    sys.stdout.flush()


def print_line(text: str) -> None:
    """Write one line to stdout that may hold names of files and robots."""
    print_result(printable(text))


def print_json(data: Any) -> None:
    """Write plain data to stdout as JSON; NaN and infinity are no JSON and would be a bug."""
    print_result(json.dumps(data, indent=2, allow_nan=False))


def print_note(text: str) -> None:
    """Write a remark to stderr, on one line that gives no orders to a terminal."""
    sys.stderr.write(f"{printable(text)}\n")
    sys.stderr.flush()


def use_color() -> bool:
    """Colour only for a terminal."""
    return sys.stdout.isatty()


def page_width() -> int:
    """Columns of the terminal, within what tables need and can use; 100 outside a terminal."""
    return min(max(get_terminal_size().columns, 60), 120) if sys.stdout.isatty() else 100


def working(text: str) -> AbstractContextManager[Any]:
    """A spinner on stderr while the block runs, in a terminal."""
    if not sys.stderr.isatty():
        return nullcontext()
    from rich.console import Console

    return Console(stderr=True).status(as_words(text))


def as_words(text: str) -> Any:
    """Text for a spinner that is shown as it is."""
    from rich.text import Text

    return Text(printable(text))


def name_work(what: str, *collisions: "CollisionModel") -> str:
    """What is compiled, in words: `pose targets of ur5, detector default`."""
    from ikde.model.robot import NO_DETECTOR

    robots = ", ".join(dict.fromkeys(c.robot.name for c in collisions))
    detectors = dict.fromkeys(c.detector.name if c.detector else NO_DETECTOR for c in collisions)
    return f"{what} of {robots}, detector {', '.join(detectors)}"


def note_compile(takes: str = "10 s to a minute", work: str = "") -> AbstractContextManager[Any]:
    """Say once, on stderr, that kernels must be compiled inside the block, if they must, and for what work."""
    from ikde.kernels.cache_folder import CACHE_IS_WRITABLE
    from ikde.kernels.jit import compile_clock

    often = "once on this machine" if CACHE_IS_WRITABLE else "every time, since no cache folder can be used"
    return compile_clock(lambda: print_note(f"compiling the kernels{work and f' for {work}'}: {often}, {takes} ..."))
