"""A run is cut into parts, so many consecutive solves of one arm each, and a part is two Parquet files."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from ikde.errors import FileError
from ikde.formats.atomic import write_together
from ikde.formats.reading import check_room, errors_of, read_bytes
from ikde.formats.tables import claimed_bytes

PLAIN_NAME = re.compile(r"[A-Za-z0-9_.-]{1,100}")  # arms name files, graders name columns
SOLUTIONS, TIMING = "solutions", "timing"
RECIPE, SEAL = b"ikde_recipe", b"ikde_seal"  # keys in the metadata of a file
MAX_PARTS = 10**6  # of a run
GO_ON = "finished parts are intact; run the same command again to resume"


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


@dataclass(frozen=True, slots=True)
class SealedPart:
    """A part as the bytes of its two files."""

    part: Part
    solutions: pa.Buffer
    timing: pa.Buffer


def seal_part(part: Part, solutions: pa.Table, timing: pa.Table, *, recipe: str) -> SealedPart:
    """Both files carry the hash of the recipe, and the timing carries a seal on the solutions, byte by byte."""
    answers = serialize(solutions.replace_schema_metadata({RECIPE: recipe}))
    timing = timing.replace_schema_metadata({RECIPE: recipe, SEAL: _seal(answers, timing)})
    return SealedPart(part, answers, serialize(timing))


def write_parts(folder: Path, parts: Sequence[SealedPart]) -> None:
    """Write both files of parts, in order; the solutions come last, so that where they are, all is there."""
    files: dict[Path, pa.Buffer] = {}
    for sealed in parts:
        files[sealed.part.path(folder, TIMING)] = sealed.timing
        files[sealed.part.path(folder, SOLUTIONS)] = sealed.solutions
    try:
        write_together(files)
    except OSError as error:
        path = Path(error.filename)
        raise FileError(path, f"cannot be written: {error.strerror}; {GO_ON}") from None


def serialize(table: pa.Table) -> pa.Buffer:
    """A table as the bytes of a Parquet file; every choice is fixed, so that the same table gives the same bytes."""
    words = [field.name for field in table.schema if pa.types.is_dictionary(field.type)]
    sink = pa.BufferOutputStream()
    pq.write_table(
        table,
        sink,
        version="2.6",
        compression="snappy",  # twice as fast as zstd in all, and 7 % larger: most of a row is random digits
        row_group_size=2**20,
        write_page_checksum=True,
        use_dictionary=words,  # type: ignore[arg-type]
        write_statistics=False,  # a third of the time, and no reader skips a part by its digits
    )
    return sink.getvalue()


def read_table(path: Path, columns: Sequence[str] | None = None) -> pa.Table:
    """A file of a part, or those of `columns` that it has; raises `FileError` if it is damaged, or a link."""
    return _parse(path, read_bytes(path, follow=False), columns)


def _parse(path: Path, data: bytes, columns: Sequence[str] | None) -> pa.Table:
    source = pa.BufferReader(data)
    with errors_of(path), pq.ParquetFile(source, page_checksum_verification=True) as file:
        wanted = [name for name in file.schema_arrow.names if columns is None or name in columns]
        check_room(path, claimed_bytes(file.metadata, len(wanted)))
        return file.read(wanted)


def read_finished(
    folder: Path, part: Part, recipe: str, columns: Sequence[str] | None = None
) -> tuple[pa.Table, pa.Table] | None:
    """Solutions, or those of `columns` that there are, and timing of a part, read once.

    None unless both files are there, of this recipe, undamaged, and hold the rows they should.
    """
    path = part.path(folder, SOLUTIONS)
    try:
        answers = read_bytes(path, follow=False)
        timing = read_table(part.path(folder, TIMING))
        marks = {RECIPE: recipe.encode(), SEAL: _seal(answers, timing).encode()}
        if len(timing) != part.rows or timing.schema.metadata != marks:
            return None
        return _parse(path, answers, columns), timing
    except FileError:
        return None


def _seal(answers: pa.Buffer | bytes, timing: pa.Table) -> str:
    """Digest of all that the checksums of Parquet's pages leave out: the solutions' file, the timing's columns."""
    columns = [f"{field.name}: {field.type}" for field in timing.schema]
    hasher = sha256(answers)
    for column in columns:
        hasher.update(f"\n{column}".encode())
    return hasher.hexdigest()
