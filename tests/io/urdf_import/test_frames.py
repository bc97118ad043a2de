"""Frames and joints out of a tree: as URDF defines them, on every base."""

import numpy as np
import pytest

from ikde.io.urdf_import.options import ImportOptions
from ikde.io.urdf_import.read_urdf import read_urdf
from ikde.model.base_motion import find_planar_base, usual_drive
from ikde.solver.forward import forward
from tests.random_urdfs import random_urdf
from tests.slow_urdf import slow_frames
from tests.urdf_texts import ARM, FINGERS, change, extend, joint, write


def load(folder, text, **options):
    return read_urdf(write(folder, text), ImportOptions(spheres=False, **options))


def draw(robot, seed, count=5):
    return np.random.default_rng(seed).uniform(*robot.drawn, (count, len(robot.joints)))


def values_at(imported, q):
    return {one.name: one.value for one in imported.held} | dict(zip(imported.robot.joint_names, q, strict=True))


@pytest.mark.parametrize("seed", range(12))
def test_every_frame_is_where_the_definition_says(tmp_path, seed):
    text = random_urdf(seed)
    tool = text.count("<link") - 1
    imported = load(tmp_path, text, tool=f"l{tool}")
    for q in draw(imported.robot, seed):
        frames = forward(imported.robot, q)
        for link, T in slow_frames(text, values_at(imported, q)).items():
            np.testing.assert_allclose(frames[link], T, rtol=0, atol=1e-13)


def test_frames_are_pinocchios(tmp_path):
    pin = pytest.importorskip("pinocchio")
    text = random_urdf(3)
    imported = load(tmp_path, text, tool=f"l{text.count('<link') - 1}")
    model = pin.buildModelFromXML(text)
    data = model.createData()
    for values in (values_at(imported, q) for q in draw(imported.robot, 0, 20)):
        theirs = pin.neutral(model)
        for name, value in values.items():
            one = model.joints[model.getJointId(name)]
            theirs[one.idx_q : one.idx_q + one.nq] = [value] if one.nq == 1 else [np.cos(value), np.sin(value)]
        pin.framesForwardKinematics(model, data, theirs)
        frames = forward(imported.robot, [values[name] for name in imported.robot.joint_names])
        for link in imported.robot.frames:
            T = data.oMf[model.getFrameId(link.name, pin.BODY)].homogeneous
            np.testing.assert_allclose(frames[link.name], T, rtol=0, atol=1e-12)


def test_joints_keep_kind_limits_speed_and_effort(tmp_path):
    shoulder, slide = load(tmp_path, ARM).robot.joints
    assert (shoulder.kind, shoulder.lower, shoulder.upper, shoulder.home) == ("revolute", -1.5, 2.0, 0.0)
    assert (shoulder.max_speed, shoulder.max_effort) == (1.2, 30.0)
    assert (slide.kind, slide.home, slide.max_speed) == ("prismatic", 0.25, None)  # home in mid-range: 0 is outside


@pytest.mark.parametrize("limit", ["", '<limit lower="-1e16" upper="1e16"/>', '<limit lower="-inf" upper="inf"/>'])
def test_a_joint_without_limits_turns_without_end_or_slides_far_and_that_is_said(tmp_path, limit):
    text = change('<limit lower="-1.5" upper="2" velocity="1.2" effort="30"/>', limit)
    imported = load(tmp_path, text.replace('<limit lower="0.1" upper="0.4" velocity="0"/>', limit))
    shoulder, slide = imported.robot.joints
    assert shoulder.kind == "continuous"
    assert (slide.kind, slide.lower, slide.upper) == ("prismatic", -100.0, 100.0)
    assert imported.joint_notes == {
        "shoulder": "no limits in the file: continuous",
        "slide": "no limits in the file: -100 to 100 m",
    }


def test_a_slide_with_one_limit_keeps_it(tmp_path):
    imported = load(tmp_path, change('lower="0.1" upper="0.4"', 'lower="-1e16" upper="0.4"'))
    assert (imported.robot.lower[1], imported.robot.upper[1]) == (-100.0, 0.4)
    assert imported.joint_notes == {"slide": "no lower limit in the file: -100 to 0.4 m"}


@pytest.mark.parametrize(
    ("kind", "lower", "upper", "kept", "note"),
    [
        ("revolute", "-1", "inf", (-1.0, -1.0 + 2 * np.pi), "no upper limit in the file: -1 to 5.28319 rad"),
        ("revolute", "-1e6", "1", (1.0 - 2 * np.pi, 1.0), "no lower limit in the file: -5.28319 to 1 rad"),
        ("prismatic", "-1", "inf", (-1.0, 100.0), "no upper limit in the file: -1 to 100 m"),
        ("prismatic", "150", "inf", (150.0, 250.0), "no upper limit in the file: 150 to 250 m"),
        ("prismatic", "-inf", "-150", (-250.0, -150.0), "no lower limit in the file: -250 to -150 m"),
    ],
)
def test_the_only_limit_of_a_joint_is_kept(tmp_path, kind, lower, upper, kept, note):
    text = ARM.replace('lower="0.1" upper="0.4"', f'lower="{lower}" upper="{upper}"').replace("prismatic", kind)
    imported = load(tmp_path, text)
    slide = imported.robot.joints[1]
    assert slide.kind == kind
    assert (slide.lower, slide.upper) == pytest.approx(kept, abs=0.0)
    assert imported.joint_notes == {"slide": note}


def test_a_joint_that_cannot_move_is_kept_and_that_is_said(tmp_path):
    imported = load(tmp_path, change('lower="0.1" upper="0.4"', ""))
    assert (imported.robot.lower[1], imported.robot.upper[1]) == (0.0, 0.0)
    assert imported.joint_notes == {"slide": "cannot move: both limits are 0"}


@pytest.mark.parametrize(("base", "drive"), [("omni", "omnidirectional"), ("differential", "differential")])
def test_a_base_drives_in_the_plane_under_the_root(tmp_path, base, drive):
    robot = load(tmp_path, ARM, base=base, base_reach_m=20.0).robot
    assert robot.joint_names == ("base_x", "base_y", "base_yaw", "shoulder", "slide")
    assert [joint.kind for joint in robot.joints[:3]] == ["prismatic", "prismatic", "continuous"]
    assert robot.lower[:2].tolist() == [-20.0, -20.0]
    assert robot.upper[:2].tolist() == [20.0, 20.0]
    assert find_planar_base(robot).tolist() == [0, 1, 2]
    assert robot.drive == usual_drive(robot) == drive
    still = load(tmp_path, ARM).robot
    moved = forward(robot, [1.0, 2.0, np.pi / 2, 0.3, 0.2])["tip"]
    T = np.array([[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 0], [0, 0, 0, 1.0]])
    np.testing.assert_allclose(moved, T @ forward(still, [0.3, 0.2])["tip"], atol=1e-14)


def test_names_of_the_base_give_way_to_those_of_the_file(tmp_path):
    robot = load(tmp_path, ARM.replace('"shoulder"', '"base_x"').replace('"upper"', '"base_y"'), base="omni").robot
    assert robot.joint_names == ("base_x_", "base_y", "base_yaw", "base_x", "slide")
    assert [frame.name for frame in robot.frames[:4]] == ["base_x_", "base_y_", "base_link", "base_y"]


def test_a_planar_joint_is_two_slides_and_a_turn(tmp_path):
    plane = joint("root", "planar", "ground", "base_link", '<origin xyz="0 0 1"/><axis xyz="0 1 0"/>')
    imported = load(tmp_path, extend('<link name="ground"/>' + plane), base_reach_m=3.0)
    robot = imported.robot
    assert robot.joint_names[:3] == ("root_x", "root_y", "root_yaw")
    assert set(imported.joint_notes.values()) == {"of the planar joint root"}
    T = forward(robot, [0.5, 0.0, 0.0, 0.0, 0.1])["base_link"] - forward(robot, [0.0, 0.0, 0.0, 0.0, 0.1])["base_link"]
    assert abs(T[1, 3]) < 1e-15
    assert np.linalg.norm(T[:3, 3]) == pytest.approx(0.5)
    turned = forward(robot, [0.3, -0.2, 0.7, 0.0, 0.1])["base_link"]
    np.testing.assert_allclose(turned[:3, 1], [0, 1, 0], atol=1e-15)  # the normal stays
    assert turned[0, 0] == pytest.approx(np.cos(0.7))
    sideways = [forward(robot, [*xy, 0.0, 0.0, 0.1])["base_link"][:3, 3] for xy in ((0, 0), (1, 0), (0, 1))]
    np.testing.assert_allclose(np.cross(sideways[1] - sideways[0], sideways[2] - sideways[0]), [0, 1, 0], atol=1e-15)


def test_a_planar_joint_with_limits_keeps_them(tmp_path):
    plane = joint("root", "planar", "ground", "base_link", '<limit lower="1" upper="2"/>')
    robot = load(tmp_path, extend('<link name="ground"/>' + plane)).robot
    assert (robot.lower[:2].tolist(), robot.upper[:2].tolist()) == ([1, 1], [2, 2])
    assert robot.home[:3].tolist() == [1.5, 1.5, 0]
    zero = load(tmp_path, extend('<link name="ground"/>' + plane.replace('"1"', '"0"').replace('"2"', '"0"'))).robot
    assert zero.upper[:2].tolist() == [100, 100]


def test_frozen_joints_are_part_of_what_they_connect(tmp_path):
    text = extend(FINGERS)
    imported = load(tmp_path, text, tool="tip", hold={"shoulder": 0.7, "grip": 0.04})
    assert imported.robot.joint_names == ("slide",)
    expected = slow_frames(text, {"shoulder": 0.7, "grip": 0.04, "grip_mimic": -0.077, "slide": 0.3})
    for link, T in expected.items():
        np.testing.assert_allclose(forward(imported.robot, [0.3])[link], T, atol=1e-15)


def test_links_with_names_of_ours_get_others_and_that_is_said(tmp_path):
    text = ARM.replace('"upper"', '"tool"').replace('"fore"', '"world"')
    imported = load(tmp_path, text)
    assert [frame.name for frame in imported.robot.frames] == ["base_link", "tool_link", "world_link", "tip"]
    assert [warning.split(":")[0] for warning in imported.warnings[:2]] == [
        "the link 'tool' is called 'tool_link' here",
        "the link 'world' is called 'world_link' here",
    ]


def test_a_root_called_world_is_the_world_and_a_tool_called_tool_the_tool(tmp_path):
    imported = load(tmp_path, ARM.replace("base_link", "world").replace('"tip"', '"tool"'))
    assert [frame.name for frame in imported.robot.frames] == ["upper", "fore", "tool"]
    assert imported.robot.tool == "tool"
    assert imported.robot.frames[0].parent == "world"
    assert load(tmp_path, ARM.replace("base_link", "world"), base="omni").robot.frames[2].name == "world_link"


@pytest.mark.parametrize("kind", ["revolute", "continuous"])
def test_a_held_joint_turns_what_it_carries(tmp_path, kind):
    text = change('name="shoulder" type="revolute"', f'name="shoulder" type="{kind}"')
    held = forward(load(tmp_path, text, hold={"shoulder": 0.7}).robot, [0.2])["tip"]
    moved = forward(load(tmp_path, text).robot, [0.7, 0.2])["tip"]
    np.testing.assert_allclose(held, moved, atol=1e-15)
