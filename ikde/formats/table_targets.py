"""Targets from a table: one array of numbers, checked row by row before anything runs."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ikde.errors import FileError, InputError, nearest, quoted
from ikde.formats.entries import ColumnsEntry, OrientationKind, UnitsEntry, chosen_orientation
from ikde.formats.error_path import prefix_errors
from ikde.formats.poses import join_poses, make_orientation
from ikde.formats.tables import Column, Table, as_floats, as_names, open_table, row_error
from ikde.kernels.arrays import Floats
from ikde.model.target import MAX_MAGNITUDE, POSE, Targets

MAX_NUMBER = 1e9  # of a number that is no position: beyond, digits are lost
MIN_LENGTH = 1e-12  # of an axis or a quaternion


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TableSource:
    """Targets held as one array of numbers, for files of a million rows."""

    positions: Floats
    """[T, 3] m"""
    kind: OrientationKind | None
    orientations: Floats | None
    """[T, 3 or 4]: an axis, roll, pitch, yaw in rad, or a quaternion; None for position targets."""
    names: tuple[str, ...] | None = None

    @property
    def count(self) -> int:
        """Number of targets."""
        return len(self.positions)

    def read(self, first: int, last: int) -> Targets:
        """Targets first .. last - 1."""
        positions = self.positions[first:last]
        if self.kind is None or self.orientations is None:
            return Targets(positions)
        orientations = make_orientation(self.kind, self.orientations[first:last])
        if "R_world_tool" in orientations:
            return join_poses(POSE, positions, orientations["R_world_tool"])
        return Targets(positions, **orientations)


def read_targets(path: Path, columns: ColumnsEntry, units: UnitsEntry) -> TableSource:
    """Targets from a table, in m and rad.

    Raises:
        InputError: for what the table does not hold; `where` is a path inside a `FileEntry`.
        FileError: for what is wrong inside the table, with its row and column.
    """
    with prefix_errors("columns"):
        kind = chosen_orientation(columns)
    keys = ["position", *([kind] if kind else []), *(["name"] if columns.name else [])]
    table = open_table(path)
    chosen = {key: _find(table, path, columns, key) for key in keys}
    data = table.read(list(dict.fromkeys(name for names in chosen.values() for name in names)))
    _check_lengths(path, data)
    return TableSource(
        positions=_stack(path, chosen["position"], data, 3, MAX_MAGNITUDE / units.length_m) * units.length_m,
        kind=kind,
        orientations=_read_orientations(path, kind, chosen[kind], data, units) if kind else None,
        names=as_names(path, columns.name, data[columns.name]) if columns.name else None,
    )


def _find(table: Table, path: Path, columns: ColumnsEntry, key: str) -> list[str]:
    """The names that a key chooses: each must be in the table, once."""
    chosen: str | list[str] = getattr(columns, key)
    names = [chosen] if isinstance(chosen, str) else chosen
    for index, name in enumerate(names):
        where = ("columns", key) if isinstance(chosen, str) else ("columns", key, index)
        if name not in table.names:
            known = nearest(name, table.names) or f"; it has {', '.join(table.names)}"
            raise InputError(f"{path.name} has no column {quoted(name)}{known}", where)
        if table.names.count(name) > 1:
            raise InputError(f"{path.name} has more than one column {quoted(name)}", where)
    return names


def _check_lengths(path: Path, data: Mapping[str, Column]) -> None:
    lengths = {name: len(column) for name, column in data.items()}
    if len(set(lengths.values())) > 1:
        raise FileError(path, "lengths differ: " + ", ".join(f"{name} has {n}" for name, n in lengths.items()))
    if not min(lengths.values()):
        raise FileError(path, "no rows")


def _stack(path: Path, names: Sequence[str], data: Mapping[str, Column], width: int, largest: float) -> Floats:
    """The numbers of one key [T, width], from as many columns or from one array that holds them all."""
    arrays = [as_floats(path, name, data[name]) for name in names]
    wanted = width if len(names) == 1 else 1
    for name, array in zip(names, arrays, strict=True):
        got = 1 if array.ndim == 1 else array.shape[1]
        if got != wanted or array.ndim > 2:
            numbers = "number" if wanted == 1 else "numbers"
            raise FileError(path, f"{name}: expected {wanted} {numbers} a row, got shape {array.shape[1:] or (1,)}")
    values = np.column_stack(arrays)
    labels = names if len(names) == width else [f"{names[0]}[{index}]" for index in range(width)]
    for row, column in np.argwhere(~(np.abs(values) <= largest))[:1]:  # False for NaN
        message = f"expected a finite number up to {largest:g}, got {values[row, column]:g}"
        raise row_error(path, int(row), f"{labels[column]}: {message}")
    return values


def _read_orientations(
    path: Path, kind: OrientationKind, names: Sequence[str], data: Mapping[str, Column], units: UnitsEntry
) -> Floats:
    """Axes [T, 3], roll, pitch, yaw in rad [T, 3], or quaternions [T, 4]."""
    values = _stack(path, names, data, 4 if kind == "quat_wxyz" else 3, MAX_NUMBER)
    if kind == "rpy":
        return values * units.angle_rad
    for (row,) in np.argwhere(np.linalg.norm(values, axis=1) <= MIN_LENGTH)[:1]:
        raise row_error(path, int(row), f"{', '.join(names)}: a length of 0 has no direction")
    return values
