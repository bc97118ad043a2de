"""How far a batch or a benchmark is, on stderr: a bar in a terminal, a line now and then in a log."""

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from typing import TYPE_CHECKING, Any

from ikde.cli.output import is_live, note_console, print_note
from ikde.errors import printable

if TYPE_CHECKING:
    from ikde.batch.run import Progress
    from ikde.solver.progress import Progress as BenchProgress

    Tell = Callable[[Progress], None]

LINE_SECONDS = 60.0


def show_progress(title: str) -> AbstractContextManager["Tell"]:
    """What `run_batch` tells its progress to."""
    return _show_bar(title) if is_live(sys.stderr) else _show_lines(title)


@contextmanager
def _show_bar(title: str) -> Iterator["Tell"]:
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        SpinnerColumn,
        TaskProgressColumn,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )
    from rich.progress import Progress as Bars

    pace = Pace()
    columns = (
        SpinnerColumn(),
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TaskProgressColumn(),
        MofNCompleteColumn(),
        TextColumn("solves, {task.fields[parts]} parts, {task.fields[rate]}"),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
    )
    with Bars(*columns, console=note_console(), speed_estimate_period=600.0) as bars:
        bar = bars.add_task(printable(title), parts="", rate="")

        def tell(now: "Progress") -> None:
            parts = f"{now.parts_done} of {now.parts}"
            bars.update(bar, completed=now.solves_done, total=now.solves, parts=parts, rate=pace.format(now))

        yield tell


@contextmanager
def _show_lines(title: str) -> Iterator["Tell"]:
    pace, said = Pace(), None

    def tell(now: "Progress") -> None:
        nonlocal said
        rate, clock = pace.format(now), time.monotonic()
        if said is None:
            print_note(f"{title}: {now.solves} solves, {now.parts_found} of {now.parts} parts done before")
        elif clock - said >= LINE_SECONDS:
            print_note(f"{title}: {now.solves_done} of {now.solves} solves, {rate}")
        else:
            return
        said = clock

    yield tell


class Pace:
    """Solves a second since it was first asked."""

    def __init__(self) -> None:
        self._start: tuple[float, int] | None = None

    def format(self, now: "Progress") -> str:
        """`120 solves/s`; nothing before there is anything to tell."""
        self._start = self._start or (time.monotonic(), now.solves_done)
        started, before = self._start
        if now.solves_done == before:
            return ""
        pace = (now.solves_done - before) / (time.monotonic() - started)
        return f"{pace:,.0f} solves/s" if pace >= 10.0 else f"{pace:.2g} solves/s"


class Bar:
    """Progress of a benchmark as a bar."""

    def __init__(self, bars: Any, solves: int) -> None:
        self._bars, self._task = bars, bars.add_task("", total=solves)

    def begin(self, section: str) -> None:
        """Name what is being computed."""
        self._bars.update(self._task, description=section)

    def advance(self, solves: int) -> None:
        """Move the bar."""
        self._bars.advance(self._task, solves)


class Lines:
    """Progress of a benchmark as lines."""

    def begin(self, section: str) -> None:
        """Name what is being computed."""
        print_note(f"computing: {section}")

    def advance(self, solves: int) -> None:
        """A log needs no more."""


@contextmanager
def show_benchmark(solves: int) -> Iterator["BenchProgress"]:
    """A bar of so many solves, or motions, with what is being computed; for a log the names alone."""
    if not is_live(sys.stderr):
        yield Lines()
        return
    from rich.progress import Progress as Bars
    from rich.progress import SpinnerColumn, TimeElapsedColumn

    columns = (SpinnerColumn(), *Bars.get_default_columns(), TimeElapsedColumn())
    with Bars(*columns, console=note_console()) as bars:
        yield Bar(bars, solves)
