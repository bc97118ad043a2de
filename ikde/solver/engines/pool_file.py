"""The pool of a robot on disk, beside the module written for it: drawing it takes a tenth of a second, loading 3 ms."""

import io
from pathlib import Path
from typing import Any

import numpy as np

from ikde.kernels.arrays import SeedArrays
from ikde.kernels.cache_files import read_sealed, write_sealed


def load_pool(path: Path) -> SeedArrays | None:
    """What `save_pool` wrote, or None if there is nothing whole."""
    content = read_sealed(path)
    if content is None:
        return None
    with np.load(io.BytesIO(content)) as arrays:
        fields: dict[str, Any] = {name: arrays[name] for name in SeedArrays._fields}
    for name, array in fields.items():
        array.setflags(write=False)
        fields[name] = array if array.ndim else float(array)
    return SeedArrays(**fields)


def save_pool(path: Path, seeds: SeedArrays) -> None:
    """Write a pool, whole or not at all; not at all if the disk is full: it can be drawn again."""
    content = io.BytesIO()
    np.savez(content, allow_pickle=False, **{name: np.asarray(field) for name, field in seeds._asdict().items()})
    write_sealed(path, content.getvalue())
