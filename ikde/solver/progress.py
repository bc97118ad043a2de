"""How far a benchmark is, for whoever shows it."""

from typing import Protocol


class Progress(Protocol):
    """Hears how far a benchmark is, about every second."""

    def begin(self, section: str) -> None:
        """A section begins."""

    def advance(self, solves: int) -> None:
        """So many more solves, or motions, are done."""


class _Silence:
    def begin(self, section: str) -> None:
        """Say nothing."""

    def advance(self, solves: int) -> None:
        """Say nothing."""


SILENCE: Progress = _Silence()
