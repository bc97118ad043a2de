"""Point clouds from files: NPY, NPZ, CSV, PLY and PCD; read within limits, as numbers alone."""

from collections.abc import Callable
from pathlib import Path

import numpy as np

from ikde.errors import FileError, InputError, quoted
from ikde.formats.npz import NpzTable, parse_npy
from ikde.formats.reading import errors_of, read_bytes
from ikde.formats.tables import as_floats, open_table
from ikde.io.cloud_layout import AXES, check_count, read_pcd, read_ply
from ikde.kernels.arrays import Floats


def read_cloud(folder: Path, name: str, array: str | None = None) -> Floats:
    """Points [K, 3] of a file inside a folder, in the file's unit; some may be NaN.

    Raises:
        InputError: for a path that leads out of the folder, or that no reader knows.
        FileError: for what is inside; more than `MAX_CLOUD_POINTS` are refused before room is made for them.
    """
    path = find_inside(folder, name)
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise InputError(f"expected a file that ends in {', '.join(READERS)}, got {quoted(name)}")
    return reader(path, array)


def find_inside(folder: Path, name: str) -> Path:
    """A file inside a folder: what leads out of it, by `..` or a link, is refused."""
    try:
        root = folder.resolve()
        path = (root / name).resolve()
    except (OSError, ValueError, RuntimeError) as error:
        reason = getattr(error, "strerror", None) or "no path"
        raise InputError(f"{quoted(name)} cannot be looked for: {reason}") from None
    if not path.is_relative_to(root):
        raise InputError(f"expected a file inside the folder of this one, got {quoted(name)}")
    return path


def _read_npy(path: Path, array: str | None) -> Floats:
    data = read_bytes(path)
    with errors_of(path):
        try:
            return _to_points(path, parse_npy(data))
        except ValueError as error:
            raise FileError(path, str(error)) from None


def _read_npz(path: Path, array: str | None) -> Floats:
    table = NpzTable(path, read_bytes(path))
    names = [array] if array is not None else table.names
    if len(names) != 1 or names[0] not in table.names:
        known = ", ".join(table.names) or "none"
        raise FileError(path, f"expected one array, or the key `array` to name one of {known}")
    return _to_points(path, table.read(names)[names[0]])


def _to_points(path: Path, values: np.ndarray) -> Floats:
    if values.ndim != 2 or values.shape[1] != 3:
        raise FileError(path, f"expected points [K, 3], got shape {values.shape}")
    check_count(path, len(values))
    return as_floats(path, "points", values)


def _read_csv(path: Path, array: str | None) -> Floats:
    try:
        table = open_table(path)
    except FileError:
        raise
    except InputError as error:
        raise FileError(path, error.message.removesuffix(f": {path}")) from None
    missing = [axis for axis in AXES if axis not in table.names]
    if missing:
        raise FileError(path, f"expected columns x, y, z, got {', '.join(map(quoted, table.names[:10]))}")
    columns = table.read(AXES)
    return np.column_stack([as_floats(path, axis, columns[axis]) for axis in AXES])


READERS: dict[str, Callable[[Path, str | None], Floats]] = {
    ".npz": _read_npz,
    ".npy": _read_npy,
    ".csv": _read_csv,
    ".ply": lambda path, array: read_ply(path),
    ".pcd": lambda path, array: read_pcd(path),
}
