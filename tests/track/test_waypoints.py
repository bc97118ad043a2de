"""Waypoints, written in a track file or in a table."""

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

TURNS = [{"position": [0, 0, 900], "rpy": [0, 0, 0]}, {"position": [100, 0, 900], "rpy": [0, 0, 90]}]


def test_waypoints_turn_on_the_shortest_way(make):
    made = make({"waypoints": [*TURNS, {"position": [200, 0, 900], "quat_wxyz": [1, 0, 0, 1]}]}, samples=4)
    turned = np.degrees(np.arctan2(made.R_world_tool[:, 1, 0], made.R_world_tool[:, 0, 0]))
    np.testing.assert_allclose(turned, [0, 45, 90, 90, 90], atol=1e-12)
    np.testing.assert_allclose(made.p_world_tool[:, 0], [0, 0.05, 0.1, 0.15, 0.2], atol=1e-15)


@pytest.mark.parametrize("kind", ["csv", "npz", "parquet"])
def test_a_table_is_a_sample_a_row_or_is_filled_up(make, tmp_path, kind):
    data = {"x": [0.0, 100.0, 300.0], "y": [0.0, 0.0, 0.0], "z": [900.0, 900.0, 900.0], "a": [0.0, 0.0, 1.0]}
    data |= {"b": [0.0, 1.0, 0.0], "c": [1.0, 0.0, 0.0]}
    if kind == "csv":
        rows = zip(*data.values(), strict=True)
        (tmp_path / "p.csv").write_text("\n".join(",".join(map(str, row)) for row in [data, *rows]))
    elif kind == "npz":
        np.savez(tmp_path / "p.npz", **data)
    else:
        pq.write_table(pa.table(data), tmp_path / "p.parquet")
    file = {"path": f"p.{kind}", "columns": {"position": ["x", "y", "z"], "axis": ["a", "b", "c"]}}
    made = make({"file": file}, samples=None)
    assert (made.samples, made.orientation) == (2, "axis")
    np.testing.assert_array_equal(made.p_world_tool[:, 0], [0, 0.1, 0.3])
    np.testing.assert_allclose(made.targets().axis_world_tool, np.eye(3)[::-1], atol=1e-15)
    filled = make({"file": {**file, "units": {"length": "m"}}}, samples=4)
    np.testing.assert_allclose(filled.p_world_tool[:, 0], [0, 50, 100, 200, 300])


def test_rows_are_the_samples_themselves_to_the_bit(make, tmp_path, rng):
    p = rng.normal(size=(50, 3))
    np.savez(tmp_path / "p.npz", p=p)
    file = {"path": "p.npz", "columns": {"position": "p"}, "units": {"length": "m"}}
    np.testing.assert_array_equal(make({"file": file}, samples=None).p_world_tool, p)


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        (
            {"path": {"waypoints": [TURNS[0], {"position": [500, 0, 900]}]}},
            "path.waypoints[1]: this waypoint asks for a position, the first one for a pose",
        ),
        (
            {"path": {"waypoints": [TURNS[0], {"position": [500, 0, 900], "axis": [0, 0, 1]}]}},
            "path.waypoints[1]: this waypoint asks for an axis, the first one for a pose",
        ),
        (
            {"path": {"waypoints": [TURNS[0], {**TURNS[1], "rpy": [180, 0, 0]}]}},
            "path.waypoints[1]: half a turn from the orientation before it",
        ),
        (
            {"path": {"file": {"path": "none.csv", "columns": {"position": ["x", "y", "z"]}}}},
            "path.file.path: no such file",
        ),
    ],
)
def test_what_is_wrong_is_placed(complaint, keys, words):
    assert complaint(**keys).startswith(words)


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        (["0,0,1,0,0,0"], "w.csv: expected 2 rows or more, got 1"),
        (["0,0,1,0,0,0", "0,0,1,180,0,0"], "w.csv: row 2: half a turn from the orientation before it"),
        (["0,0,1,0,0,0", "0,0,far,0,0,0"], "w.csv: row 2: z: expected a number, got 'far'"),
    ],
)
def test_what_is_wrong_in_a_table_names_file_and_row(complaint, tmp_path, rows, words):
    (tmp_path / "w.csv").write_text("\n".join(["x,y,z,r,p,w", *rows]))
    file = {"path": "w.csv", "columns": {"position": ["x", "y", "z"], "rpy": ["r", "p", "w"]}}
    assert complaint({"file": file}).startswith(words)
