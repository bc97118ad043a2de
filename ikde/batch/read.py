"""A run's answers as one table."""

from collections.abc import Iterator, Sequence
from os import PathLike
from pathlib import Path

import numpy as np
import pyarrow as pa

from ikde.batch.check_part import check_part
from ikde.batch.manifest import Manifest, read_manifest
from ikde.batch.parts import SOLUTIONS, TIMING, Part, read_table
from ikde.errors import FileError
from ikde.formats.reading import errors_of
from ikde.solver.verify import MaskedBools


def read_batch(folder: str | PathLike[str], timing: bool = False) -> pa.Table:
    """The answers of a run, finished or not, as a pyarrow table: by arm, target and repeat.

    Args:
        folder: where `run_batch` wrote.
        timing: the seconds and host of each solve instead of its solution.

    Raises:
        FileError: for a folder that is no run, has no finished part yet, or holds a part that is damaged.
    """
    folder = Path(folder)
    kind, manifest = TIMING if timing else SOLUTIONS, read_manifest(folder)
    tables = [read_part(folder, manifest, part, kind) for part in list_finished(folder, manifest)]
    if not tables:
        raise FileError(folder, "no part of this run is finished yet")
    with errors_of(folder):  # parts that are not ours may have different columns
        return pa.concat_tables(tables).unify_dictionaries()


def read_verdicts(column: pa.ChunkedArray) -> MaskedBools:
    """A column of verdicts [n], masked where it is null: nothing was checked."""
    return np.ma.masked_array(column.fill_null(False).to_numpy(), mask=column.is_null().to_numpy())


def list_finished(folder: Path, manifest: Manifest) -> Iterator[Part]:
    """Parts whose solutions are there, in the order of the answers."""
    return (part for part in manifest.list_parts() if part.path(folder, SOLUTIONS).exists())


def read_part(
    folder: Path, manifest: Manifest, part: Part, kind: str, columns: Sequence[str] | None = None
) -> pa.Table:
    """One file of a part, or those of `columns` that it has; raises `FileError` if it is not what the run makes."""
    path = part.path(folder, kind)
    try:
        table = read_table(path, columns)
    except FileError as error:
        cause = error.message.removeprefix("cannot be read: ")
        raise FileError(path, f"cannot be read; running the batch again redoes this part ({cause})") from None
    check_part(path, manifest, part, kind, table, columns)
    return table
