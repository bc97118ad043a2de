"""Targets from tables: three kinds of file give the same targets, and what is wrong is named by row and column."""

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from ikde.errors import FileError, InputError
from ikde.formats.entries import ColumnsEntry, UnitsEntry
from ikde.formats.table_targets import read_targets

P = np.array([[100.0, 200.0, 300.0], [-1.0, 0.5, 2.0]])
TURN = np.array([[0.0, 0.0, 90.0], [10.0, 20.0, 30.0]])
QUAT = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 2.0]])
FLAT = {"x": P[:, 0], "y": P[:, 1], "z": P[:, 2], "r": TURN[:, 0], "p": TURN[:, 1], "w": TURN[:, 2], "n": ["a", "b"]}
FLAT |= {f"q{k}": QUAT[:, k] for k in range(4)}
XYZ, RPY, Q = ["x", "y", "z"], ["r", "p", "w"], ["q0", "q1", "q2", "q3"]
MM_DEG = UnitsEntry(length="mm", angle="deg")


def write(folder, kind, data):
    path = folder / f"points.{kind}"
    if kind == "npz":
        np.savez(path, **data)
    elif kind == "parquet":
        pq.write_table(pa.table(data), path)
    else:
        rows = zip(*data.values(), strict=True)
        path.write_text("\n".join([",".join(data), *(",".join(map(str, row)) for row in rows)]))
    return path


def read(path, units=MM_DEG, **columns):
    return read_targets(path, ColumnsEntry.model_validate({"position": XYZ, **columns}), units)


def complaint(path, **columns):
    with pytest.raises(InputError) as caught:
        read(path, **columns)
    assert "\n" not in str(caught.value)
    return str(caught.value).replace(str(path), path.name)


@pytest.mark.parametrize("kind", ["csv", "parquet", "npz"])
def test_every_kind_of_file_gives_the_same_targets(tmp_path, kind):
    path = write(tmp_path, kind, FLAT)
    source = read(path, name="n", rpy=RPY)
    np.testing.assert_array_equal(source.positions, P * 1e-3)
    np.testing.assert_allclose(source.orientations, np.radians(TURN), rtol=1e-15)
    assert (source.count, source.names, source.kind) == (2, ("a", "b"), "rpy")
    np.testing.assert_array_equal(read(path, quat_wxyz=Q).orientations, QUAT)


def test_an_array_may_hold_all_numbers_of_a_key(tmp_path):
    source = read(write(tmp_path, "npz", {"p": P, "quat": QUAT.astype(np.float32)}), position="p", quat_wxyz="quat")
    np.testing.assert_array_equal(source.positions, P * 1e-3)
    np.testing.assert_array_equal(source.orientations, QUAT)


def test_whole_numbers_are_numbers(tmp_path):
    source = read(write(tmp_path, "npz", {"p": np.array([[1, 2, 3]])}), position="p")
    np.testing.assert_array_equal(source.positions, [[1e-3, 2e-3, 3e-3]])


@pytest.mark.parametrize("kind", ["csv", "parquet", "npz"])
@pytest.mark.parametrize("value", [np.nan, np.inf, 2e9])
def test_numbers_that_no_target_can_have_are_named_by_row_and_column(tmp_path, kind, value):
    path = write(tmp_path, kind, {**FLAT, "y": [0.0, value]})
    assert complaint(path) == f"points.{kind}: row 2: y: expected a finite number up to 1e+09, got {value:g}"


@pytest.mark.parametrize(
    ("key", "data", "names"), [("quat_wxyz", np.zeros((2, 4)), "q"), ("axis", np.zeros((2, 3)), "a")]
)
def test_directions_of_length_zero_are_named(tmp_path, key, data, names):
    path = write(tmp_path, "npz", {"p": P, names: data})
    assert (
        complaint(path, position="p", **{key: names}) == f"points.npz: row 1: {names}: a length of 0 has no direction"
    )


def test_a_number_inside_an_array_is_named_by_its_place(tmp_path):
    path = write(tmp_path, "npz", {"p": np.array([[1.0, 2.0, np.nan]])})
    assert complaint(path, position="p").startswith("points.npz: row 1: p[2]: expected a finite number")


@pytest.mark.parametrize(
    ("data", "columns", "expected"),
    [
        (FLAT, {"position": ["x", "yy", "z"]}, "columns.position[1]: points.npz has no column 'yy' (did you mean"),
        (FLAT, {"name": "station"}, "columns.name: points.npz has no column 'station'; it has x, y, z"),
        (FLAT, {"rpy": RPY, "axis": RPY}, "columns.rpy: axis and rpy both ask for an orientation"),
        (FLAT, {"position": "x"}, "points.npz: x: expected 3 numbers a row, got shape (1,)"),
        ({"p": P}, {"position": ["p", "p", "p"]}, "points.npz: p: expected 1 number a row, got shape (3,)"),
        ({**FLAT, "x": [1.0]}, {}, "points.npz: lengths differ: x has 1, y has 2, z has 2"),
        ({"p": np.zeros((0, 3))}, {"position": "p"}, "points.npz: no rows"),
        ({"p": np.array(1.0)}, {"position": "p"}, "points.npz: p: expected 3 numbers a row, got shape (1,)"),
        ({"p": np.array([["1", "2", "3"]])}, {"position": "p"}, "points.npz: p: expected numbers, got <U1"),
    ],
)
def test_what_the_file_does_not_hold_is_named(tmp_path, data, columns, expected):
    assert complaint(write(tmp_path, "npz", data), **columns).startswith(expected)


def test_a_column_that_is_there_twice_cannot_be_chosen(tmp_path):
    path = tmp_path / "points.csv"
    path.write_text("x,y,z,x\n1,2,3,4\n")
    assert complaint(path) == "columns.position[0]: points.csv has more than one column 'x'"


def test_a_header_alone_is_no_target(tmp_path):
    path = tmp_path / "points.csv"
    path.write_text("x,y,z\n")
    with pytest.raises(FileError, match="no rows"):
        read(path)
