"""Tables: CSV, Parquet and NPZ files as columns by name. What is wrong with a file is a `FileError` in one line."""

import csv
import zipfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import pyarrow as pa
import pyarrow.csv as pa_csv
import pyarrow.parquet as pq

from ikde.errors import FileError, InputError

Column = pa.ChunkedArray | np.ndarray
"""[T], from arrow or numpy; of an NPZ file also [T, 3] or [T, 4]."""


class Table(Protocol):
    """A file of columns."""

    names: list[str]

    def read(self, names: Sequence[str]) -> dict[str, Column]:
        """Columns by name."""
        ...


class CsvTable:
    """A CSV file; its first line names the columns."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._ragged: FileError | None = None
        with path.open(encoding="utf-8-sig", newline="") as file:
            self.names = next(csv.reader(file), [])
        if not self.names:
            raise FileError(path, "the first line is empty; expected the names of the columns")

    def read(self, names: Sequence[str]) -> dict[str, Column]:
        """Columns as text: types guessed from a file's beginning may not fit its end."""
        read = pa_csv.ReadOptions(use_threads=False)  # only then are rows numbered
        parse = pa_csv.ParseOptions(invalid_row_handler=self._refuse)
        convert = pa_csv.ConvertOptions(include_columns=list(names), column_types=dict.fromkeys(names, pa.string()))
        try:
            table = pa_csv.read_csv(self._path, read_options=read, parse_options=parse, convert_options=convert)
        except pa.ArrowInvalid:
            if self._ragged:
                raise self._ragged from None
            raise
        return {name: table.column(name) for name in names}

    def _refuse(self, row: Any) -> str:
        """Arrow lets no exception through, so it is kept."""
        message = f"expected {row.expected_columns} values, got {row.actual_columns}"
        self._ragged = row_error(self._path, row.number - 2, message)
        return "error"


class ParquetTable:
    """A Parquet file."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self.names: list[str] = pq.read_schema(path).names

    def read(self, names: Sequence[str]) -> dict[str, Column]:
        """Columns in their own types."""
        with pq.ParquetFile(self._path) as file:
            table = file.read(columns=list(names))
        return {name: table.column(name) for name in names}


class NpzTable:
    """An NPZ file: named arrays."""

    def __init__(self, path: Path) -> None:
        self._path = path
        with path.open("rb") as file:
            if not zipfile.is_zipfile(file):
                raise FileError(path, "not an NPZ file")
        with np.load(path, allow_pickle=False) as arrays:
            self.names: list[str] = list(arrays.files)

    def read(self, names: Sequence[str]) -> dict[str, Column]:
        """Arrays as they are."""
        with np.load(self._path, allow_pickle=False) as arrays:
            return {name: np.atleast_1d(arrays[name]) for name in names}


READERS = {".csv": CsvTable, ".parquet": ParquetTable, ".npz": NpzTable}


def open_table(path: Path) -> Table:
    """The table in a file; raises `InputError` for a file that is missing or of another kind, at `path`."""
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise InputError(f"expected a file that ends in {', '.join(READERS)}, got {path.name!r}", ("path",))
    if not path.is_file():
        raise InputError(f"this is a folder: {path}" if path.is_dir() else f"no such file: {path}", ("path",))
    return reader(path)


@contextmanager
def errors_of(path: Path) -> Iterator[None]:
    """Turn whatever the readers raise into a `FileError` in one line."""
    try:
        yield
    except (OSError, ValueError, pa.ArrowException, csv.Error, zipfile.BadZipFile) as error:
        text = str(getattr(error, "strerror", None) or error).partition("\n")[0]
        raise FileError(path, f"cannot be read: {text}") from None


def row_error(path: Path, row: int, message: str) -> FileError:
    """What is wrong with a row; people count from 1 and not the header, `row` from 0."""
    return FileError(path, f"row {row + 1}: {message}")


def as_floats(path: Path, name: str, column: Column) -> np.ndarray:
    """A column as float64, of the same shape; raises `FileError` with row and column for text and missing values."""
    if isinstance(column, np.ndarray):
        if column.dtype.kind not in "fiu":
            raise FileError(path, f"{name}: expected numbers, got {column.dtype}")
        return column.astype(np.float64)
    if column.null_count:
        raise row_error(path, column.is_null().to_pylist().index(True), f"{name}: no value")
    if pa.types.is_string(column.type) or pa.types.is_large_string(column.type):
        return _parse(path, name, column)
    if not (pa.types.is_integer(column.type) or pa.types.is_floating(column.type)):
        raise FileError(path, f"{name}: expected numbers, got {column.type}")
    return column.to_numpy().astype(np.float64)


def as_names(path: Path, name: str, column: Column) -> tuple[str, ...]:
    """A column as text; raises `FileError` for a name that is missing."""
    words = column.tolist() if isinstance(column, np.ndarray) else column.to_pylist()
    for row, word in enumerate(words):
        if word is None or word == "":
            raise row_error(path, row, f"{name}: no value")
    return tuple(map(str, words))


def _parse(path: Path, name: str, column: pa.ChunkedArray) -> np.ndarray:
    """Text as numbers: by arrow, or word by word if people wrote `+1` or a space, or something that is no number."""
    try:
        return column.cast(pa.float64()).to_numpy()
    except pa.ArrowInvalid:
        return np.array([_parse_word(path, name, row, word) for row, word in enumerate(column.to_pylist())])


def _parse_word(path: Path, name: str, row: int, word: str) -> float:
    try:
        return float(word)
    except ValueError:
        raise row_error(path, row, f"{name}: expected a number, got {word!r}") from None
