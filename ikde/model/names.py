"""What things may be called. A name is shown, compared and stored; it is never run, and never names a file."""

from collections.abc import Container
from typing import Any

from ikde.errors import InputError

MAX_NAME_LENGTH = 100  # characters


def check_printable(name: Any, where: tuple[str | int, ...]) -> None:
    """Raise `InputError` unless this is text of 1 to 100 printable characters."""
    fault = find_fault(name)
    if fault:
        raise InputError(fault, where)


def find_fault(name: Any) -> str | None:
    """What is wrong with a name, or None. Control characters, invisible ones and those that turn text are refused."""
    if not isinstance(name, str):
        return f"expected a name, got {type(name).__name__}"
    if not 1 <= len(name) <= MAX_NAME_LENGTH:
        return f"expected a name of 1 to {MAX_NAME_LENGTH} characters, got {len(name):,}"
    hidden = next((character for character in name if not character.isprintable()), None)
    return None if hidden is None else f"expected a name of printable characters, got one with {hidden!a}"


def find_free_name(wanted: str, taken: Container[str]) -> str:
    """`wanted`, cut to the length of a name, with underscores at its end until it is not among those that are taken."""
    tails = ("_" * count for count in range(MAX_NAME_LENGTH))
    names = (f"{wanted[: MAX_NAME_LENGTH - len(tail)]}{tail}" for tail in tails)
    return next(name for name in names if name not in taken)
