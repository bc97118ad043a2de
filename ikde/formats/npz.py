"""NPZ files: archives of arrays, whose claims about their size are checked before anything is unpacked."""

import math
import warnings
import zipfile
from collections.abc import Sequence
from functools import partial
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from ikde.errors import FileError, quoted
from ikde.formats.reading import check_room, errors_of

ENDING = ".npy"
PACKINGS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
MAX_SHRUNK = 1040  # deflate shrinks nothing to less than 1 / 1032
MAX_LISTED = 2**22  # bytes of an archive's list of members
MAX_HEADER = 10_000  # bytes of an array's
READERS = {1: np.lib.format.read_array_header_1_0, 2: np.lib.format.read_array_header_2_0}
KINDS = "biufcSU"  # of numbers and text
PIECE = 2**20


class _Archive(BytesIO):
    """The bytes of an archive; what is read at once is small, but for the list of its members."""

    def read(self, size: int | None = -1, /) -> bytes:
        if size is not None and size > MAX_LISTED:
            raise zipfile.BadZipFile("too many members")
        return super().read(size)


class NpzTable:
    """An NPZ file: named arrays."""

    def __init__(self, path: Path, data: bytes) -> None:
        self._path = path
        with errors_of(path):
            self._archive = zipfile.ZipFile(_Archive(data))
            self._members = [member for member in self._archive.infolist() if member.filename.endswith(ENDING)]
        self.names: list[str] = [member.filename.removesuffix(ENDING) for member in self._members]

    def read(self, names: Sequence[str]) -> dict[str, np.ndarray]:
        """Arrays as they are."""
        chosen = {name: self._members[self.names.index(name)] for name in names}
        check_room(self._path, sum(member.file_size for member in chosen.values()), "arrays")
        return {name: np.atleast_1d(self._read(name, member)) for name, member in chosen.items()}

    def _read(self, name: str, member: zipfile.ZipInfo) -> np.ndarray:
        if member.compress_type not in PACKINGS or member.flag_bits & 1:
            raise FileError(self._path, f"{name}: expected an array that is stored or deflated, and not encrypted")
        if member.file_size > MAX_SHRUNK * member.compress_size:
            raise FileError(self._path, f"{name}: cannot be read: {member.file_size:,} bytes do not fit into the file")
        with errors_of(self._path):
            with self._archive.open(member) as file:
                contents = b"".join(iter(partial(file.read, PIECE), b""))
            try:
                return parse_npy(contents)
            except ValueError as error:
                raise FileError(self._path, f"{name}: {error}") from None


def parse_npy(contents: bytes) -> np.ndarray:
    """The array in an NPY file, read-only; raises `ValueError` for all but numbers and text of the size they claim."""
    file = BytesIO(contents)
    kind, is_fortran, shape = _read_header(file)
    if kind.kind not in KINDS:  # no objects, which are pickles, and no records
        raise ValueError(f"expected numbers or text, got {quoted(kind)}")
    size = len(contents) - file.tell()
    if math.prod(shape) * kind.itemsize != size or not kind.itemsize or min(shape, default=0) < 0:
        raise ValueError(f"its {size:,} bytes are no array of shape {quoted(shape)}")
    flat = np.frombuffer(contents, kind, math.prod(shape), file.tell())
    return flat.reshape(shape, order="F" if is_fortran else "C")


def _read_header(file: BytesIO) -> tuple[np.dtype[Any], bool, tuple[int, ...]]:
    """Type, order and shape, as numpy reads them."""
    try:
        major, _ = np.lib.format.read_magic(file)
        with warnings.catch_warnings(action="ignore"):
            shape, is_fortran, kind = READERS[major](file, max_header_size=MAX_HEADER)
    except Exception:
        raise ValueError("not an array of numpy, or its header is damaged") from None
    return kind, is_fortran, shape
