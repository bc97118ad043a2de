"""What the exit code says."""

from enum import IntEnum


class ExitCode(IntEnum):
    """Documented in the README; scripts rely on it."""

    OK = 0
    """All reached; no collision."""
    NOT_REACHED = 1
    """Some target not reached, or `check` found a collision."""
    BAD_INPUT = 2
    """Bad usage, or a file that cannot be used."""
    BUG = 3
    """A bug in ikde."""
    INTERRUPTED = 130
    """Ctrl-C."""
