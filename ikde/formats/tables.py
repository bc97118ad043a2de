"""Tables: CSV, Parquet and NPZ files as columns by name. What is wrong with a file is a `FileError` in one line.

A table is read whole, within the limit of `reading.max_bytes`, and what it claims to hold is checked against that
limit before room is made for it. Nothing in it is executed: arrays of objects, which are pickles, are refused.
"""

import csv
from collections.abc import Iterator, Sequence
from io import BytesIO, TextIOWrapper
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.csv as pa_csv
import pyarrow.parquet as pq

from ikde.errors import FileError, InputError, quoted
from ikde.formats.npz import NpzTable
from ikde.formats.reading import check_room, errors_of, read_bytes

Column = pa.ChunkedArray | np.ndarray
"""[T], from arrow or numpy; of an NPZ file also [T, 3] or [T, 4]."""

MAX_COLUMNS = 10_000
MAX_HEADER = 10**6  # characters
MAX_NAME_LENGTH = 1000  # characters of a target's name
FLOAT_BYTES = 8


class Table(Protocol):
    """A file of columns."""

    names: list[str]

    def read(self, names: Sequence[str]) -> dict[str, Column]:
        """Columns by name."""
        ...


class CsvTable:
    """A CSV file; its first line names the columns."""

    def __init__(self, path: Path, data: bytes) -> None:
        self._path, self._data = path, data
        self._ragged: FileError | None = None
        with errors_of(path):
            self.names = next(csv.reader(self._header_lines()), [])
        if not self.names:
            raise FileError(path, "the first line is empty; expected the names of the columns")

    def read(self, names: Sequence[str]) -> dict[str, Column]:
        """Columns as text: types guessed from a file's beginning may not fit its end."""
        rows = max(map(self._data.count, (b"\n", b"\r")))
        check_room(self._path, rows * len(names) * FLOAT_BYTES)
        read = pa_csv.ReadOptions(use_threads=False)  # only then are rows numbered
        parse = pa_csv.ParseOptions(invalid_row_handler=self._refuse)
        convert = pa_csv.ConvertOptions(include_columns=list(names), column_types=dict.fromkeys(names, pa.string()))
        with errors_of(self._path):
            try:
                source = pa.BufferReader(self._data)
                table = pa_csv.read_csv(source, read_options=read, parse_options=parse, convert_options=convert)
            except pa.ArrowInvalid:
                if self._ragged:
                    raise self._ragged from None
                raise
            return {name: table.column(name) for name in names}

    def _header_lines(self) -> Iterator[str]:
        """Lines from the top, none of them endless."""
        with TextIOWrapper(BytesIO(self._data), encoding="utf-8-sig", newline="") as file:
            while line := file.readline(MAX_HEADER):
                if len(line) == MAX_HEADER:
                    raise FileError(self._path, f"the first line is too long; expected at most {MAX_HEADER:,}")
                yield line

    def _refuse(self, row: Any) -> str:
        """Arrow lets no exception through, so it is kept."""
        message = f"expected {row.expected_columns} values, got {row.actual_columns}"
        self._ragged = row_error(self._path, row.number - 2, message)
        return "error"


class ParquetTable:
    """A Parquet file."""

    def __init__(self, path: Path, data: bytes) -> None:
        self._path, self._data = path, data
        with errors_of(path):
            self._schema = pq.read_schema(pa.BufferReader(data))
        self.names: list[str] = self._schema.names

    def read(self, names: Sequence[str]) -> dict[str, Column]:
        """Columns in their own types."""
        for name in names:
            if not is_plain(self._schema.field(name).type):
                raise FileError(self._path, f"{name}: expected numbers, got {self._schema.field(name).type}")
        words = [name for name in names if is_text(self._schema.field(name).type)]
        with errors_of(self._path), pq.ParquetFile(pa.BufferReader(self._data), read_dictionary=words) as file:
            check_room(self._path, claimed_bytes(file.metadata, len(names)))
            table = file.read(columns=list(names))
            return {name: self._spell_out(table.column(name)) for name in names}

    def _spell_out(self, column: pa.ChunkedArray) -> pa.ChunkedArray:
        """Words instead of their numbers: a long word that is there often takes little room only until then."""
        if not (pa.types.is_dictionary(column.type) and is_text(column.type)):
            return column
        check_room(self._path, sum(map(_spelt_bytes, column.chunks)))
        return column.cast(column.type.value_type)


def claimed_bytes(metadata: pq.FileMetaData, columns: int) -> int:
    """What so many columns of a Parquet file take up as numbers, according to itself.

    Nothing finer is asked: reading a column of a damaged file ends the process.
    """
    groups = sum(metadata.row_group(index).num_rows for index in range(metadata.num_row_groups))
    return FLOAT_BYTES * columns * max(metadata.num_rows, groups)


def is_text(kind: pa.DataType) -> bool:
    """Words, or words by their numbers."""
    kind = kind.value_type if pa.types.is_dictionary(kind) else kind
    return pa.types.is_string(kind) or pa.types.is_large_string(kind)


def is_plain(kind: pa.DataType) -> bool:
    """One thing a row, of a size that is known before it is read."""
    kind = kind.value_type if pa.types.is_dictionary(kind) else kind
    return is_text(kind) or pa.types.is_primitive(kind) or pa.types.is_null(kind)


def _spelt_bytes(chunk: pa.DictionaryArray) -> int:
    lengths = pc.call_function("binary_length", [chunk.dictionary]).fill_null(0)
    return int(lengths.take(chunk.indices.drop_null()).to_numpy().sum(dtype=np.int64))


READERS = {".csv": CsvTable, ".parquet": ParquetTable, ".npz": NpzTable}


def open_table(path: Path) -> Table:
    """The table in a file.

    Raises:
        InputError: at `path`, for a file that is missing, too large or of another kind.
        FileError: for what is inside.
    """
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise InputError(f"expected a file that ends in {', '.join(READERS)}, got {quoted(path.name)}", ("path",))
    try:
        data = read_bytes(path)
    except FileError as error:
        raise InputError(f"{error.message}: {path}", ("path",)) from None
    table = reader(path, data)
    if len(table.names) > MAX_COLUMNS:
        raise FileError(path, f"expected at most {MAX_COLUMNS:,} columns, got {len(table.names):,}")
    return table


def row_error(path: Path, row: int, message: str) -> FileError:
    """What is wrong with a row; people count from 1 and not the header, `row` from 0."""
    return FileError(path, f"row {row + 1}: {message}")


def as_floats(path: Path, name: str, column: Column) -> np.ndarray:
    """A column as float64, of the same shape; raises `FileError` with row and column for text and missing values."""
    if isinstance(column, np.ndarray):
        if column.dtype.kind not in "fiu":
            raise FileError(path, f"{name}: expected numbers, got {column.dtype}")
        check_room(path, column.size * FLOAT_BYTES)
        with np.errstate(all="ignore"):
            return column.astype(np.float64)
    if column.null_count:
        raise row_error(path, column.is_null().to_pylist().index(True), f"{name}: no value")
    if pa.types.is_string(column.type) or pa.types.is_large_string(column.type):
        return _parse(path, name, column)
    if not (pa.types.is_integer(column.type) or pa.types.is_floating(column.type)):
        raise FileError(path, f"{name}: expected numbers, got {column.type}")
    return column.to_numpy().astype(np.float64)


def as_names(path: Path, name: str, column: Column) -> tuple[str, ...]:
    """A column as text; raises `FileError` for a name that is missing or endless."""
    with errors_of(path):
        words = column.tolist() if isinstance(column, np.ndarray) else column.to_pylist()
        names = tuple("" if word is None else str(word) for word in words)
    for row, word in enumerate(names):
        if not 0 < len(word) <= MAX_NAME_LENGTH:
            got = f"expected at most {MAX_NAME_LENGTH:,} characters, got {len(word):,}" if word else "no value"
            raise row_error(path, row, f"{name}: {got}")
    return names


def _parse(path: Path, name: str, column: pa.ChunkedArray) -> np.ndarray:
    """Text as numbers: by arrow, or word by word if people wrote `+1` or a space, or something that is no number."""
    try:
        return column.cast(pa.float64()).to_numpy()
    except pa.ArrowInvalid:
        words = enumerate(word.as_py() for word in column)  # one by one: as objects they take up ten times the room
        return np.fromiter((_parse_word(path, name, row, word) for row, word in words), float, len(column))


def _parse_word(path: Path, name: str, row: int, word: str) -> float:
    try:
        return float(word)
    except ValueError:
        raise row_error(path, row, f"{name}: expected a number, got {quoted(word)}") from None
