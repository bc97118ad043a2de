"""Paths of track files: formulas, curves, waypoints; the same path however it is written."""

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from ikde.errors import InputError
from ikde.model.rotation import rotation_from_rpy
from ikde.track.make_path import make_path
from ikde.track.spec import TrackSpec

MM_DEG = {"length": "mm", "angle": "deg"}
LINE = {"expressions": {"x": "500 + 1000*k/N", "y": 0, "z": "900"}}
ENDS = {"waypoints": [{"position": [500, 0, 900]}, {"position": [1500, 0, 900]}]}
CURVE = {"curve": {"from": [500, 0, 900], "segments": [{"duration_s": 1.0, "line": {"to": [1500, 0, 900]}}]}}
TURNS = [{"position": [0, 0, 900], "rpy": [0, 0, 0]}, {"position": [100, 0, 900], "rpy": [0, 0, 90]}]


@pytest.fixture
def make(tmp_path):
    def call(path=LINE, **keys):
        data = {"robot": "qiao2021", "units": MM_DEG, "dt_s": 0.1, "samples": 10, "path": path, **keys}
        spec = TrackSpec.model_validate({key: value for key, value in data.items() if value is not None})
        return make_path(spec, "mine", tmp_path)

    return call


@pytest.fixture
def complaint(make, tmp_path):
    def call(path=LINE, **keys):
        with pytest.raises(InputError) as caught:
            make(path, **keys)
        assert "\n" not in str(caught.value)
        return str(caught.value).replace(f"{tmp_path}/", "")

    return call


@pytest.mark.parametrize(("path", "samples"), [(LINE, 10), (ENDS, 10), (CURVE, 10), (CURVE, None)])
def test_a_line_is_a_line_however_it_is_written(make, path, samples):
    made = make(path, samples=samples)
    assert (made.name, made.samples, made.dt_s, made.orientation) == ("mine", 10, 0.1, "free")
    np.testing.assert_allclose(made.p_world_tool[:, 0], np.linspace(0.5, 1.5, 11), atol=1e-15)
    np.testing.assert_allclose(made.p_half[:, 0], np.linspace(0.55, 1.45, 10), atol=1e-15)
    np.testing.assert_allclose(made.p_world_tool[:, 1:], np.tile([0, 0.9], (11, 1)))


def test_sample_0_is_the_start_and_a_formula_knows_what_is_half_way(make):
    made = make({"expressions": {"x": "k*k", "y": "N", "z": "1 if k < 0.5 else 2"}}, units={"length": "m"})
    np.testing.assert_array_equal(made.p_world_tool[:3], [[0, 10, 1], [1, 10, 2], [4, 10, 2]])
    np.testing.assert_array_equal(made.p_half[:2], [[0.25, 10, 2], [2.25, 10, 2]])


def test_the_tool_may_be_turned_by_formulas(make):
    axis = make(orientation={"axis": ["cos(pi*k/N)", "sin(pi*k/N)", 0]})
    np.testing.assert_allclose(
        axis.targets().axis_world_tool[[0, 5, 10]], [[1, 0, 0], [0, 1, 0], [-1, 0, 0]], atol=1e-15
    )
    rpy = make(orientation={"rpy": [0, 0, "360*k/N"]})
    assert rpy.orientation == "pose"
    np.testing.assert_allclose(rpy.R_half[0], rotation_from_rpy(np.radians([0, 0, 18.0])), atol=1e-15)
    quat = make(orientation={"quat_wxyz": [0, 0, 0, "1 + k"]})
    np.testing.assert_allclose(quat.R_world_tool, np.tile(np.diag([-1.0, -1, 1]), (11, 1, 1)), atol=1e-15)


def test_keyframes_turn_evenly_and_stay_before_and_after(make):
    frames = [{"at": 0.2, "rpy": [0, 0, 0]}, {"at": 0.6, "rpy": [0, 0, 80]}]
    R = make(orientation={"keyframes": frames}).R_world_tool
    turned = np.degrees(np.arctan2(R[:, 1, 0], R[:, 0, 0]))
    np.testing.assert_allclose(turned, [0, 0, 0, 20, 40, 60, 80, 80, 80, 80, 80], atol=1e-12)
    axes = [{"at": 0, "axis": [0, 0, 2]}, {"at": 1, "axis": [1, 0, 0]}]
    made = make(orientation={"keyframes": axes})
    assert made.orientation == "axis"
    np.testing.assert_allclose(made.targets()[5].axis_world_tool, [0.5**0.5, 0, 0.5**0.5], atol=1e-15)


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


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"path": {}}, "path: expected one of expressions, curve, waypoints, file, got none"),
        ({"path": {**LINE, **ENDS}}, "path.waypoints: expected one of expressions, curve, waypoints, file, got"),
        ({"samples": None}, "samples: this key is missing: formulas need"),
        ({"path": {"expressions": {"x": 1, "y": "j", "z": 1}}}, "path.expressions.y: 'j' is not known"),
        ({"path": {"expressions": {"x": 1, "y": 1, "z": "1/k"}}}, "path.expressions.z: '1/k' is inf at k = 0"),
        ({"path": {"expressions": {"x": 1, "y": 1, "z": "1e10*k"}}}, "path: sample 1: expected finite numbers up to"),
        ({"path": CURVE, "samples": 11}, "path.curve.segments: these take 10 samples, not 11: leave `samples` out"),
        ({"path": CURVE, "dt_s": 1e-300}, "path.curve.segments: expected up to 1,000,000 samples in all"),
        ({"path": CURVE, "dt_s": 0.3}, "path.curve.segments[0].duration_s: expected a whole number of samples"),
        ({"orientation": {}}, "orientation: expected one of axis, rpy, quat_wxyz, keyframes, got none"),
        ({"orientation": {"axis": [0, 0, "k"]}}, "orientation.axis: a length of 0 has no direction, at k = 0"),
        ({"orientation": {"rpy": [0, "sqt(k)", 0]}}, "orientation.rpy[1]: no function is called 'sqt'"),
        ({"orientation": {"keyframes": [{"at": 0}]}}, "orientation.keyframes[0]: expected one of axis, rpy, quat_wxyz"),
        (
            {"orientation": {"keyframes": [{"at": 0, "rpy": [0, 0, 0]}, {"at": 1, "axis": [0, 0, 1]}]}},
            "orientation.keyframes[1]: either all keyframes give an axis, or none",
        ),
        (
            {"orientation": {"keyframes": [{"at": 0.5, "rpy": [0, 0, 0]}, {"at": 0.5, "rpy": [0, 0, 1]}]}},
            "orientation.keyframes[1].at: expected a later moment",
        ),
        (
            {"orientation": {"keyframes": [{"at": 0, "rpy": [0, 0, 0]}, {"at": 1, "rpy": [0, 0, 180]}]}},
            "orientation.keyframes[1]: half a turn from the orientation before it",
        ),
        ({"path": {"waypoints": TURNS}, "orientation": "free"}, "orientation: the waypoints have orientations of"),
        (
            {"path": {"waypoints": [TURNS[0], ENDS["waypoints"][0]]}},
            "path.waypoints[1]: this waypoint asks for a position, the first one for a pose",
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
