"""The pool of a robot on disk, beside the module written for it: drawing it takes a tenth of a second, loading 3 ms."""

import io
import zipfile
import zlib
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from ikde.kernels.arrays import SeedArrays
from ikde.model.generate.module import write_whole


def load_pool(path: Path) -> SeedArrays | None:
    """What `save_pool` wrote, or None if there is nothing whole."""
    try:
        with path.open("rb") as file, np.load(file) as arrays:
            fields: dict[str, Any] = {name: arrays[name] for name in SeedArrays._fields}
    except (OSError, EOFError, KeyError, ValueError, RuntimeError, zipfile.BadZipFile, zlib.error):
        return None
    for name, array in fields.items():
        array.setflags(write=False)
        fields[name] = array if array.ndim else float(array)
    return SeedArrays(**fields)


def save_pool(path: Path, seeds: SeedArrays) -> None:
    """Write a pool, whole or not at all; not at all if the disk is full: it can be drawn again."""
    content = io.BytesIO()
    np.savez(content, allow_pickle=False, **{name: np.asarray(field) for name, field in seeds._asdict().items()})
    with suppress(OSError):
        write_whole(path, content.getvalue())
