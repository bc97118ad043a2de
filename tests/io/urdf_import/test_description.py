"""What a URDF says, and the one line with the place of what is wrong in it."""

from math import inf

import numpy as np
import pytest

from ikde.errors import FileError
from ikde.io.urdf_import import description
from ikde.io.urdf_import.description import read_description
from ikde.model.rotation import rotation_from_rpy
from tests.urdf_texts import ARM, FINGERS, change, extend, joint, write


def reject(folder, text, place, message):
    with pytest.raises(FileError) as caught:
        read_description(write(folder, text))
    assert f" → {place}: " in str(caught.value) or not place
    assert message in caught.value.message
    assert str(caught.value).startswith(f"{folder / 'arm.urdf'}:")


def test_joints_are_read_with_places_axes_limits_speed_and_effort(tmp_path):
    found = read_description(write(tmp_path, ARM))
    assert (found.name, list(found.links), list(found.joints)) == (
        "arm",
        ["base_link", "upper", "fore", "tip"],
        ["shoulder", "slide", "flange"],
    )
    shoulder, slide, flange = found.joints.values()
    assert (shoulder.kind, shoulder.parent, shoulder.child) == ("revolute", "base_link", "upper")
    assert (shoulder.lower, shoulder.upper, shoulder.max_speed, shoulder.max_effort) == (-1.5, 2.0, 1.2, 30.0)
    assert shoulder.p_parent_child.tolist() == [0, 0, 0.2]
    np.testing.assert_array_equal(shoulder.R_parent_child, rotation_from_rpy(np.array([0.1, 0.2, 0.3])))
    np.testing.assert_allclose(shoulder.axis, np.array([0, 1, 1]) / np.sqrt(2), atol=1e-15)
    assert slide.axis.tolist() == [1, 0, 0]
    assert (slide.max_speed, slide.max_effort) == (None, None)
    assert (flange.kind, flange.lower, flange.upper) == ("fixed", -inf, inf)


def test_masses_are_read_along_the_axes_of_the_link(tmp_path):
    inertia = read_description(write(tmp_path, ARM)).links["upper"].inertia
    R = rotation_from_rpy(np.array([0, 0, 0.5]))
    own = np.array([[0.1, 0.01, 0], [0.01, 0.2, 0.02], [0, 0.02, 0.3]])
    assert (inertia.mass_kg, inertia.p_frame_com.tolist()) == (2.0, [0, 0, 0.2])
    light = read_description(write(tmp_path, change('<mass value="2"/>', '<mass value="0"/>')))
    assert light.links["upper"].inertia.mass_kg == 0.0
    np.testing.assert_allclose(inertia.I_com_frame, R @ own @ R.T, atol=1e-15)
    reject(tmp_path, change('<mass value="2"/>', '<mass value="-2"/>'), "link.upper.inertial", "at least 0 kg, got -2")


@pytest.mark.parametrize(
    ("geometry", "kind", "size", "scale"),
    [
        ('<sphere radius="0.3"/>', "sphere", (0.3,), (1, 1, 1)),
        ('<box size="1 2 3"/>', "box", (1, 2, 3), (1, 1, 1)),
        ('<cylinder length="2" radius="0.5"/>', "cylinder", (0.5, 2), (1, 1, 1)),
        ('<capsule length="2" radius="0.5"/>', "capsule", (0.5, 2), (1, 1, 1)),
        ('<mesh filename="a.stl" scale="0.001 -0.001 1"/>', "mesh", (), (0.001, -0.001, 1)),
    ],
)
def test_shapes_are_read_where_they_stand(tmp_path, geometry, kind, size, scale):
    text = change('<sphere radius="0.05"/>', geometry)
    (shape,) = read_description(write(tmp_path, text)).links["upper"].shapes
    assert (shape.kind, shape.size, shape.scale) == (kind, size, scale)
    assert shape.T_link_shape[:, 3].tolist() == [0, 0, 0.3, 1]
    assert shape.mesh == ("a.stl" if kind == "mesh" else "")


@pytest.mark.parametrize("geometry", ["<cone/>", ""])
def test_a_shape_that_is_not_read_is_a_warning(tmp_path, geometry):
    found = read_description(write(tmp_path, change('<sphere radius="0.05"/>', geometry)))
    assert found.links["upper"].shapes == ()
    assert len(found.warnings) == 1
    assert "a collision element of upper is left out" in found.warnings[0]


def test_a_mimic_joint_names_its_master(tmp_path):
    mimic = read_description(write(tmp_path, extend(FINGERS))).joints["grip_mimic"].mimic
    assert (mimic.joint, mimic.multiplier, mimic.offset) == ("grip", -2.0, 0.003)


def test_limits_that_are_not_given_are_none_or_as_urdf_says_0(tmp_path):
    with_none = change('<limit lower="0.1" upper="0.4" velocity="0"/>', "")
    slide = read_description(write(tmp_path, with_none)).joints["slide"]
    assert (slide.lower, slide.upper) == (-inf, inf)
    half = change('<limit lower="0.1" upper="0.4" velocity="0"/>', '<limit upper="0.4"/>')
    slide = read_description(write(tmp_path, half)).joints["slide"]
    assert (slide.lower, slide.upper) == (0.0, 0.4)


def test_a_robot_without_a_name_is_called_as_its_file(tmp_path):
    assert read_description(write(tmp_path, change(' name="arm"', ""), "my.urdf")).name == "my"


@pytest.mark.parametrize(
    ("old", "new", "place", "message"),
    [
        ("<robot", "<model", "", "mismatched tag"),
        ('link name="upper"', 'link name="fore"', "link.fore", "this name is given twice, first in line 4"),
        ('joint name="slide"', 'joint name="shoulder"', "joint.shoulder", "given twice"),
        ('joint name="slide"', 'joint name="slide\u202e"', "joint.slide\\u202e", "printable characters"),
        ('link name="tip"', "link", "link", "expected an attribute 'name'"),
        ('type="prismatic"', 'type="screw"', "joint.slide", "expected one of revolute, continuous, prismatic"),
        (
            'child link="fore"',
            'child link="for"',
            "joint.slide.child",
            "no link is called 'for' (did you mean 'fore'?)",
        ),
        ('<parent link="upper"/>', "", "joint.slide", "expected a <parent>"),
        ('axis xyz="0 1 1"', 'axis xyz="0 0 0"', "joint.shoulder.axis", "an axis that is neither zero nor huge"),
        ('axis xyz="0 1 1"', 'axis xyz="0 1e200 1"', "joint.shoulder.axis", "an axis that is neither zero nor huge"),
        ('ixx="0.1"', 'ixx="1e300"', "link.upper.inertial", "expected moments within 1e+09 of 0"),
        ('xyz="0.1 0 0.5"', 'xyz="0.1 0 nan"', "joint.slide.xyz", "expected 3 finite numbers"),
        ('xyz="0.1 0 0.5"', 'xyz="0.1 0 1e6"', "joint.slide.xyz", "within 100000 of 0"),
        ('lower="-1.5"', 'lower="nan"', "joint.shoulder.limit.lower", "expected a number, got 'nan'"),
        ('lower="-1.5"', 'lower="2.5"', "joint.shoulder.limit", "the upper limit 2 is below the lower one, 2.5"),
        ('radius="0.05"', 'radius="-1"', "link.upper.collision", "expected sizes above 0"),
        ('<sphere radius="0.05"/>', "<box/>", "link.upper.collision", "expected an attribute 'size' of <box>"),
        ('<sphere radius="0.05"/>', "<mesh/>", "link.upper.collision", "expected an attribute 'filename' of <mesh>"),
    ],
)
def test_what_is_wrong_is_one_line_with_its_place(tmp_path, old, new, place, message):
    reject(tmp_path, change(old, new), place, message)


def test_other_files_are_told_apart(tmp_path):
    reject(tmp_path, "<sdf/>", "", "expected <robot>, got <sdf>")
    reject(tmp_path, "<robot/>", "", "expected at least one <link>")


@pytest.mark.parametrize("name", ["arm.urdf", "arm.urdf.xacro", "arm.xacro"])
def test_xacro_is_recognised_and_answered_with_how_to_expand_it(tmp_path, name):
    text = "<robot><xacro:include filename='$(find x)/y.xacro'/></robot>" if name == "arm.urdf" else ARM
    target = "arm_expanded.urdf" if name == "arm.urdf" else "arm.urdf"  # not onto itself
    with pytest.raises(FileError, match=f"this is xacro, not URDF; expand it first: xacro {name} > {target}$"):
        read_description(write(tmp_path, text, name))


def test_the_number_of_links_is_limited(tmp_path, monkeypatch):
    monkeypatch.setattr(description, "MAX_LINKS", 4)
    read_description(write(tmp_path, ARM))
    more = '<link name="one"/>' + joint("j", "fixed", "tip", "one")
    reject(tmp_path, extend(more), "", "expected at most 4 links, got 5")
