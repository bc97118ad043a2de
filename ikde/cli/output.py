"""Where words go: results to stdout, everything else to stderr."""

import json
import os
import sys
import time
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from shutil import get_terminal_size
from typing import Any, TextIO

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


def print_written(*files: Path, as_json: bool = False) -> None:
    """Say which files were written, a line each; beside JSON on stderr."""
    for file in files:
        (print_note if as_json else print_line)(f"wrote {file}")


def say_written(out: Path | None, *, as_json: bool = False) -> None:
    """The same of a command that writes one file, if it is named."""
    if out is None:
        print_note("ikde: nothing is written without -o FILE")
    else:
        print_written(out, as_json=as_json)


def is_live(stream: TextIO) -> bool:
    """True for a terminal in which a line can be written over: bars and spinners may move there."""
    return stream.isatty() and os.environ.get("TERM", "").lower() not in ("dumb", "unknown")


def use_color(stream: TextIO | None = None) -> bool:
    """Colour only for such a terminal (default: stdout), unless `$NO_COLOR` or else `$FORCE_COLOR` says otherwise."""
    if os.environ.get("NO_COLOR"):
        return False
    forced = os.environ.get("FORCE_COLOR")
    return forced != "0" if forced else is_live(stream or sys.stdout)


def page_width(usual: int = 100) -> int:
    """Columns of the terminal, or of `$COLUMNS`, within what tables need and can use; `usual` outside a terminal."""
    if not sys.stdout.isatty() and not os.environ.get("COLUMNS"):
        return usual
    return min(max(get_terminal_size().columns, 60), max(usual, 120))


def layout(usual: int = 100) -> dict[str, Any]:
    """How a result is laid out on stdout: with colours or without, and how wide."""
    return {"color": use_color(), "width": page_width(usual)}


def note_console() -> Any:
    """Rich's console on stderr, for what moves there."""
    from rich.console import Console

    return Console(stderr=True, color_system="standard" if use_color(sys.stderr) else None)


def working(text: str) -> AbstractContextManager[Any]:
    """A spinner on stderr while the block runs, in a terminal, with the seconds that it has taken."""
    return note_console().status(Working(text)) if is_live(sys.stderr) else nullcontext()


class Working:
    """Text for a spinner that is shown as it is, and for how long."""

    def __init__(self, text: str) -> None:
        self._text, self._started = printable(text), time.monotonic()

    def __rich__(self) -> Any:
        from rich.text import Text

        seconds = int(time.monotonic() - self._started)
        return Text(f"{self._text} {seconds} s" if seconds else self._text)
