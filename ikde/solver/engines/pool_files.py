"""Pools of seeds as files: the numbers of the draws kept, 0.2 to 13 kB where the configurations are 0.1 to 6 MB.

Those of ikde's own robots come with it (`benchmarks/ship_pools.py` makes them); others lie in the cache folder.
"""

import zlib
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ikde.kernels import cache_folder
from ikde.kernels.arrays import Floats, Ints
from ikde.kernels.cache_files import read_sealed, unseal, write_sealed
from ikde.model.generate.module import robots_folder

SHIPPED = Path(__file__).with_name("pools")
MAX_DRAW = 2**21  # beyond the numbers of all draws that are made


class Kept(NamedTuple):
    """All of a pool that cannot be computed from what it was drawn for in a moment."""

    numbers: Ints  # [K] of draws, growing
    scale: Floats  # [G, 2] of the grid: lowest value, bins per unit


def load_shipped(name: str, directions: int) -> Kept | None:
    """The pool that comes with ikde under a name, or None."""
    path = SHIPPED / name
    content = unseal(path, path.read_bytes()) if path.is_file() else None
    return None if content is None else read_kept(content, directions)


def load_cached(name: str, directions: int) -> Kept | None:
    """The pool that `save_cached` wrote, or None if there is nothing whole."""
    content = read_sealed(robots_folder() / name) if cache_folder.CACHE_IS_WRITABLE else None
    return None if content is None else read_kept(content, directions)


def save_cached(name: str, kept: Kept) -> None:
    """Write a pool, whole or not at all; not at all if the disk is full: it can be drawn again."""
    if cache_folder.CACHE_IS_WRITABLE:
        write_sealed(robots_folder() / name, write_kept(kept))


def write_kept(kept: Kept) -> bytes:
    """The scale, then a bit for each draw, packed."""
    bits = np.zeros(kept.numbers.max(initial=-1) + 1, dtype=bool)
    bits[kept.numbers] = True
    return kept.scale.tobytes() + zlib.compress(np.packbits(bits).tobytes(), 9)


def read_kept(content: bytes, directions: int) -> Kept | None:
    """What `write_kept` wrote for a grid of so many directions, or None for anything else."""
    size, unpacker = 16 * directions, zlib.decompressobj()
    try:
        bits = unpacker.decompress(content[size:], MAX_DRAW // 8)
    except zlib.error:
        return None
    scale = np.frombuffer(content[:size]).reshape(-1, 2) if unpacker.eof else np.empty(0)
    if len(scale) != directions or not np.isfinite(scale).all():
        return None
    return Kept(numbers=np.flatnonzero(np.unpackbits(np.frombuffer(bits, dtype=np.uint8))), scale=scale.copy())
