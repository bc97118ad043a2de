"""Where words go: results to stdout, everything else to stderr."""

import json
import sys
import time
from contextlib import AbstractContextManager, nullcontext
from shutil import get_terminal_size
from typing import Any

from ikde.errors import printable


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
    """A spinner on stderr while the block runs, in a terminal, with the seconds that it has taken."""
    if not sys.stderr.isatty():
        return nullcontext()
    from rich.console import Console

    return Console(stderr=True).status(Working(text))


class Working:
    """Text for a spinner that is shown as it is, and for how long."""

    def __init__(self, text: str) -> None:
        self._text, self._started = printable(text), time.monotonic()

    def __rich__(self) -> Any:
        from rich.text import Text

        seconds = int(time.monotonic() - self._started)
        return Text(f"{self._text} {seconds} s" if seconds else self._text)
