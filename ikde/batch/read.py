"""A run's answers as one table."""

from collections.abc import Iterator, Sequence
from os import PathLike
from pathlib import Path

import numpy as np
import pyarrow as pa

from ikde.batch.manifest import Manifest, read_manifest
from ikde.batch.parts import DAMAGED, SOLUTIONS, TIMING, Part, read_table
from ikde.errors import FileError
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
    kind = TIMING if timing else SOLUTIONS
    tables = [read_part(folder, part, kind) for part in list_finished(folder, read_manifest(folder))]
    if not tables:
        raise FileError(folder, "no part of this run is finished yet")
    return pa.concat_tables(tables).unify_dictionaries()


def read_verdicts(column: pa.ChunkedArray) -> MaskedBools:
    """A column of verdicts [n], masked where it is null: nothing was checked."""
    return np.ma.masked_array(column.fill_null(False).to_numpy(), mask=column.is_null().to_numpy())


def list_finished(folder: Path, manifest: Manifest) -> Iterator[Part]:
    """Parts whose solutions are there, in the order of the answers."""
    return (part for part in manifest.list_parts() if part.path(folder, SOLUTIONS).exists())


def read_part(folder: Path, part: Part, kind: str, columns: Sequence[str] | None = None) -> pa.Table:
    """One file of a part, or those of `columns` that it has."""
    path = part.path(folder, kind)
    try:
        return read_table(path, columns)
    except DAMAGED as error:
        cause = str(error).splitlines()[0]
        raise FileError(path, f"cannot be read; running the batch again redoes this part ({cause})") from None
