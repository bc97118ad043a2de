"""Untrusted files, read whole: regular ones only, of limited size; whatever a reader raises becomes one line."""

import json
import os
import re
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import accumulate
from pathlib import Path
from typing import Any

from ikde.errors import FileError, IkdeError, InputError, quoted

LIMIT = "IKDE_MAX_FILE_MB"
"""Environment variable: MB (10^6 bytes) that a table may take up in its file and, as numbers, in memory."""
DEFAULT_MB = 500.0  # unless the variable says otherwise
TEXT_SHARE = 0.1  # of that for YAML and JSON, which take more room once they are read
MAX_DEPTH = 40  # of mappings and lists inside each other

# A pipe without a writer does not block; a terminal does not take over.
_CAREFULLY = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_NOCTTY", 0) | getattr(os, "O_CLOEXEC", 0)
_BRACKET = re.compile(r'"(?:[^"\\]|\\.)*"|[\[\]{}]')
_STEP = {"[": 1, "{": 1, "]": -1, "}": -1}


def max_bytes(share: float = 1.0) -> int:
    """Bytes that a file may hold, or `share` of them; raises `InputError` if `$IKDE_MAX_FILE_MB` is no number."""
    given = os.environ.get(LIMIT) or str(DEFAULT_MB)
    try:
        most = float(given)
    except ValueError:
        most = 0.0
    if not 0.0 < most < 1e9:
        raise InputError(f"expected a number of MB above 0, got {quoted(given)}", (LIMIT,))
    return int(share * most * 1e6)


def read_path(path: object, where: str) -> Path:
    """A path as it is given; raises `InputError` for what is none."""
    if not isinstance(path, str | os.PathLike) or not isinstance(os.fspath(path), str):
        raise InputError(f"expected the path of a file, got {quoted(path)}", (where,))
    return Path(os.fspath(path))


def read_bytes(path: Path, share: float = 1.0, *, follow: bool = True) -> bytes:
    """A whole file, of at most `share` of the limit `$IKDE_MAX_FILE_MB`; with `follow` a link may lead elsewhere.

    Raises:
        FileError: for what is missing, no regular file (a folder, pipe, device or socket), too large or unreadable.
    """
    most = max_bytes(share)
    try:
        descriptor = os.open(path, _CAREFULLY if follow else _CAREFULLY | os.O_NOFOLLOW)
        try:
            size = _check_regular(path, os.fstat(descriptor), most)  # of what was opened, whatever has its name now
            with open(descriptor, "rb", closefd=False) as file:
                return file.read(size)
        finally:
            os.close(descriptor)
    except FileNotFoundError:
        raise FileError(path, "no such file") from None
    except MemoryError:
        raise FileError(path, "cannot be read: not enough memory") from None
    except (OSError, ValueError) as error:
        raise FileError(path, f"cannot be read: {getattr(error, 'strerror', None) or error}") from None


def _check_regular(path: Path, status: os.stat_result, most: int) -> int:
    """Its size: a file may grow while it is read, and some of the system's own never end."""
    if stat.S_ISDIR(status.st_mode):
        raise FileError(path, "this is a folder; expected a file")
    if not stat.S_ISREG(status.st_mode):
        raise FileError(path, "this is a pipe, a device or a socket; expected a regular file")
    if status.st_size > most:
        raise FileError(path, f"{_write_mb(status.st_size)}; {_expect_at_most(most)}")
    return status.st_size


def _expect_at_most(most: int) -> str:
    """What is said of files that are too large."""
    return f"expected at most {_write_mb(most)} (${LIMIT})"


def check_room(path: Path, size: int, what: str = "columns") -> None:
    """Refuse numbers that would not fit in memory before there are any."""
    if size > max_bytes():
        raise FileError(path, f"its {what} would take up {size / 1e6:,.0f} MB; {_expect_at_most(max_bytes())}")


def _write_mb(size: int) -> str:
    return f"{size / 1e6:,.10g} MB"


def read_text(path: Path, *, follow: bool = True) -> str:
    """Text of a file; raises `FileError` in one line for everything that can go wrong with it."""
    try:
        return read_bytes(path, TEXT_SHARE, follow=follow).decode("utf-8")
    except UnicodeDecodeError:
        raise FileError(path, "not a UTF-8 text file") from None


def read_json(path: Path, *, follow: bool = True) -> Any:
    """Plain data from a JSON file; raises `FileError` in one line."""
    text = read_text(path, follow=follow)
    depth = max(accumulate(_STEP.get(mark, 0) for mark in _BRACKET.findall(text)), default=0)
    if depth > MAX_DEPTH:
        raise FileError(path, f"nested too deeply; expected at most {MAX_DEPTH} levels")
    with errors_of(path):
        try:
            return json.loads(text, parse_constant=_refuse_constant)
        except json.JSONDecodeError as error:
            raise FileError(path, f"not JSON: {error.msg}", line=error.lineno) from None
        except (ValueError, RecursionError) as error:
            raise FileError(path, f"not JSON: {error}") from None


def _refuse_constant(word: str) -> Any:
    raise ValueError(f"{word} is no number")


@contextmanager
def errors_of(path: Path) -> Iterator[None]:
    """Turn whatever a foreign reader raises inside the block into a `FileError` in one line."""
    try:
        yield
    except IkdeError:
        raise
    except MemoryError:
        raise FileError(path, "cannot be read: not enough memory") from None
    except Exception as error:
        text = str(getattr(error, "strerror", None) or error).partition("\n")[0]
        raise FileError(path, f"cannot be read: {text or type(error).__name__}") from None
