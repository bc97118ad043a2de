"""Meshes written as text, OBJ and STL, as triangles: every face counts, or the file is refused with its line."""

from array import array
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np

from ikde.errors import FileError, quoted
from ikde.kernels.arrays import Floats

FACES = ("f", "fo")
REFUSED = {"surf": "a free-form surface", "call": "another file", "csh": "a command"}
"""Statements of an OBJ whose surface would be missing."""


def read_obj(path: Path, text: str) -> Floats:
    """The faces of an OBJ as triangles [F, 3, 3], polygons as fans about their first corners.

    Indices count from 1 on, or back from the last corner before the face if they are negative. Lines, points, materials
    and texture are passed over.

    Raises:
        FileError: with its line for a corner that there is not, no numbers, and what is a surface of another kind.
    """
    corners, faces, lines = array("d"), array("q"), array("q")
    for number, words in _split(text, "\\"):
        kind = words[0]
        if kind == "v":
            corners.extend(_read_corner(path, words, number))
        elif kind in FACES:
            known = len(corners) // 3
            fan = [_read_index(path, word, known, number) for word in words[1:]]
            for second, third in pairwise(fan[1:]):
                faces.extend((fan[0], second, third))
                lines.append(number)
        elif kind in REFUSED:
            raise FileError(path, f"{REFUSED[kind]} is not read ({kind!r}); give the mesh as triangles", line=number)
    points, indices = np.array(corners).reshape(-1, 3), np.array(faces, dtype=np.int64).reshape(-1, 3)
    beyond = np.flatnonzero((indices >= len(points)).any(axis=1))
    if len(beyond):
        message = f"expected corners 1 to {len(points):,}, got {int(indices[beyond[0]].max()) + 1:,}"
        raise FileError(path, message, line=lines[int(beyond[0])])
    return points[indices]


def read_text_stl(path: Path, text: str) -> Floats:
    """The facets of an STL that is text as triangles [F, 3, 3].

    Raises:
        FileError: with its line for what is no corner, facets that have not three, and a file that breaks off.
    """
    corners, facets, open_solids, number = array("d"), 0, 0, 0
    for number, words in _split(text):
        kind = words[0].lower()
        if kind == "vertex":
            corners.extend(_read_corner(path, words, number))
        elif kind == "facet":
            facets += 1
        elif kind in ("solid", "endsolid"):
            open_solids += 1 if kind == "solid" else -1
        if kind in ("facet", "endfacet", "endsolid") and len(corners) != 9 * (facets - (kind == "facet")):
            raise FileError(path, "expected three corners of a facet before this line", line=number)
    if open_solids or len(corners) != 9 * facets:
        raise FileError(path, "is no STL that can be read: it breaks off before endsolid", line=number or None)
    return np.array(corners).reshape(-1, 3, 3)


def _split(text: str, goes_on: str = "") -> Iterator[tuple[int, list[str]]]:
    """Numbers of lines with their words, comments left out; one that ends with `goes_on` goes on in the next."""
    before: list[str] = []
    for number, line in enumerate(text.splitlines(), 1):
        words = before + line.partition("#")[0].split()
        before = []
        if goes_on and words and words[-1].endswith(goes_on):
            words[-1] = words[-1].removesuffix(goes_on)
            before = [word for word in words if word]
        elif words:
            yield number, words


def _read_corner(path: Path, words: list[str], number: int) -> tuple[float, float, float]:
    """Three numbers; what may stand behind them in an OBJ, a weight or a colour, is passed over."""
    try:
        x, y, z = map(float, words[1:4])
    except ValueError:
        raise FileError(path, f"expected three numbers, got {quoted(' '.join(words[1:4]))}", line=number) from None
    return x, y, z


def _read_index(path: Path, word: str, known: int, number: int) -> int:
    """The place of a corner of a face, from 0 on: the first number of `1/2/3`."""
    try:
        index = int(word.partition("/")[0])
    except ValueError:
        index = 0
    place = index - 1 if index > 0 else known + index
    if index == 0 or not 0 <= place < 2**62:
        raise FileError(path, f"expected the number of a corner, got {quoted(word)}", line=number)
    return place
