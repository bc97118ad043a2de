"""NPZ files: archives of arrays, whose claims about their size are checked before anything is unpacked."""

import ast
import math
import re
import warnings
import zipfile
from collections.abc import Sequence
from functools import partial
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from ikde.errors import FileError, quoted
from ikde.files.reading import errors_of, expect_at_most, most_bytes

ENDING, MAGIC = ".npy", b"\x93NUMPY"
PACKINGS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
MAX_SHRINKAGE = 1040  # deflate shrinks nothing to less than 1 / 1032
MAX_LISTED = 2**22  # bytes of an archive's list of members
LONGEST_HEADER = 10_000  # bytes of an array's
PLAIN_TYPE = re.compile(r"[<>|=]?[biufcSU]\d{1,6}")  # no objects, which are pickles, and no records
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
        size, most = sum(member.file_size for member in chosen.values()), most_bytes()
        if size > most:
            raise FileError(self._path, f"its arrays would take up {size / 1e6:,.0f} MB; {expect_at_most(most)}")
        return {name: np.atleast_1d(self._read(name, member)) for name, member in chosen.items()}

    def _read(self, name: str, member: zipfile.ZipInfo) -> np.ndarray:
        if member.compress_type not in PACKINGS or member.flag_bits & 1:
            raise FileError(self._path, f"{name}: expected an array that is stored or deflated, and not encrypted")
        if member.file_size > MAX_SHRINKAGE * member.compress_size:
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
    if contents[:6] != MAGIC or contents[6:7] not in (b"\1", b"\2", b"\3"):
        raise ValueError("not an array of numpy")
    begin = 10 if contents[6] == 1 else 12
    start = begin + int.from_bytes(contents[8:begin], "little")
    if start - begin > LONGEST_HEADER:
        raise ValueError("not an array of numpy: its header is too long")
    kind, is_fortran, shape = _parse_header(contents[begin:start])
    if math.prod(shape) * kind.itemsize != len(contents) - start or not kind.itemsize:
        raise ValueError(f"its {max(len(contents) - start, 0):,} bytes are no array of shape {quoted(shape)}")
    flat = np.frombuffer(contents, kind, math.prod(shape), start)
    return flat.reshape(shape, order="F" if is_fortran else "C")


def _parse_header(header: bytes) -> tuple[np.dtype[Any], bool, tuple[int, ...]]:
    """Type, order and shape: a dictionary as Python writes it, of plain constants."""
    try:
        with warnings.catch_warnings(action="ignore"):
            header_values = ast.literal_eval(header.decode("utf-8").strip())
        word, is_fortran, shape = header_values["descr"], header_values["fortran_order"], header_values["shape"]
    except (ValueError, SyntaxError, TypeError, KeyError, RecursionError, MemoryError):
        raise ValueError("not an array of numpy: its header is damaged") from None
    if not (isinstance(word, str) and PLAIN_TYPE.fullmatch(word)):
        raise ValueError(f"expected numbers or text, got {quoted(word)}")
    if not (isinstance(shape, tuple) and all(type(length) is int and length >= 0 for length in shape)):
        raise ValueError(f"not an array of numpy: its shape is {quoted(shape)}")
    try:
        return np.dtype(word), bool(is_fortran), shape
    except (TypeError, ValueError):
        raise ValueError(f"expected numbers or text, got {quoted(word)}") from None
