"""Robots as text and as JSON."""

import json
from collections import Counter
from dataclasses import replace

import pytest

import ikde
from ikde.model.collision_model import CollisionModel
from ikde.model.robot import Provenance
from ikde.report.numbers import Units
from ikde.report.robot import format_robot, format_robots, robot_json, robots_json
from tests.endless_robot import ENDLESS
from tests.robot_files import load_text

MM_DEG = Units("mm", "deg")


def words_of(text, first):
    return next(line.split() for line in text.splitlines() if line.split()[:1] == [first])


def test_the_list_has_a_line_a_robot():
    robots = [ikde.load_robot(name) for name in ikde.robot_names()]
    text = format_robots(robots)
    for robot in robots:
        assert words_of(text, robot.name)[1] == str(len(robot.joints))
    assert [entry["name"] for entry in robots_json(robots)] == list(ikde.robot_names())
    assert words_of(text, "qiao2021_dh")[2] == "none"


def test_the_list_says_who_published_the_frames():
    listed = {entry["name"]: entry["source"] for entry in robots_json(map(ikde.load_robot, ikde.robot_names()))}
    assert (listed["ur5"], listed["qiao2021"]) == ("Universal Robots", "Qiao2021")
    assert robots_json([load_text(ENDLESS)])[0]["source"] == ""


def test_the_list_fits_60_columns_with_joints_and_source():
    text = format_robots(map(ikde.load_robot, ikde.robot_names()), width=60)
    assert max(map(len, text.splitlines())) <= 60
    assert words_of(text, "robot") == ["robot", "joints", "frames", "from", "title"]


def test_json_is_plain_and_in_metres_and_radians(any_robot):
    data = json.loads(json.dumps(robot_json(CollisionModel.of(any_robot)), allow_nan=False))
    assert [joint["lower"] for joint in data["joints"]] == any_robot.lower.tolist()
    assert [joint["home"] for joint in data["joints"]] == any_robot.home.tolist()
    assert [joint["max_speed"] for joint in data["joints"]] == [joint.max_speed for joint in any_robot.joints]
    assert [frame["name"] for frame in data["frames"]] == [frame.name for frame in any_robot.frames]
    assert data["frames"][-1]["p_parent_frame"] == any_robot.frames[-1].p_parent_frame.tolist()
    assert data["conventions"][0] == data["convention"] == any_robot.convention


def test_json_counts_spheres_pairs_and_sources(qiao):
    data = robot_json(CollisionModel.of(qiao))
    assert data["approximations"]["improved"]["spheres"] == sum(row.count for row in qiao.approximations["improved"])
    assert {name: len(pairs) for name, pairs in data["pair_lists"].items()} == {
        name: len(pairs) for name, pairs in qiao.pair_lists.items()
    }
    assert data["provenance"] == Counter(source.kind for source in qiao.provenance.values())
    assert data["detectors"]["improved"] == {"spheres": "improved", "pairs": "formula_22", "safe_distance_m": 0.0}


def test_text_has_every_joint_frame_and_detector(any_robot):
    text = format_robot(CollisionModel.of(any_robot, "none"), MM_DEG)
    assert text.startswith(f"{any_robot.name}: {any_robot.title}")
    for joint in any_robot.joints:
        shown = words_of(text, joint.name)
        assert float(shown[2]) == pytest.approx(MM_DEG.joint_value(joint, joint.lower), rel=1e-5)
        assert float(shown[4]) == pytest.approx(MM_DEG.joint_value(joint, joint.upper), rel=1e-5)
    for name in (*(frame.name for frame in any_robot.frames), *any_robot.detectors):
        assert words_of(text, name)


def test_text_says_where_limits_and_offsets_come_from(qiao):
    text = format_robot(CollisionModel.of(qiao, "none"), MM_DEG)
    assert words_of(text, "d_x")[-1] == "calibrated"
    assert words_of(text, "q1")[-1] == "published"
    assert words_of(text, "load_centre")[-1] == "calibrated"


def test_wheels_are_shown_with_their_sources(qiao, unwheeled):
    text = format_robot(CollisionModel.of(qiao, "none"), MM_DEG)
    assert words_of(text, "radius") == ["radius", "100", "published"]
    assert words_of(text, "half_track") == ["half_track", "259", "calibrated"]
    assert words_of(format_robot(CollisionModel.of(qiao, "none"), Units()), "half_track")[1] == "0.259"
    assert robot_json(CollisionModel.of(qiao))["wheels"] == {
        "radius_m": 0.1,
        "half_track_m": 0.259,
        "half_wheelbase_m": None,
    }
    assert "half_track" not in format_robot(CollisionModel.of(replace(unwheeled, provenance={}), "none"), MM_DEG)
    assert robot_json(CollisionModel.of(unwheeled, "none"))["wheels"] is None


def test_text_names_the_unit_of_the_offsets(qiao):
    assert "offset [mm]" in format_robot(CollisionModel.of(qiao, "none"), MM_DEG)
    assert "offset [m]" in format_robot(CollisionModel.of(qiao, "none"), Units())


def test_pairs_are_those_of_the_detector_that_is_asked_for(qiao):
    for name in qiao.detectors:
        shown = format_robot(CollisionModel.of(qiao, name), MM_DEG)
        assert f"collision: detector {name} compares 35 pairs, 20 left out" in shown
        assert robot_json(CollisionModel.of(qiao, name))["collision"]["detector"] == name
    assert robot_json(CollisionModel.of(qiao, "none"))["collision"] is None


def test_json_has_the_pairs_that_the_file_declares_adjacent(qiao):
    declared = robot_json(CollisionModel.of(qiao, "none"))["adjacent"]
    assert [(pair["a"], pair["b"]) for pair in declared] == [("M", "J2"), ("L2", "J5"), ("J4", "J5")]
    assert all(pair["reason"] for pair in declared)


@pytest.mark.parametrize("width", [80, 120])
def test_tables_fit_the_page(any_robot, width):
    text = format_robot(CollisionModel.of(any_robot), MM_DEG, width=width)
    assert max(map(len, text.splitlines())) <= width


def test_the_default_detector_is_marked(qiao):
    text = format_robot(CollisionModel.of(qiao, "none"), MM_DEG)
    assert "improved (default)" in text
    assert "typical (default)" not in text


def test_citations_in_brackets_are_shown_as_they_are(qiao):
    assert "[Qiao2021, eq. 22]" in format_robot(CollisionModel.of(qiao, "none"), MM_DEG)


def test_a_title_in_brackets_is_shown_as_it_is(qiao):
    robot = replace(qiao, title="arm [v2] of [/] mine")
    assert "arm [v2] of [/] mine" in format_robot(CollisionModel.of(robot, "none"), MM_DEG)
    assert "arm [v2] of [/] mine" in format_robots([robot])


def test_sources_are_counted(qiao):
    robot = replace(
        qiao,
        provenance={("a",): Provenance(kind="derived", text="one place")}
        | {("b",): Provenance(kind="derived", text="one place")},
    )
    assert "2" in words_of(format_robot(CollisionModel.of(robot, "none"), MM_DEG), "derived")


def test_a_joint_without_limits_shows_none():
    robot = load_text(ENDLESS)
    data = json.loads(json.dumps(robot_json(CollisionModel.of(robot)), allow_nan=False))["joints"]
    assert [(joint["lower"], joint["upper"]) for joint in data if joint["kind"] == "continuous"] == [(None, None)] * 2
    assert [joint["lower"] for joint in data][1:5] == robot.lower[1:5].tolist()
    shown = words_of(format_robot(CollisionModel.of(robot), MM_DEG), "spin")
    assert shown == ["spin", "continuous", "none", "90", "none", "deg"]
