"""The one family of exceptions that ikde raises, and foreign text as it may be shown.

A target that cannot be reached is not an error: it is a `SolveResult` with a `StopReason`. An error is one line of at
most `MAX_LENGTH` characters: files and names may hold anything, also what a terminal would obey.
"""

from collections.abc import Callable, Iterable
from difflib import get_close_matches
from types import TracebackType
from typing import Self, TypeVar

MAX_LENGTH = 400  # characters of an error; file, line and key are kept, the message is cut
MAX_FILE_LENGTH, MAX_KEYS_LENGTH, MAX_QUOTE_LENGTH = 140, 100, 60
MAX_COMPARED = 1000  # names that a misspelt one is compared with

_T = TypeVar("_T")


class IkdeError(Exception):
    """Anything ikde raises on purpose."""


class InputError(IkdeError):
    """What the caller gave cannot be used; one line says what, where and what was expected.

    `where` is the path to the offending value inside what was given, such as `("frames", "O1", "parent")`.
    """

    def __init__(self, message: str, where: tuple[str | int, ...] = ()) -> None:
        self.message = shorten(printable(message), MAX_LENGTH)
        self.where = where
        self.others: tuple[InputError, ...] = ()  # of other places, found together with this one
        super().__init__(_write_line(format_path(where), self.message))


class FileError(InputError):
    """A file cannot be used: `robots/a.yaml:14 → frames.O1.parent: ...`."""

    def __init__(self, path: object, message: str, where: tuple[str | int, ...] = (), line: int | None = None) -> None:
        super().__init__(message, where)
        file = shorten(printable(str(path)), MAX_FILE_LENGTH, keep_end=True)
        place = f"{file}:{line}" if line else file
        self.args = (_write_line(f"{place} → {format_path(where)}" if where else place, self.message),)


class ErrorList:
    """Errors of entries side by side: each `with` block keeps what is wrong in it; then all are raised as one."""

    def __init__(self) -> None:
        self._found: list[InputError] = []

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, _: TracebackType | None) -> bool:
        if not isinstance(error, InputError):
            return False
        self._found.append(error)
        return True

    def collect(self, makers: Iterable[Callable[[], _T]]) -> tuple[_T, ...]:
        """What they make, without those that find something wrong."""
        made: list[_T] = []
        for make in makers:
            with self:
                made.append(make())
        return tuple(made)

    def raise_all(self) -> None:
        """Raise the first, which holds the others; nothing if there is none."""
        if self._found:
            first, *others = self._found
            first.others = tuple(others)
            raise first


class CacheWarning(RuntimeWarning):
    """The cache of compiled code could not be used, or was damaged: answers are the same, but take longer."""


class VerificationError(IkdeError):
    """A kernel and plain numpy disagree: a bug in ikde, never a property of the target."""


def format_path(where: tuple[str | int, ...]) -> str:
    """Write `("spheres", "typical", 2, "radius")` as `spheres.typical[2].radius`."""
    text = "".join(f"[{key}]" if isinstance(key, int) else f".{shorten(str(key), MAX_KEYS_LENGTH)}" for key in where)
    return shorten(printable(text.removeprefix(".")), MAX_KEYS_LENGTH, keep_end=True)


def nearest(name: str, known: Iterable[str]) -> str:
    """` (did you mean 'x'?)`, or nothing when no known name is close."""
    close = get_close_matches(name[:MAX_QUOTE_LENGTH], list(known)[:MAX_COMPARED], n=1)
    return f" (did you mean {quoted(close[0])}?)" if close else ""


def printable(text: str, keep: str = "") -> str:
    """Text on one line in which nothing is an order to a terminal: `\\x1b[31m` for what would turn it red.

    Control characters, line breaks, marks that reverse the direction of text, halves of characters: all that Unicode
    does not call printable is written as Python writes it, but for the characters in `keep`.
    """
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() or c in keep else repr(c)[1:-1] for c in text)


def quoted(value: object) -> str:
    """A value as Python writes it, in so few characters that a line has room for it."""
    return shorten(printable(repr(value)), MAX_QUOTE_LENGTH)


def shorten(text: str, most: int, *, keep_end: bool = False) -> str:
    """At most so many characters: the first ones, or the last ones."""
    if len(text) <= most:
        return text
    return f"...{text[len(text) - most + 3 :]}" if keep_end else f"{text[: most - 3]}..."


def _write_line(place: str, message: str) -> str:
    return f"{place}: {shorten(message, MAX_LENGTH - len(place) - 2)}" if place else message
