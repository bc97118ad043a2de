"""Run files: the shipped ones load, and what is wrong is said in one line with file, line and key."""

from pathlib import Path

import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import ikde
from ikde.errors import FileError, InputError
from ikde.io.plan_file import load_batch
from ikde.io.robots import FOLDER
from ikde.kernels import cache_folder
from ikde.model.collision_model import CollisionModel
from ikde.model.generate.module import load_module
from tests.hostile_names import payload

SHIPPED = sorted((Path(__file__).parents[2] / "configs" / "runs").glob("*.yaml"))
GOOD = """\
robot: qiao2021
units: {length: mm, angle: deg}
targets:
  inline:
    - {name: task 1, position: [800, 500, 1000]}
    - {name: task 2, position: [540, -131, 974], axis: [0, 0, 1]}
solve:
  method: de
  detector: {name: mine, spheres: typical, pairs: non_adjacent}
  settings: {position_tolerance: 0.05}
  ranges: {d_x: [-60, 60]}
arms:
  few: {settings: {de: {population: 20}}}
  many:
    settings: {de: {population: 80}}
grade: [improved]
repeats: 2
seed: 7
"""
TABLE = """\
robot: qiao2021
targets:
  file:
    path: points.csv
    columns:
      position: [x, y, z]
"""
TASK_2 = "[540, -131, 974]"


def load(text, folder):
    path = folder / "run.yaml"
    path.write_text(text)
    return load_batch(path)


def complaint(text, folder):
    with pytest.raises(FileError) as caught:
        load(text, folder)
    assert "\n" not in str(caught.value)
    return str(caught.value).replace(f"{folder}/", "")


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_the_shipped_runs_load_and_say_what_they_show(path):
    batch = load_batch(path)
    assert path.read_text().startswith("# ")
    assert f"ikde batch configs/runs/{path.name}" in path.read_text()
    assert len(batch.source.read(0, 3)) == min(3, batch.source.count)


def test_the_run_of_table_4_is_as_the_paper_has_it():
    path = next(path for path in SHIPPED if path.stem == "qiao2021_table4")
    batch = load_batch(path)
    arm = batch.arms[0]
    assert (batch.name, batch.file, batch.solves) == ("Table 4", str(path), 20_000)
    assert arm.problem.collision.detector is None
    de = ikde.DeSettings(strategy="best/1", update="in_place", bounds="redraw", collision="reject")
    assert arm.problem.settings == ikde.SolveSettings(method="de", position_tolerance_m=5e-5, restarts=1, de=de)
    assert [d.name for d in batch.graders] == ["typical_all", "improved_printed", "typical", "improved"]


def test_a_mapping_is_the_same_run(tmp_path):
    assert load_batch(yaml.safe_load(GOOD)).hash == load(GOOD, tmp_path).hash


def test_a_name_in_text_is_a_path(tmp_path):
    load(GOOD, tmp_path)
    assert load_batch(str(tmp_path / "run.yaml")).name == "run"


def test_robots_and_tables_stand_beside_the_run_file(tmp_path):
    (tmp_path / "mine.yaml").write_text((FOLDER / "ur5.yaml").read_text())
    (tmp_path / "points.csv").write_text("x,y,z\n1,2,3\n")
    batch = load(TABLE.replace("qiao2021", "mine.yaml"), tmp_path)
    assert (batch.robot.name, batch.source.count) == ("ur5", 1)


def test_a_detector_of_a_run_file_is_never_run(tmp_path, monkeypatch):
    """As it would be from the text that is written for it."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(cache_folder, "CACHE_FOLDER", tmp_path / "cache")
    detector = {"name": payload("marker"), "spheres": "typical", "pairs": "non_adjacent"}
    batch = load_batch({**yaml.safe_load(GOOD), "solve": {"detector": detector}, "arms": {}})
    (arm,) = batch.arms
    assert arm.problem.collision.detector.name == detector["name"]
    assert load_module(CollisionModel(robot=batch.robot, detector=arm.problem.collision.detector), "position")
    assert [path.name for path in tmp_path.iterdir()] == ["cache"]


@pytest.mark.parametrize(
    ("old", "new", "place", "words"),
    [
        ("grade: [improved]", "name: ''", ":16 → name:", "expected text that is not empty"),
        (
            "grade: [improved]",
            r'name: "a\e[2J"',
            ":16 → name:",
            r"characters, got one with '\x1b'",
        ),
        ("name: task 1", f"name: {'x' * 101}", ":5 → targets.inline[0].name:", "1 to 100 characters, got 101"),
        ("name: mine", r'name: "a\n"', ":9 → solve.detector.name:", "expected a name of printable characters"),
        ("name: mine", r'name: "a\u202e"', ":9 → solve.detector.name:", "expected a name of printable characters"),
        ("few:", f"{'x' * 101}:", ":13 → ...xxx", "1 to 100 characters, got 101"),
        (TASK_2, "[540, -131]", ":6 → targets.inline[1].position:", "expected 3 values, got 2"),
        (TASK_2, "[1, 2, 3, 4]", ":6 → targets.inline[1].position:", "expected 3 values, got 4"),
        (TASK_2, "[1, 2, .nan]", ":6 → targets.inline[1].position[2]:", "expected a finite number"),
        (TASK_2, "[1, 2, far]", ":6 → targets.inline[1].position[2]:", "expected a number, got 'far'"),
        ("axis: [0, 0, 1]", "axis: [0, 0, 0]", ":6 → targets.inline[1].axis:", "an axis of length 0"),
        ("axis: [0, 0, 1]", "axs: [0, 0, 1]", ":6 → targets.inline[1].axs:", "unknown key (did you mean 'axis'?)"),
        ("length: mm", "length: cm", ":2 → units.length:", "expected 'm' or 'mm', got 'cm'"),
        ("robot: qiao2021", "robot: qiao", ":1 → robot:", "no robot is called 'qiao' (did you mean 'qiao2021'?)"),
        ("robot: qiao2021", "robot: a.yaml", ":1 → robot:", "no such file: a.yaml"),
        ("robot: qiao2021", "", ":2 → robot:", "this key is missing"),
        (
            "method: de",
            "method: ga",
            ":8 → solve.method:",
            "expected 'auto', 'lm', 'analytic', 'memetic' or 'de', got 'ga'",
        ),
        ("spheres: typical", "sphere: typical", ":9 → solve.detector.sphere:", "unknown key (did you mean 'spheres'?)"),
        ("spheres: typical, ", "", ":9 → solve.detector.spheres:", "this key is missing"),
        ("spheres: typical", "spheres: typcal", ":9 → solve.detector.spheres:", "(did you mean 'typical'?)"),
        ("position_tolerance: 0.05", "position_tolerance: 0", ":10 → solve.settings.position_tolerance:", "above 0"),
        ("position_tolerance: 0.05", "tolerance: 1", ":10 → solve.settings.tolerance:", "'position_tolerance'"),
        ("d_x: [-60, 60]", "d_x: [60]", ":11 → solve.ranges.d_x:", "expected 2 values, got 1"),
        ("d_x: [-60, 60]", "d_x: [60, -60]", ":11 → solve.ranges.d_x:", "upper end of this range is below"),
        ("d_x: [-60, 60]", "dx: [-60, 60]", ":11 → solve.ranges.dx:", "no joint 'dx' (did you mean 'd_x'?)"),
        ("population: 80", "population: 3", ":15 → arms.many.settings.de.population:", "at least 6"),
        ("population: 80", "populaton: 3", ":15 → arms.many.settings.de.populaton:", "did you mean 'population'?"),
        ("few:", "a few:", ":13 → arms.a few:", "names files"),
        ("grade: [improved]", "grade: [typ]", ":16 → grade[0]:", "no detector 'typ'"),
        ("grade: [improved]", "grade: [{name: a}]", ":16 → grade[0].spheres:", "this key is missing"),
        ("grade: [improved]", "grade: [3]", ":16 → grade[0]:", "expected keys with values, got 3"),
        ("grade: [improved]", "output: {columns: [qq]}", ":16 → output.columns[0]:", "expected 'q', 'errors'"),
        ("repeats: 2", "repeats: 0", ":17 → repeats:", "expected at least 1, got 0"),
        ("repeats: 2", "repeats: 2.5", ":17 → repeats:", "whole number"),
        ("repeats: 2", "repeat: 2", ":17 → repeat:", "unknown key (did you mean 'repeats'?)"),
        ("seed: 7", "seed: -1", ":18 → seed:", "expected at least 0, got -1"),
        ("[-60, 60]", "[-1.0e+10, 60]", ":11 → solve.ranges.d_x[0]:", "expected at least -1e+09, got -10000000000.0"),
        ("seed: 7", "explain: maybe", ":18 → explain:", "expected true or false, got 'maybe'"),
        ("seed: 7", "seed: [", ":", "not YAML"),
    ],
)
def test_what_is_wrong_is_named_by_file_line_and_key(tmp_path, old, new, place, words):
    assert old in GOOD
    message = complaint(GOOD.replace(old, new, 1), tmp_path)
    assert message.startswith(f"run.yaml{place}")
    assert words in message


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("points.csv", "none.csv", "run.yaml:4 → targets.file.path: no such file: none.csv"),
        ("points.csv", "points.txt", "run.yaml:4 → targets.file.path: expected a file that ends in .csv, .parquet"),
        ("[x, y, z]", "[x, y, zz]", "run.yaml:6 → targets.file.columns.position[2]: points.csv has no column 'zz'"),
        ("[x, y, z]", "[x, y]", "run.yaml:6 → targets.file.columns.position: expected 3 values, got 2"),
        ("[x, y, z]", "p", "run.yaml:6 → targets.file.columns.position: points.csv has no column 'p'"),
        ("position", "postion", "run.yaml:6 → targets.file.columns.postion: unknown key (did you mean 'position'?)"),
        ("robot", "robot", "points.csv: row 2: y: expected a number, got 'five'"),
    ],
)
def test_what_is_wrong_with_a_table_is_named(tmp_path, old, new, expected):
    (tmp_path / "points.csv").write_text("x,y,z\n1,2,3\n4,five,6\n")
    assert complaint(TABLE.replace(old, new, 1), tmp_path).startswith(expected)


def test_a_wrong_robot_file_speaks_for_itself(tmp_path):
    (tmp_path / "mine.yaml").write_text("name: mine\n")
    message = complaint(GOOD.replace("qiao2021", "mine.yaml", 1), tmp_path)
    assert message.startswith("mine.yaml")
    assert "this key is missing" in message


def test_a_mapping_is_refused_by_key_alone():
    with pytest.raises(InputError) as caught:
        load_batch({**yaml.safe_load(GOOD), "repeat": 3})
    assert not isinstance(caught.value, FileError)
    assert str(caught.value) == "repeat: unknown key (did you mean 'repeats'?)"
    with pytest.raises(InputError, match=r"^solve\.freeze\.q9: qiao2021 has no joint 'q9'"):
        load_batch({**yaml.safe_load(TABLE), "solve": {"freeze": {"q9": None}}})


@pytest.mark.parametrize(("source", "kind"), [(None, "NoneType"), ([1], "list"), (b"run.yaml", "bytes")])
def test_what_is_neither_file_nor_mapping_is_refused(source, kind):
    with pytest.raises(InputError, match=f"^expected the path of a run file or a mapping, got {kind}$"):
        load_batch(source)


@pytest.mark.parametrize("text", ["", "- 1\n", "5\n", "{}\n"])
def test_what_is_no_run_file_is_refused(tmp_path, text):
    assert complaint(text, tmp_path).startswith("run.yaml")


def test_a_missing_run_file_is_named(tmp_path):
    with pytest.raises(FileError, match="no such file"):
        load_batch(tmp_path / "none.yaml")


anything = st.recursive(
    st.none() | st.booleans() | st.integers(-3, 3) | st.floats() | st.text("ax: ", max_size=3),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.sampled_from(["position", "a", "q1"]), inner),
    max_leaves=5,
)
PATHS = (
    ("targets",),
    ("targets", "inline"),
    ("targets", "inline", 0),
    ("targets", "inline", 1, "axis"),
    ("solve",),
    ("solve", "detector"),
    ("solve", "settings", "position_tolerance"),
    ("solve", "ranges", "d_x"),
    ("solve", "near"),
    ("arms",),
    ("arms", "few"),
    ("grade",),
    ("units",),
    ("output",),
    ("seed",),
)


@settings(max_examples=150, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(path=st.sampled_from(PATHS), value=anything)
def test_nothing_that_is_written_ends_in_a_traceback(path, value):
    data = yaml.safe_load(GOOD)
    inner = data
    for key in path[:-1]:
        inner = inner[key]
    inner[path[-1]] = value
    try:
        load_batch(data)
    except InputError as error:
        assert "\n" not in str(error)


def test_a_run_chooses_a_tool(tmp_path):
    run = yaml.safe_load(GOOD) | {"robot": "xarm7"}
    run["solve"] = {"ranges": {}}
    run.pop("arms"), run.pop("grade")
    frame = next(frame.name for frame in ikde.load_robot("xarm7").frames if frame.joint == "joint5")
    batch = load_batch(run | {"tool": frame})
    assert batch.robot.tool == frame
    assert batch.robot.lower.tolist()[5:] == batch.robot.upper.tolist()[5:] == [0.0, 0.0]
    with pytest.raises(InputError, match="tool: no tool and no frame of xarm7 is called 'hand'"):
        load_batch(run | {"tool": "hand"})
