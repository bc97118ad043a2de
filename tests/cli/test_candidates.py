"""What shells are offered: names of robots, and of what the chosen robot has; nothing that a shell would obey."""

from types import SimpleNamespace

import pytest

import ikde
from ikde.cli.candidates import offer, offer_joints, offer_robots, offer_section


def asked(*words, **params):
    return SimpleNamespace(params=params, args=list(words))


def test_robots_are_offered_by_their_beginning():
    assert offer_robots("") == list(ikde.robot_names())
    assert offer_robots("qiao2021_") == ["qiao2021_dh"]
    assert offer_robots("arm.yaml") == []


@pytest.mark.parametrize("params", [{"robot": "ur5"}, {"name": "ur5"}])
def test_names_are_those_of_the_chosen_robot(params):
    assert offer_joints()(asked(**params), "wrist_1") == ["wrist_1_joint"]
    assert offer_section("detectors", "none")(asked(**params), "") == ["default", "none"]


def test_a_robot_may_be_a_word_that_is_not_read_yet():
    assert offer_section("detectors")(asked("ur5", name=None), "") == ["default"]
    assert offer_joints()(asked("run.yaml", spec=None), "d_") == ["d_x", "d_y"]


def test_without_a_robot_the_environment_chooses(monkeypatch):
    monkeypatch.delenv("IKDE_ROBOT", raising=False)
    assert offer_joints()(asked(), "d_") == ["d_x", "d_y"]
    monkeypatch.setenv("IKDE_ROBOT", "panda")
    assert offer_joints()(asked(), "") == list(ikde.load_robot("panda").joint_names)


def test_a_joint_is_offered_once_in_a_list():
    assert offer_joints("=")(asked(robot="qiao2021"), "d_x=1,q_z,d_") == ["d_x=1,q_z,d_y="]


def test_a_file_of_ones_own_is_read(tmp_path):
    file = tmp_path / "own.yaml"
    file.write_text("joints: {a: 1, '$(reboot)': 2, 'b c': 3, 'd;e': 4, f/g: 5}\n")
    assert offer_joints()(asked(robot=str(file)), "") == ["a", "f/g"]


@pytest.mark.parametrize("text", ["", "joints: 1", "[1, 2]", "joints: {", "<robot/>"])
def test_a_file_that_is_wrong_offers_nothing(tmp_path, text):
    file = tmp_path / "own.yaml"
    file.write_text(text)
    assert offer_joints()(asked(robot=str(file)), "") == []
    assert offer_joints()(asked(robot="nowhere.yaml"), "") == []


def test_words_are_offered_by_their_beginning():
    assert offer("motion", "found")("f") == ["found"]
