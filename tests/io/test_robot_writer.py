"""A robot as its file: what is written comes back."""

from pathlib import Path

import numpy as np
import pytest

import ikde
from ikde.errors import FileError, InputError
from ikde.io.robot_writer import format_robot_file
from ikde.model.robot import Inertia
from tests.hostile_names import payload
from tests.random_robots import random_robot
from tests.robot_files import GOOD, load_text

EQUAL = ("name", "title", "joints", "tool", "approximations", "adjacent", "detectors", "default_detector")
ALSO = ("convention", "conventions", "provenance", "wheels", "drive", "neighbours")


def assert_comes_back(robot):
    again = load_text(format_robot_file(robot))
    for key in (*EQUAL, *ALSO):
        assert getattr(again, key) == getattr(robot, key), key
    assert {name: set(pairs) for name, pairs in again.pair_lists.items()} == {
        name: set(pairs) for name, pairs in robot.pair_lists.items()
    }
    q = np.random.default_rng(0).uniform(*robot.drawn, (10, len(robot.joints)))
    there, back = ikde.forward(robot, q), ikde.forward(again, q)
    assert list(there) == list(back)
    for name, T in there.items():
        np.testing.assert_allclose(back[name], T, rtol=0, atol=1e-13)
    return again


def test_every_robot_comes_back(any_robot):
    assert_comes_back(any_robot)


def test_mecanum_wheels_come_back():
    assert_comes_back(ikde.load_robot("ur5e_mecanum"))


@pytest.mark.parametrize("seed", range(5))
def test_random_robots_come_back(seed):
    assert_comes_back(random_robot(seed))


def test_save_writes_a_file_that_loads(tmp_path):
    robot = load_text(GOOD)
    robot.save(tmp_path / "robot.yaml")
    assert ikde.load_robot(tmp_path / "robot.yaml").joints == robot.joints
    robot.save(str(tmp_path / "robot.yaml"))
    with pytest.raises(FileError, match="cannot be written: its folder does not exist"):
        robot.save(tmp_path / "nowhere" / "robot.yaml")
    for name in ("robot.urdf", "mesh.STL", "robot.srdf", "page.html"):
        with pytest.raises(FileError, match=r"a robot file is YAML; expected a name that ends in \.yaml"):
            robot.save(tmp_path / name)
    for name in (5, None, b"robot.yaml"):
        with pytest.raises(InputError, match="path: expected the path of a file, got"):
            robot.save(name)
    assert [path.name for path in tmp_path.iterdir()] == ["robot.yaml"]


@pytest.mark.parametrize(
    "word", ["null", "True", "no", "1e3", "0x1", "~", "a: b", "{x}", "#c", "- d", "é", "a b", '"', "\\"]
)
def test_names_that_yaml_reads_otherwise_come_back(word):
    text = GOOD.replace("bar", "@@").replace("tip", "%%")
    quoted = '"' + word.replace("\\", "\\\\").replace('"', '\\"') + '"'
    assert_comes_back(load_text(text.replace("@@", quoted).replace("%%", '"tip of it"')))


def test_hostile_names_come_back_as_names(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # a whole path may be too long for a name
    name = payload(Path("made"))
    robot = load_text(GOOD.replace("bar", '"' + name.replace("\\", "\\\\").replace('"', '\\"') + '"'))
    assert_comes_back(robot)
    assert not (tmp_path / "made").exists()


def test_notes_are_comments_on_one_line_each():
    text = format_robot_file(load_text(GOOD), ["first", "tool: evil\nname: other"])
    assert text.startswith("# first\n# tool: evil\\nname: other\nname: two\n")
    assert load_text(text).name == "two"


def test_efforts_masses_and_the_drive_come_back():
    text = GOOD.replace("home: 10}", "home: 10, max_speed: 5, max_effort: 7}")
    text += "inertias:\n  arm: {mass: 3, com: [10, 0, 0], inertia: [1, 2, 3, 0.1, 0.2, 0.3]}\n"
    robot = assert_comes_back(load_text(text))
    assert robot.joints[1].max_effort == 7.0
    arm = robot.inertias["arm"]
    assert isinstance(arm, Inertia)
    assert (arm.mass_kg, arm.p_frame_com.tolist()) == (3.0, [0.01, 0, 0])
    assert arm.I_com_frame.tolist() == [[1, 0.1, 0.2], [0.1, 2, 0.3], [0.2, 0.3, 3]]


def test_free_spheres_come_back(tmp_path):
    robot = load_text(
        GOOD.replace("from: rail, radius: 200", "frame: rail, spheres: [[1, 2.5, 3, 200], [0, 0, 9, 30]]")
    )
    robot.save(tmp_path / "robot.yaml")
    assert ikde.load_robot(tmp_path / "robot.yaml").approximations == robot.approximations
