"""Several errors of one file: told together, in order of lines."""

import pytest

from ikde.errors import FileError, InputError
from ikde.io.plan_file import load_track
from ikde.io.robots import load_robot
from tests.robot_files import GOOD


def complaints(text, tmp_path):
    path = tmp_path / "robot.yaml"
    path.write_text(text)
    with pytest.raises(FileError) as caught:
        load_robot(path)
    lines = [str(caught.value), *getattr(caught.value, "__notes__", ())]
    assert all("\n" not in line for line in lines)
    return [line.replace(f"{tmp_path}/", "") for line in lines]


def test_errors_are_told_together_in_order_of_lines(tmp_path):
    text = "name: a\njoints: {q: {kind: turning, lower: a, upper: 1}}\nframes: {f: {parent: 3}}\ntool: f\n"
    text += "units: {length: km}\n"
    assert complaints(text, tmp_path) == [
        "robot.yaml:2 → joints.q.kind: expected 'revolute', 'prismatic' or 'continuous', got 'turning'",
        "robot.yaml:2 → joints.q.lower: expected a number, got 'a'",
        "robot.yaml:3 → frames.f.parent: expected text, got 3",
        "robot.yaml:5 → units.length: expected 'm' or 'mm', got 'km'",
    ]


def test_one_error_is_one_line(tmp_path):
    assert len(complaints(GOOD.replace("tool:", "tooll:", 1), tmp_path)) == 1


def test_a_key_that_was_misspelt_is_not_missing_as_well(tmp_path):
    (line,) = complaints("nmae: a\njoints: {}\nframes: {}\ntool: f\n", tmp_path)
    assert line == "robot.yaml:1 → nmae: unknown key (did you mean 'name'?)"


@pytest.mark.parametrize(("wrong", "last"), [(10, "joints.j9.kind"), (11, "and 1 more"), (40, "and 30 more")])
def test_ten_errors_are_listed_and_the_others_counted(tmp_path, wrong, last):
    joints = "".join(f"  j{k}: {{kind: 3, lower: 0, upper: 1}}\n" for k in range(wrong))
    lines = complaints(f"name: a\ntool: f\nframes: {{}}\njoints:\n{joints}", tmp_path)
    assert len(lines) == min(wrong, 11)
    assert last in lines[-1]
    assert [line.split(" ")[0] for line in lines[:10]] == [f"robot.yaml:{5 + k}" for k in range(10)]


def test_data_of_no_file_has_its_errors_together(tmp_path):
    with pytest.raises(InputError) as caught:
        load_track({"robot": "ur5", "dt": 0.1, "path": {"waypoints": [[1, 2, 3], [1, "x", 3]]}})
    assert str(caught.value).startswith("dt: unknown key (did you mean 'dt_s'?)")
    assert caught.value.__notes__ == ["path.waypoints[1][1]: expected a number, got 'x'"]
