"""The one family of exceptions that ikde raises.

A target that cannot be reached is not an error: it is a `SolveResult` with a `StopReason`.
"""

from collections.abc import Iterable
from difflib import get_close_matches


class IkdeError(Exception):
    """Anything ikde raises on purpose."""


class InputError(IkdeError):
    """What the caller gave cannot be used; one line says what, where and what was expected.

    `where` is the path to the offending value inside what was given, such as `("frames", "O1", "parent")`.
    """

    def __init__(self, message: str, where: tuple[str | int, ...] = ()) -> None:
        self.message = message
        self.where = where
        super().__init__(f"{format_path(where)}: {message}" if where else message)


class FileError(InputError):
    """A file cannot be used: `robots/a.yaml:14 → frames.O1.parent: ...`."""

    def __init__(self, path: object, message: str, where: tuple[str | int, ...] = (), line: int | None = None) -> None:
        super().__init__(message, where)
        place = f"{path}:{line}" if line else f"{path}"
        self.args = (f"{place} → {self.args[0]}" if where else f"{place}: {message}",)


class CacheWarning(RuntimeWarning):
    """The cache of compiled code could not be used, or was damaged: answers are the same, but take longer."""


class VerificationError(IkdeError):
    """A kernel and plain numpy disagree: a bug in ikde, never a property of the target."""


def format_path(where: tuple[str | int, ...]) -> str:
    """Write `("spheres", "typical", 2, "radius")` as `spheres.typical[2].radius`."""
    text = "".join(f"[{key}]" if isinstance(key, int) else f".{show(key)}" for key in where)
    return text.removeprefix(".")


def show(text: str) -> str:
    """Text on one line: what a terminal might obey, and what nobody sees, as its escape."""
    return "".join(character if character.isprintable() else ascii(character)[1:-1] for character in text)


def nearest(name: str, known: Iterable[str]) -> str:
    """` (did you mean 'x'?)`, or nothing when no known name is close."""
    close = get_close_matches(name, list(known), n=1)
    return f" (did you mean {close[0]!r}?)" if close else ""
