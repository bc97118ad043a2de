"""Points of PLY and PCD files: a header says what the numbers behind it are, as text or packed."""

import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ikde.errors import FileError, quoted
from ikde.formats.reading import check_room, errors_of, read_bytes
from ikde.kernels.arrays import Floats
from ikde.model.solids import MAX_CLOUD_POINTS

MAX_HEADER = 10_000  # bytes
MAX_FIELDS = 1_000  # numbers a point
PIECE = 2**23  # bytes of text that are parsed at a time
PLY_TYPES = {
    **dict.fromkeys(("char", "int8"), "i1"),
    **dict.fromkeys(("uchar", "uint8"), "u1"),
    **dict.fromkeys(("short", "int16"), "i2"),
    **dict.fromkeys(("ushort", "uint16"), "u2"),
    **dict.fromkeys(("int", "int32"), "i4"),
    **dict.fromkeys(("uint", "uint32"), "u4"),
    **dict.fromkeys(("float", "float32"), "f4"),
    **dict.fromkeys(("double", "float64"), "f8"),
}
PCD_TYPES = {"F": ("4", "8"), "I": ("1", "2", "4", "8"), "U": ("1", "2", "4", "8")}
ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
PCD_FORMS = {"ascii": "", "binary": "<", "binary_compressed": "<"}
AXES = ("x", "y", "z")


@dataclass(frozen=True, slots=True)
class Layout:
    """What the numbers of a file are."""

    fields: list[tuple[str, str, int]]
    """Name, numpy's type and how many of them, in their order."""
    count: int
    """Of points."""
    order: str
    """`<` or `>` for packed numbers, nothing for text."""
    start: int
    """Byte where they begin."""
    is_compressed: bool = False
    """True for fields one after the other, compressed together by LZF behind two sizes."""


def read_ply(path: Path) -> Floats:
    """Vertices [K, 3] of a PLY file, text or packed."""
    data = read_bytes(path)
    return _read_points(path, data, _read_ply_header(path, data))


def read_pcd(path: Path) -> Floats:
    """Points [K, 3] of a PCD file, text or packed; a viewpoint moves none."""
    data = read_bytes(path)
    return _read_points(path, data, _read_pcd_header(path, data))


def check_count(path: Path, count: int) -> None:
    """Refuse too many points, and none."""
    if not 1 <= count <= MAX_CLOUD_POINTS:
        raise FileError(path, f"expected from 1 to {MAX_CLOUD_POINTS:,} points, got {count:,}")


def _read_ply_header(path: Path, data: bytes) -> Layout:
    head, start = _cut_header(path, data, "end_header")
    lines = [words for line in head if (words := line.split())]
    if not lines or lines[0] != ["ply"]:
        raise FileError(path, "not PLY: its first line is not `ply`")
    form, fields, count, element = "", [], None, ""
    for words in lines:
        if words[0] == "format" and len(words) > 1:
            form = words[1]
        elif words[0] == "element" and len(words) == 3:
            element = words[1]
            if element == "vertex":
                count = _read_count(path, words[2])
            elif count is None:
                raise FileError(path, f"expected the vertices first, got {quoted(element)}")
        elif words[0] == "property" and element == "vertex":
            if len(words) != 3 or words[1] not in PLY_TYPES:
                raise FileError(path, f"expected a property of one number, got {quoted(' '.join(words))}")
            fields.append((words[2], PLY_TYPES[words[1]], 1))
    if form not in ORDERS:
        raise FileError(path, f"expected a format of {', '.join(ORDERS)}, got {quoted(form)}")
    if count is None:
        raise FileError(path, "expected vertices, got none")
    return Layout(fields, count, ORDERS[form], start)


def _read_pcd_header(path: Path, data: bytes) -> Layout:
    head, start = _cut_header(path, data, "DATA")
    known = {words[0]: words[1:] for line in head if (words := line.split()) and not words[0].startswith("#")}
    names, sizes, kinds = (known.get(key, []) for key in ("FIELDS", "SIZE", "TYPE"))
    counts = known.get("COUNT", ["1"] * len(names))
    if not names or not len(names) == len(sizes) == len(kinds) == len(counts):
        raise FileError(path, "expected FIELDS, SIZE, TYPE and COUNT of one length")
    fields = []
    for name, size, kind, many in zip(names, sizes, kinds, counts, strict=True):
        if size not in PCD_TYPES.get(kind, ()) or many not in map(str, range(1, MAX_FIELDS)):
            raise FileError(path, f"expected numbers, got {quoted(f'{many} {kind}{size}')} as {quoted(name)}")
        fields.append((name, f"{kind.lower()}{size}", int(many)))
    form = " ".join(known.get("DATA", []))
    if form not in PCD_FORMS:
        raise FileError(path, f"expected data of {', '.join(PCD_FORMS)}, got {quoted(form)}")
    count = _read_count(path, " ".join(known.get("POINTS", [])))
    return Layout(fields, count, PCD_FORMS[form], start, is_compressed=form == "binary_compressed")


def _cut_header(path: Path, data: bytes, last: str) -> tuple[list[str], int]:
    """The header's lines, the last of which begins with a word, and where what follows begins."""
    start = 0
    while start < min(len(data), MAX_HEADER):
        end = data.find(b"\n", start, start + MAX_HEADER)
        if end < 0:
            break
        if data[start:end].split(b" ")[0].strip() == last.encode():
            return data[:end].decode("ascii", errors="replace").splitlines(), end + 1
        start = end + 1
    raise FileError(path, f"expected a header that ends in a line with {last}")


def _read_count(path: Path, word: str) -> int:
    if not (word.isascii() and word.isdigit() and len(word) <= 12):
        raise FileError(path, f"expected a number of points, got {quoted(word)}")
    check_count(path, int(word))
    return int(word)


def _read_points(path: Path, data: bytes, layout: Layout) -> Floats:
    """Points [K, 3] of text or packed numbers."""
    singles = [name for name, _, many in layout.fields if many == 1]
    width = sum(many for _, _, many in layout.fields)
    if any(singles.count(axis) != 1 for axis in AXES) or width > MAX_FIELDS:
        names = ", ".join(quoted(name) for name, _, _ in layout.fields[:10])
        raise FileError(path, f"expected fields x, y, z, each once, got {names or 'none'}")
    if layout.is_compressed:
        return _unpack_fields(path, data, layout)
    if layout.order:
        return _unpack(path, data, layout)
    numbers = _read_words(path, data, layout.start, width * layout.count)
    if numbers is None:
        raise FileError(path, f"cannot be read: {layout.count:,} points do not fit into the file")
    starts = {name: sum(many for _, _, many in layout.fields[:k]) for k, (name, _, _) in enumerate(layout.fields)}
    return numbers.reshape(layout.count, width)[:, [starts[axis] for axis in AXES]]


def _read_words(path: Path, data: bytes, start: int, count: int) -> Floats | None:
    """So many numbers [count] in words, or None for fewer; piece by piece, since short words are large numbers."""
    check_room(path, 8 * count)
    numbers, filled = np.empty(count), 0
    while filled < count and start < len(data):
        end = len(data) if len(data) - start <= PIECE else data.rfind(b"\n", start, start + PIECE)
        if end < 0:
            raise FileError(path, f"expected lines of at most {PIECE:,} bytes")
        if not data[start:end].isspace():
            with errors_of(path), warnings.catch_warnings():
                warnings.simplefilter("error")
                some = np.fromstring(data[start:end], dtype=float, sep=" ")[: count - filled]
            numbers[filled : filled + len(some)] = some
            filled += len(some)
        start = end + 1
    return numbers if filled == count else None


def _unpack(path: Path, data: bytes, layout: Layout) -> Floats:
    kind = np.dtype([(f"{k}", layout.order + form, (many,)) for k, (_, form, many) in enumerate(layout.fields)])
    if len(data) - layout.start < layout.count * kind.itemsize:
        raise FileError(path, f"cannot be read: {layout.count:,} points do not fit into the file")
    packed = np.frombuffer(data, dtype=kind, count=layout.count, offset=layout.start)
    places = {name: f"{k}" for k, (name, _, _) in enumerate(layout.fields)}
    points = np.empty((layout.count, 3))
    for axis, name in enumerate(AXES):
        with np.errstate(invalid="ignore"):
            points[:, axis] = packed[places[name]][:, 0]
    return points


def _unpack_fields(path: Path, data: bytes, layout: Layout) -> Floats:
    kinds = [np.dtype((layout.order + form, (many,))) for _, form, many in layout.fields]
    size = layout.count * sum(kind.itemsize for kind in kinds)
    check_room(path, size)
    body = layout.start + 8
    sizes = np.frombuffer(data[layout.start : body], dtype="<u4")
    if len(sizes) < 2 or sizes[1] != size or sizes[0] > len(data) - body:
        raise FileError(path, f"cannot be read: {layout.count:,} points do not fit into the file")
    try:
        flat = unpack_lzf(memoryview(data)[body : body + int(sizes[0])], size)
    except (IndexError, ValueError):
        raise FileError(path, "cannot be read: its compressed data are damaged") from None
    points, start = np.empty((layout.count, 3)), 0
    for (name, _, many), kind in zip(layout.fields, kinds, strict=True):
        if name in AXES and many == 1:
            with np.errstate(invalid="ignore"):
                points[:, AXES.index(name)] = np.frombuffer(flat, kind.base, layout.count, start)
        start += layout.count * kind.itemsize
    return points


def unpack_lzf(packed: memoryview, size: int) -> bytearray:
    """What LZF has made smaller; raises `ValueError` or `IndexError` if that is not exactly `size` bytes."""
    out, place = bytearray(), 0
    while place < len(packed) and len(out) <= size:
        control = packed[place]
        place += 1
        if control < 32:  # as many bytes and one more, as they are
            if place + control >= len(packed):
                raise ValueError
            out += packed[place : place + control + 1]
            place += control + 1
            continue
        length = control >> 5
        if length == 7:
            length += packed[place]
            place += 1
        first = len(out) - ((control & 31) << 8) - packed[place] - 1
        place += 1
        if first < 0:
            raise ValueError
        piece = out[first : first + length + 2]  # of what is there already; it may repeat itself
        out += (piece * ((length + 1) // len(piece) + 1))[: length + 2]
    if len(out) != size:
        raise ValueError
    return out
