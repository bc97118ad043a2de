"""SRDF: what its readers disable are the pairs that the detector leaves out, between links of the URDF."""

import xml.etree.ElementTree as ET

import numpy as np
import pytest

import ikde
from ikde.io.sphere_files import read_spheres
from ikde.io.srdf_writer import format_srdf
from ikde.io.urdf import format_urdf
from ikde.io.urdf_import.description import read_description
from ikde.model.collision_model import CollisionModel
from tests.bare_robot import BARE
from tests.robot_files import load_text

DECLARED = 'adjacent:\n  pairs:\n    platform: {forearm: "a <post> & a \\"hook\\""}\n'


@pytest.mark.parametrize("name", ikde.robot_names())
def test_compared_and_disabled_pairs_are_all_pairs_of_links_with_spheres(name):
    robot = ikde.load_robot(name)
    model = CollisionModel.of(robot)
    links = {link.attrib["name"] for link in ET.fromstring(format_urdf(robot)).iter("link") if len(link) > 1}
    disabled = list(ET.fromstring(format_srdf(robot)).iter("disable_collisions"))
    assert {entry.attrib[key] for entry in disabled for key in ("link1", "link2")} <= links
    assert len(disabled) + len(model.pairs) == len(links) * (len(links) - 1) // 2


def test_reasons_are_kept():
    root = ET.fromstring(format_srdf(load_text(BARE + DECLARED)))
    reasons = {(e.attrib["link1"], e.attrib["link2"]): e.attrib["reason"] for e in root.iter("disable_collisions")}
    assert reasons == {
        ("component_platform", "component_forearm"): 'adjacent: a <post> & a "hook"',
        ("component_upper_arm", "component_forearm"): "joined by joint elbow",
    }


def test_a_component_whose_name_a_frame_has_is_called_as_in_the_urdf():
    text = BARE.replace("platform: {parent: deck", "component_forearm: {parent: deck}\n  platform: {parent: deck")
    robot = load_text(text + DECLARED)
    names = {link.attrib["name"] for link in ET.fromstring(format_urdf(robot)).iter("link")}
    disabled = [e.attrib["link2"] for e in ET.fromstring(format_srdf(robot)).iter("disable_collisions")]
    assert set(disabled) == {"component_forearm_"} <= names


def test_home_is_kept_to_the_bit(qiao):
    states = ET.fromstring(format_srdf(qiao)).iter("group_state")
    home = [float(joint.attrib["value"]) for state in states for joint in state.iter("joint")]
    np.testing.assert_array_equal(home, qiao.home)


def test_without_a_detector_nothing_is_disabled(qiao):
    text = format_srdf(qiao, collision="none")
    assert "disable_collisions" not in text
    assert "No collision shapes." in text


def test_spheres_are_those_of_the_urdf_beside_it(tmp_path):
    robot = ikde.load_robot("ur5")
    (tmp_path / "ur5.srdf").write_text(format_srdf(robot), encoding="utf-8")
    (tmp_path / "ur5.urdf").write_text(ikde.format_urdf(robot), encoding="utf-8")
    found = read_spheres(tmp_path / "ur5.srdf").spheres
    urdf = read_description(tmp_path / "ur5.urdf")
    for link, balls in found.items():
        own = [(*shape.T_link_shape[:3, 3].tolist(), *shape.size) for shape in urdf.links[link].shapes]
        assert list(balls) == own
    assert len(found) == len(CollisionModel.of(robot).components)
