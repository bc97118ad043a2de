"""Whether a part holds what its run makes: pages and summaries count on it, and the files are not trusted."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa

from ikde.batch.manifest import Manifest
from ikde.batch.parts import SOLUTIONS, TIMING, Part
from ikde.errors import FileError
from ikde.solver.columns import WORDS

ALWAYS = {
    SOLUTIONS: ("arm", "target", "repeat", "reached", "collision", "verified", "stop_reason"),
    TIMING: ("arm", "target", "repeat", "solve_seconds", "host"),
}
WORDY = (
    *("arm", "world", "target_name", "stop_reason", "pair_a", "pair_b", "blocker_a", "blocker_b"),
    *("reason", "hint", "target_kind", "host"),
)
VERDICTS = ("collision", "verified")  # and `<grader>_collides`: null where nothing was checked
MAX_WORD_LENGTH = 5000  # characters
MAX_NUMBER = 1e12  # of a number


def check_part(
    path: Path, manifest: Manifest, part: Part, kind: str, table: pa.Table, columns: Sequence[str] | None
) -> None:
    """Raise `FileError` with what is wrong first in a file of a part, read whole or those of `columns` that it has."""
    for complaint in _find_faults(manifest, part, kind, table, columns):
        raise FileError(path, f"is no part of this run: {complaint}")


def _find_faults(
    manifest: Manifest, part: Part, kind: str, table: pa.Table, columns: Sequence[str] | None
) -> Iterator[str]:
    required = _required(manifest, kind)
    missing = [name for name in required if name not in table.column_names and (columns is None or name in columns)]
    if missing:
        yield f"it has no column {missing[0]}"
    if len(set(table.column_names)) < table.num_columns:
        yield "it has a column twice"
    if len(table) != part.rows:
        yield f"it has {len(table):,} rows, not {part.rows:,}"
    for name in table.column_names:
        column = table[name]
        if not _is_of_kind(name, column.type):
            yield f"{name} holds {column.type}"
        if name in required and not _is_verdict(name) and column.null_count:
            yield f"{name} has no value in some row"
        yield from _find_wrong_values(name, column, manifest, part)


def verdict_columns(graders: Sequence[str]) -> list[str]:
    """Columns that are null where nothing was checked."""
    return [*VERDICTS, *(f"{grader}_collides" for grader in graders)]


def _required(manifest: Manifest, kind: str) -> list[str]:
    graded = [f"{grader}_collides" for grader in manifest.graders] if kind == SOLUTIONS else []
    placed = ["world"] if kind == SOLUTIONS and manifest.has_worlds else []
    return [*ALWAYS[kind], *placed, *graded]


def _is_verdict(name: str) -> bool:
    return name in VERDICTS or name.endswith("_collides")


def _is_of_kind(name: str, kind: pa.DataType) -> bool:
    """Words come by their numbers, as they are written: a long one that is there often takes little room."""
    if name in WORDY or name.endswith(("_pair_a", "_pair_b")):
        return pa.types.is_dictionary(kind) and pa.types.is_string(kind.value_type)
    if name == "reached" or _is_verdict(name):
        return pa.types.is_boolean(kind)
    if name in ("target", "repeat", "attempts", "poses", "alternative", "blocked"):
        return pa.types.is_integer(kind)
    return pa.types.is_integer(kind) or pa.types.is_float64(kind)


def _find_wrong_values(name: str, column: pa.ChunkedArray, manifest: Manifest, part: Part) -> Iterator[str]:
    if pa.types.is_dictionary(column.type):
        words = {word for chunk in column.chunks for word in chunk.dictionary.to_pylist()}
        if max((len(word or "") for word in words), default=0) > MAX_WORD_LENGTH:
            yield f"{name} holds words of more than {MAX_WORD_LENGTH:,} characters"
        known = {"arm": [part.arm], "world": [manifest.world_of(part.arm)], "stop_reason": WORDS}.get(name)
        if known and not words <= set(known):
            yield f"{name} holds words that are not among its own"
        return
    solves = np.arange(part.first, part.last)
    expected = {"target": solves // manifest.repeats, "repeat": solves % manifest.repeats}.get(name)
    if expected is not None and not np.array_equal(column.to_numpy(), expected):
        yield f"{name} counts other solves than this part's"
    if pa.types.is_floating(column.type):
        numbers = column.to_numpy()
        if np.abs(numbers[np.isfinite(numbers)]).max(initial=0.0) > MAX_NUMBER:
            yield f"{name} holds numbers beyond {MAX_NUMBER:g}"
