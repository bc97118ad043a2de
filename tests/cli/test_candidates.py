"""What a shell is offered: names that are there, and nothing that a shell would run."""

from types import SimpleNamespace

import pytest

from ikde.cli.candidates import ROBOT, offer, offer_joints, offer_robots, offer_section


@pytest.fixture(autouse=True)
def _no_robot_is_set(monkeypatch):
    monkeypatch.delenv(ROBOT, raising=False)


def context(**params):
    return SimpleNamespace(params=params)


def test_words_and_robots_that_begin_so_are_offered():
    assert offer("motion", "clearance", "limits")("m") == ["motion"]
    assert offer_robots("ur") == ["ur5"]
    assert {"panda", "qiao2021", "ur5"} <= set(offer_robots(""))
    assert offer_robots("zz") == []


def test_a_section_is_that_of_the_chosen_robot(monkeypatch):
    detectors = offer_section("detectors", "none")
    assert {"improved", "none"} <= set(detectors(context(), ""))
    assert "improved" not in detectors(context(robot="ur5"), "")
    assert detectors(context(robot="ur5"), "n") == ["none"]
    monkeypatch.setenv(ROBOT, "ur5")
    assert "improved" not in detectors(context(), "")


def test_joints_are_offered_once_each_behind_commas():
    assert offer_joints()(context(), "d_") == ["d_x", "d_y"]
    assert offer_joints("=")(context(), "d_x=1,d_") == ["d_x=1,d_y="]


def test_names_that_a_shell_would_run_are_not_offered(tmp_path):
    file = tmp_path / "robot.yaml"
    file.write_text('joints: {"$(touch x)": 1, fine: 2, "a b": 3}')
    assert offer_joints()(context(robot=str(file)), "") == ["fine"]


@pytest.mark.parametrize("text", ["[1, 2", "- 1", "joints: 3", ""])
def test_a_file_that_is_no_robot_offers_nothing(tmp_path, text):
    file = tmp_path / "robot.yaml"
    file.write_text(text)
    assert offer_joints()(context(robot=str(file)), "") == []
    assert offer_joints()(context(robot=str(tmp_path / "nowhere.yaml")), "") == []
