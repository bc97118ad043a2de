"""Where words go: results to stdout, everything else to stderr."""

import json
import sys
from typing import Any


def print_result(text: str) -> None:
    """Write a result to stdout."""
    sys.stdout.write(text if text.endswith("\n") else f"{text}\n")
    sys.stdout.flush()


def print_json(data: Any) -> None:
    """Write plain data to stdout as JSON; NaN and infinity are no JSON and would be a bug."""
    print_result(json.dumps(data, indent=2, allow_nan=False))


def print_note(text: str) -> None:
    """Write a remark to stderr."""
    sys.stderr.write(f"{text}\n")
    sys.stderr.flush()


def use_color() -> bool:
    """Colour only for a terminal."""
    return sys.stdout.isatty()


def announce_compile() -> None:
    """Said once, when kernels must be compiled before the first solve."""
    print_note("compiling the kernels: once on this machine, about 15 s ...")
