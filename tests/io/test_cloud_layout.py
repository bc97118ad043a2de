"""PLY and PCD: text and packed, in any order of fields; headers that claim too much are refused."""

import numpy as np
import pytest

from ikde.errors import FileError
from ikde.io import cloud_layout
from ikde.io.cloud_layout import read_pcd, read_ply, unpack_lzf

POINTS = np.random.default_rng(2).normal(size=(5, 3)).astype(np.float32).astype(float)
PLY = """ply
format {form} 1.0
comment made by a test
element vertex {count}
property float z
property uchar red
property double x
property float y
element face 1
property list uchar int vertex_indices
end_header
"""
PCD = """# .PCD v0.7
VERSION 0.7
FIELDS normals x y z
SIZE 4 8 4 4
TYPE F F F F
COUNT 2 1 1 1
WIDTH {count}
HEIGHT 1
VIEWPOINT 0 0 0 1 0 0 0
POINTS {count}
DATA {form}
"""


def pack(order, kinds, columns):
    packed = np.empty(len(POINTS), dtype=[(str(k), order + kind) for k, kind in enumerate(kinds)])
    for k, column in enumerate(columns):
        packed[str(k)] = column
    return packed.tobytes()


def ply(form, count=5, head=PLY):
    text = head.format(form=form, count=count).encode()
    x, y, z = POINTS.T
    if form == "ascii":
        return text + b"".join(f"{c!r} 255 {a!r} {b!r}\n".encode() for a, b, c in POINTS.tolist()) + b"3 0 1 2\n"
    body = pack("<" if "little" in form else ">", ("f4", "u1", "f8", "f4"), (z, 255, x, y))
    return text + body + b"\x03\0\0\0\0"


def pcd(form, count=5, head=PCD):
    text = head.format(form=form, count=count).encode()
    if form == "ascii":
        return text + b"".join(f"0 1 {a!r} {b!r} {c!r}\n".encode() for a, b, c in POINTS.tolist())
    return text + pack("<", ("f4", "f4", "f8", "f4", "f4"), (0, 1, *POINTS.T))


def lzf(data):
    """As few tricks as the format has: bytes as they are, and zeros that repeat the one before."""
    out, place = b"", 0
    while place < len(data):
        zeros = len(data[place:]) - len(data[place:].lstrip(b"\0"))
        if place and data[place - 1] == 0 and zeros >= 3:
            length = min(zeros, 200) - 2
            out += bytes([length << 5, 0]) if length < 7 else bytes([7 << 5, length - 7, 0])
            place += length + 2
        else:
            some = data[place : place + 5]
            out += bytes([len(some) - 1]) + some
            place += 5
    return out


def compressed(end=b""):
    head, _, _ = pcd("binary").replace(b"DATA binary", b"DATA binary_compressed").partition(b"compressed\n")
    fields = [
        np.zeros((5, 2), "<f4"),
        POINTS[:, 0].astype("<f8"),
        POINTS[:, 1].astype("<f4"),
        POINTS[:, 2].astype("<f4"),
    ]
    flat = b"".join(field.tobytes() for field in fields)
    packed = lzf(flat) + end
    return head + b"compressed\n" + np.array([len(packed), len(flat)], "<u4").tobytes() + packed


@pytest.mark.parametrize("form", ["ascii", "binary_little_endian", "binary_big_endian"])
@pytest.mark.parametrize("line_end", [b"\n", b"\r\n"])
def test_vertices_of_a_ply(tmp_path, form, line_end):
    head, _, body = ply(form).partition(b"end_header\n")
    (tmp_path / "a.ply").write_bytes((head + b"end_header\n").replace(b"\n", line_end) + body)
    assert np.array_equal(read_ply(tmp_path / "a.ply"), POINTS)


@pytest.mark.parametrize("form", ["ascii", "binary"])
def test_points_of_a_pcd(tmp_path, form):
    (tmp_path / "a.pcd").write_bytes(pcd(form))
    assert np.array_equal(read_pcd(tmp_path / "a.pcd"), POINTS)


def test_points_of_a_compressed_pcd(tmp_path):
    (tmp_path / "a.pcd").write_bytes(compressed())
    assert np.array_equal(read_pcd(tmp_path / "a.pcd"), POINTS)


@pytest.mark.parametrize(
    ("packed", "data"),
    [
        (b"\x02abc", b"abc"),
        (b"\x00a\x20\x00", b"aaaa"),  # what is there repeats itself
        (b"\x02abc\x40\x02", b"abcabca"),
        (b"\x02abc\xe0\x03\x01\x00d", b"abc" + b"bc" * 6 + b"d"),
    ],
)
def test_lzf(packed, data):
    assert unpack_lzf(memoryview(packed), len(data)) == data
    for wrong in (len(data) - 1, len(data) + 1):
        with pytest.raises(ValueError):  # noqa: PT011
            unpack_lzf(memoryview(packed), wrong)
    with pytest.raises((ValueError, IndexError)):
        unpack_lzf(memoryview(packed[:-1]), len(data))
    with pytest.raises(ValueError):  # noqa: PT011
        unpack_lzf(memoryview(b"\x20\x00"), 3)


def test_text_is_read_in_pieces(tmp_path, monkeypatch):
    monkeypatch.setattr(cloud_layout, "PIECE", 100)
    (tmp_path / "a.pcd").write_bytes(pcd("ascii").replace(b"0 1 ", b"\n \n0\t1  "))
    assert np.array_equal(read_pcd(tmp_path / "a.pcd"), POINTS)
    (tmp_path / "a.pcd").write_bytes(PCD.format(form="ascii", count=5).encode() + b"1 " * 100)
    with pytest.raises(FileError, match="lines of at most 100 bytes"):
        read_pcd(tmp_path / "a.pcd")


def test_points_may_be_nan(tmp_path):
    (tmp_path / "a.pcd").write_bytes(PCD.format(form="ascii", count=1).encode() + b"0 0 nan -inf 1e3\n")
    assert np.array_equal(read_pcd(tmp_path / "a.pcd"), [[np.nan, -np.inf, 1000]], equal_nan=True)


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (ply("ascii", 7), "7 points do not fit into the file"),
        (ply("binary_little_endian", 6), "6 points do not fit into the file"),
        (ply("ascii", 0), "from 1 to 20,000,000 points, got 0"),
        (ply("ascii", 10**8), "from 1 to 20,000,000 points, got 100,000,000"),
        (ply("ascii", "9" * 4000), "expected a number of points, got '999"),
        (ply("ascii", -1), "expected a number of points, got '-1'"),
        (ply("ascii", 10**7), "would take up 320 MB"),
        (ply("ascii").replace(b"255", b"red"), "cannot be read"),
        (ply("text"), "expected a format of ascii, .*, got 'text'"),
        (ply("ascii").replace(b"uchar red", b"list uchar int red"), "expected a property of one number"),
        (ply("ascii").replace(b"float z", b"float w"), "expected fields x, y, z, each once, got 'w', 'red', 'x', 'y'"),
        (ply("ascii").replace(b"uchar red", b"uchar x"), "each once"),
        (ply("ascii").replace(b"vertex", b"corner"), "expected the vertices first, got 'corner'|expected vertices"),
        (ply("ascii").replace(b"ply\n", b"plx\n", 1), "not PLY"),
        (ply("ascii").replace(b"end_header", b"header"), "expected a header that ends in a line with end_header"),
        (b"ply\n" * 10_000, "expected a header that ends"),
        (b"ply", "expected a header that ends"),
        (b"", "expected a header that ends"),
    ],
)
def test_what_is_no_ply(tmp_path, data, said, monkeypatch):
    monkeypatch.setenv("IKDE_MAX_FILE_MB", "300")
    (tmp_path / "a.ply").write_bytes(data)
    with pytest.raises(FileError, match=said):
        read_ply(tmp_path / "a.ply")


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (pcd("binary", 6), "6 points do not fit into the file"),
        (pcd("binary_compressed"), "5 points do not fit into the file"),
        (compressed()[:-1], "do not fit into the file"),
        (compressed().replace(b"POINTS 5", b"POINTS 6"), "6 points do not fit into the file"),
        (compressed(end=b"\xff"), "its compressed data are damaged"),
        (pcd("hex"), "expected data of ascii, binary, binary_compressed, got 'hex'"),
        (pcd("ascii").replace(b"SIZE 4 8", b"SIZE 8"), "of one length"),
        (pcd("ascii").replace(b"TYPE F", b"TYPE O"), "expected numbers, got '2 O4' as 'normals'"),
        (pcd("ascii").replace(b"SIZE 4", b"SIZE 2"), "expected numbers, got '2 F2' as 'normals'"),
        (pcd("ascii").replace(b"COUNT 2", b"COUNT 1000000"), "expected numbers, got '1000000 F4'"),
        (pcd("ascii").replace(b"COUNT 2 1", b"COUNT 2 2"), "each once"),
        (pcd("ascii").replace(b"POINTS", b"DOTS"), "expected a number of points, got ''"),
        (pcd("ascii").replace(b"DATA", b"VALUES"), "a line with DATA"),
    ],
)
def test_what_is_no_pcd(tmp_path, data, said):
    (tmp_path / "a.pcd").write_bytes(data)
    with pytest.raises(FileError, match=said):
        read_pcd(tmp_path / "a.pcd")
