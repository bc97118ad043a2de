"""`ikde bench scenes`: a page and its data, a set that goes on, and words for what is wrong."""

import json

import pytest

import ikde
from ikde.cli import bench_scenes as module
from ikde.io.robot_writer import write_robot
from tests.dual_arm import DUAL, TOOLS
from tests.scene_set import write_set
from tests.three_joints import FILE
from tests.urdf_texts import write


@pytest.fixture
def problems(tmp_path):
    return write_set(tmp_path / "set")


def read(out):
    return json.loads((out / "results.json").read_text(encoding="utf-8"))


def test_a_set_is_answered_on_a_page(cli, problems, tmp_path):
    out = tmp_path / "page"
    outcome = cli("bench", "scenes", problems, "--robot", FILE, "--margin", "0.005,hand=0", "--out", out)
    assert outcome.code == 0, outcome
    assert outcome.out == f"wrote {out / 'results.json'}\nwrote {out / 'report.html'}\n"
    assert "computing: shelf\ncomputing: table" in outcome.err
    data = read(out)
    assert data["finished"]
    assert (data["all"]["problems"], data["all"]["reached"]) == (3, 3)
    assert (data["asked"]["all_m"], data["asked"]["of_m"]) == (0.005, {"hand": 0.0})
    assert [family["name"] for family in data["families"]] == ["shelf", "table"]
    page = (out / "report.html").read_text(encoding="utf-8")
    assert "3 of 3" in page
    assert "--margin 0.005,hand=0 --unit m --out FOLDER" in page
    again = cli("bench", "scenes", problems, "--robot", FILE, "--margin", "0.005,hand=0", "--out", out)
    assert "3 of 3 problems are answered in" in again.err
    assert read(out)["problems"] == data["problems"]
    other = cli("bench", "scenes", problems, "--robot", FILE, "--first", "1", "--out", out)
    assert "answered in" not in other.err
    assert list(read(out)["problems"]) == ["shelf/scene0001", "table/scene0001"]


def test_a_set_that_is_stopped_goes_on(cli, problems, tmp_path, monkeypatch):
    out, real = tmp_path / "page", module._ask

    def stop_at_the_table(run, pair):
        if pair.family == "table":
            raise KeyboardInterrupt
        return real(run, pair)

    monkeypatch.setattr(module, "_ask", stop_at_the_table)
    outcome = cli("bench", "scenes", problems, "--robot", FILE, "--out", out)
    assert outcome.code == 130
    assert "the same command goes on" in outcome.err
    data = read(out)
    assert (data["finished"], len(data["problems"])) == (False, 2)
    assert not (out / "report.html").exists()
    monkeypatch.setattr(module, "_ask", real)
    outcome = cli("bench", "scenes", problems, "--robot", FILE, "--out", out)
    assert "2 of 3 problems are answered" in outcome.err
    assert read(out)["finished"]


def test_a_problem_that_cannot_be_asked_is_a_row(cli, problems, tmp_path):
    scene = problems / "problems" / "table" / "scene0001.yaml"
    scene.write_text(scene.read_text().replace("- id: can", "- id: can\n      header: {frame_id: nowhere}"))
    outcome = cli("bench", "scenes", problems, "--robot", FILE, "--out", tmp_path / "page", "--json")
    assert outcome.code == 1
    row = outcome.data["problems"]["table/scene0001"]
    assert row["stop_reason"] == "refused"
    assert (
        "scene0001.yaml:5 → world.collision_objects[0].header.frame_id: no frame that stays in its place"
        in row["reason"]
    )


def test_what_is_wrong_is_found_before_anything_runs(refuse, problems):
    assert "expected a folder of scenes" in refuse("bench", "scenes", problems / "chair", "--robot", FILE)
    assert "no component is called 'hnad'" in refuse("bench", "scenes", problems, "--robot", FILE, "--margin", "hnad=1")


DUAL_REQUEST = """
group_name: right_arm
start_state: {is_diff: true, joint_state: {name: [right_elbow, lid, left_elbow], position: [0.2, 1, 7]}}
goal_constraints:
  - joint_constraints: [{joint_name: right_elbow, position: 1}, {joint_name: right_shoulder, position: -0.9}]
"""
STATE = "robot_state: {joint_state: {name: [waist, left_shoulder, right_shoulder], position: [0.1, 0.3, 0]}}"


def test_of_two_arms_the_one_that_the_goal_moves_is_asked_where_the_scene_has_the_other(cli, tmp_path):
    (tmp_path / "scene.yaml").write_text(f"world: {{collision_objects: []}}\n{STATE}\n", encoding="utf-8")
    (tmp_path / "request.yaml").write_text(DUAL_REQUEST, encoding="utf-8")
    dual = tmp_path / "dual.yaml"
    write_robot(ikde.import_urdf(write(tmp_path, DUAL), tool=TOOLS), dual)
    outcome = cli("bench", "scenes", tmp_path, "--robot", dual, "--out", tmp_path / "page", "--json")
    (row,) = outcome.data["problems"].values()
    assert (outcome.code, row["tool"]) == (0, "right_hand")
    assert row["held"] == {"waist": 0.1, "left_shoulder": 0.3, "left_elbow": 7.0}
    left = cli("bench", "scenes", tmp_path, "--robot", dual, "--tool", "left", "--out", tmp_path / "page", "--json")
    (row,) = left.data["problems"].values()
    assert (left.code, row["reason"]) == (1, "goal_constraints: names no joint that moves left_hand")
