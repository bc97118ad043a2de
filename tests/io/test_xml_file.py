"""What URDF and MJCF share: numbers that read back, names, comments, and files that are whole or not there."""

import xml.etree.ElementTree as ET
from dataclasses import replace

import pytest

from ikde.errors import FileError, InputError
from ikde.io.mjcf import format_mjcf
from ikde.io.urdf import format_urdf
from ikde.io.xml_file import format_document, format_numbers, list_carriers, list_components, reserve_name, write_xml
from ikde.model.collision_model import CollisionModel
from tests.random_robots import make_frame, make_robot

FORMATS = pytest.mark.parametrize("write", [format_urdf, format_mjcf])


def test_numbers_read_back_as_the_same_bits(rng):
    values = [*rng.normal(size=50), 1e-300, 1.0 / 3.0, 5e-324, 1e9]
    assert [float(word) for word in format_numbers(values).split()] == values


def test_a_negative_zero_is_a_zero():
    assert format_numbers([-0.0, 0]) == "0.0 0.0"


def test_a_taken_name_gets_underscores():
    taken = {"arm", "arm_"}
    assert [reserve_name(name, taken) for name in ("arm", "arm", "leg")] == ["arm__", "arm___", "leg"]
    long = "component_" + 100 * "x"
    assert [len(reserve_name(long, taken)) for _ in range(12)] == 12 * [100]
    assert {long[:100], f"{long[:99]}_", f"{long[:98]}__"} <= taken


@pytest.mark.parametrize("note", ["plain", "two -- dashes", "---->", "ends with -"])
def test_any_note_is_a_comment(note):
    assert ET.fromstring(format_document(ET.Element("robot"), [note])).tag == "robot"


def test_components_stand_on_the_frames_of_their_joints(any_robot):
    carriers = list_carriers(any_robot)
    assert carriers[0] == "world"
    assert len(set(carriers)) == len(any_robot.joints) + 1
    for detector in any_robot.detectors.values():
        components = list_components(CollisionModel(robot=any_robot, detector=detector))
        assert tuple(components) == any_robot.components(detector.spheres)
    assert list_components(CollisionModel.of(any_robot, "none")) == {}


@FORMATS
@pytest.mark.parametrize("name", ["a<b", 'say "hi" & go', "gelenk ä", "a -- b"])
def test_odd_names_survive(write, name):
    robot = make_robot({name: "revolute"}, [make_frame("tool", "world", joint=name, axis=(0, 0, 1))], name=name)
    root = ET.fromstring(write(robot))
    assert name in {joint.get("name") for joint in root.iter("joint")}


@FORMATS
def test_a_name_that_xml_cannot_hold_is_refused(write, qiao):
    """No robot that was checked has one."""
    with pytest.raises(InputError, match="which XML cannot"):
        write(replace(qiao, name="j\x01"))


@FORMATS
def test_an_unknown_detector_is_refused(write, qiao):
    with pytest.raises(InputError, match="no detector 'imporved'"):
        write(qiao, collision="imporved")


@FORMATS
def test_without_a_detector_there_are_no_spheres(write, qiao):
    text = write(qiao, collision="none")
    assert "component_" not in text
    assert "radius" not in text


@FORMATS
@pytest.mark.parametrize("name", ["single", "typical", "improved"])
def test_the_detector_chooses_the_spheres(write, qiao, name):
    elements = ET.fromstring(write(qiao, collision=name)).iter("collision" if write is format_urdf else "geom")
    names = [element.get("name") for element in elements if element.get("name")]
    rows = qiao.approximations[name]
    assert len(names) == len(set(names)) == sum(row.count for row in rows)
    assert set(names) == {f"{s.component}_{k}" for c in _spheres(qiao, name) for k, s in enumerate(c)}
    assert write(qiao, collision=name) == write(
        qiao, collision=replace(CollisionModel.of(qiao, name).detector, name=name)
    )


def _spheres(robot, name):
    return list_components(CollisionModel.of(robot, name)).values()


def test_a_file_is_written_whole_and_over_an_older_one(tmp_path):
    path = tmp_path / "robot.urdf"
    for text in ("<robot/>", "<robot>ä</robot>"):
        write_xml(path, text)
        assert path.read_text(encoding="utf-8") == text
    assert list(tmp_path.iterdir()) == [path]


def test_a_place_that_is_no_file_is_refused(tmp_path):
    for path in (tmp_path, tmp_path / "missing" / "robot.urdf"):
        with pytest.raises(FileError, match="cannot be written"):
            write_xml(path, "<robot/>")
