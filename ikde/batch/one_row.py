"""One row of a run, by itself: found among the answers, and solved once more."""

from dataclasses import dataclass
from pathlib import Path

import pyarrow as pa

from ikde.batch.folder import check_folder
from ikde.batch.manifest import Manifest, read_manifest
from ikde.batch.parts import SOLUTIONS, Part
from ikde.batch.plan import Batch
from ikde.batch.read import read_part
from ikde.batch.task import make_task, search_task, tabulate
from ikde.errors import FileError, InputError, nearest, quoted
from ikde.solver.result import SolveResult

FORM = "ARM/TARGET/REPEAT"


@dataclass(frozen=True, slots=True)
class Row:
    """The solve of a target by an arm: `auto/17/0`."""

    arm: str
    target: int
    repeat: int

    def __str__(self) -> str:
        """As it is typed."""
        return f"{self.arm}/{self.target}/{self.repeat}"


def parse_row(text: str) -> Row:
    """`auto/17/0`, or `auto/17` for its first repeat; raises `InputError`."""
    arm, *numbers = text.split("/")
    if not (arm and 1 <= len(numbers) <= 2 and all(number.isascii() and number.isdecimal() for number in numbers)):
        raise InputError(f"expected {FORM}, such as auto/17/0, got {quoted(text)}", ("row",))
    target, repeat = map(int, [*numbers, "0"][:2])
    return Row(arm, target, repeat)


def solve_row(batch: Batch, row: Row) -> tuple[SolveResult, pa.Table]:
    """Solve one row by itself: its result, and the row of `solutions` that a run writes of it, bit for bit.

    Raises:
        InputError: for an arm, a target or a repeat that the batch does not have.
    """
    arms = [arm.name for arm in batch.arms]
    if row.arm not in arms:
        raise InputError(
            f"no arm is called {quoted(row.arm)}{nearest(row.arm, arms)}; there are {', '.join(arms)}", ("row",)
        )
    for what, number, count in (("target", row.target, batch.source.count), ("repeat", row.repeat, batch.repeats)):
        if number >= count:
            raise InputError(f"there is no {what} {number}; expected 0 to {count - 1:,}", ("row",))
    task = make_task(batch, _part_of(row, batch.repeats, batch.chunk))
    rows = search_task(task)
    return rows[0], tabulate(task, rows).solutions


def compare_row(folder: Path, batch: Batch, row: Row, solution: pa.Table) -> bool:
    """Whether a run holds this row already, bit for bit as `solution`.

    Raises:
        FileError: for a folder that holds no run of this batch, or another answer.
    """
    check_folder(folder, batch, overwrite=False)
    if not folder.exists():
        return False
    there = read_row(folder, read_manifest(folder), row)
    if there is None:
        return False
    if repr(there) != repr(solution.to_pylist()[0]):  # of NaN, too
        raise FileError(folder, f"holds another answer of {row}; was it solved on this machine, by this ikde?")
    return True


def read_row(folder: Path, manifest: Manifest, row: Row) -> dict[str, object] | None:
    """A row of a run by column; None where its part is not finished."""
    one = _part_of(row, manifest.repeats, manifest.chunk)
    first = one.number * manifest.chunk
    part = Part(row.arm, one.number, first, min(first + manifest.chunk, manifest.solves))
    if not part.path(folder, SOLUTIONS).exists():
        return None
    return read_part(folder, manifest, part, SOLUTIONS).slice(one.first - first, 1).to_pylist()[0]


def _part_of(row: Row, repeats: int, chunk: int) -> Part:
    """The row as a part of its own, with the number of the part that it belongs to."""
    first = row.target * repeats + row.repeat
    return Part(row.arm, first // chunk, first, first + 1)
