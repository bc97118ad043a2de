"""A run is cut into parts, so many consecutive solves of one arm each, and a part is two Parquet files."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from ikde.batch.atomic import write_atomically
from ikde.errors import FileError

SOLUTIONS, TIMING = "solutions", "timing"
GO_ON = "finished parts are intact; run the same command again to go on"


@dataclass(frozen=True, slots=True)
class Part:
    """Solves first .. last - 1 of an arm."""

    arm: str
    number: int
    first: int
    last: int

    @property
    def rows(self) -> int:
        """Number of solves."""
        return self.last - self.first

    def path(self, folder: Path, kind: str) -> Path:
        """Its file in the folder of a run, `kind` being SOLUTIONS or TIMING."""
        return folder / kind / f"{self.arm}-{self.number:05d}.parquet"


def list_parts(arms: Sequence[str], solves: int, chunk: int) -> Iterator[Part]:
    """All parts in the order of the answers: arm after arm."""
    for arm in arms:
        for number, first in enumerate(range(0, solves, chunk)):
            yield Part(arm, number, first, min(first + chunk, solves))


def write_part(folder: Path, part: Part, solutions: pa.Table, timing: pa.Table) -> None:
    """Write both files of a part; the solutions come last, so that where they are, all is there."""
    for kind, table in ((TIMING, timing), (SOLUTIONS, solutions)):
        path = part.path(folder, kind)
        try:
            write_atomically(path, serialize(table))
        except OSError as error:
            raise FileError(path, f"cannot be written: {error.strerror}; {GO_ON}") from None


def serialize(table: pa.Table) -> pa.Buffer:
    """A table as the bytes of a Parquet file; every choice is fixed, so that the same table gives the same bytes."""
    words = [field.name for field in table.schema if pa.types.is_dictionary(field.type)]
    sink = pa.BufferOutputStream()
    pq.write_table(
        table,
        sink,
        version="2.6",
        compression="zstd",
        compression_level=3,
        row_group_size=2**20,
        use_dictionary=words,  # type: ignore[arg-type]
    )
    return sink.getvalue()


def is_finished(folder: Path, part: Part) -> bool:
    """True if both files can be read and hold the rows they should."""
    try:
        found = {pq.read_metadata(part.path(folder, kind)).num_rows for kind in (SOLUTIONS, TIMING)}
    except (OSError, pa.ArrowException):
        return False
    return found == {part.rows}
