"""From a file to a robot: what was decided, and that whatever a file holds is answered with a robot or one line."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import ikde
from ikde.errors import IkdeError, InputError
from ikde.io.urdf_import.options import ImportOptions
from ikde.io.urdf_import.read_urdf import import_urdf, read_urdf
from tests.urdf_texts import ARM, FINGERS, extend, joint, write

NUMBERS = st.sampled_from(["0", "1", "-0.5", "3.2", "1e-7", "1e5", "1e300", "inf", "nan", "x", "", "0 0"])
VECTORS = st.sampled_from(
    ["0 0 1", "1 2 3", "0 0 0", "1e5 0 0", "1e200 1 1", "nan 0 0", "1 2", "", "a b c", "0.1 -0.2 0.3"]
)
SCALES = st.sampled_from(["1 1 1", "1 -1 1", "0.001 0.001 0.001", "0 1 1", "1e5 1 1", "nan 1 1"])
LINKS = st.sampled_from(["base", "a", "b", "c", "tool", "world"])
JOINTS = st.sampled_from(["j", "k", "m", "base_x"])
KINDS = st.sampled_from(["revolute", "continuous", "prismatic", "fixed", "planar", "floating", "ball"])
SHAPES = st.sampled_from(["sphere", "box", "cylinder", "capsule", "mesh", "blob"])
MESHES = st.sampled_from(["a.stl", "b.obj", "package://arm/a.stl", "../a.stl", "file:///etc/passwd", "b.obj/"])


@st.composite
def links(draw):
    name = draw(LINKS)
    inside = ""
    if draw(st.booleans()):
        sizes = f'radius="{draw(NUMBERS)}" size="{draw(VECTORS)}" length="1" scale="{draw(SCALES)}"'
        shape = f'<{draw(SHAPES)} {sizes} filename="{draw(MESHES)}"/>'
        inside += f'<collision><origin rpy="{draw(VECTORS)}"/><geometry>{shape}</geometry></collision>'
    if draw(st.booleans()):
        moments = f'<inertia ixx="{draw(NUMBERS)}" iyy="1" izz="1" ixy="{draw(NUMBERS)}"/>'
        inside += f'<inertial><origin xyz="{draw(VECTORS)}"/><mass value="{draw(NUMBERS)}"/>{moments}</inertial>'
    return f'<link name="{name}">{inside}</link>'


@st.composite
def joints(draw):
    inside = f'<origin xyz="{draw(VECTORS)}" rpy="{draw(VECTORS)}"/><axis xyz="{draw(VECTORS)}"/>'
    if draw(st.booleans()):
        inside += f'<limit lower="{draw(NUMBERS)}" upper="{draw(NUMBERS)}" velocity="{draw(NUMBERS)}"/>'
    if draw(st.integers(0, 3)) == 0:
        inside += f'<mimic joint="{draw(JOINTS)}" multiplier="{draw(NUMBERS)}" offset="{draw(NUMBERS)}"/>'
    return joint(draw(JOINTS), draw(KINDS), draw(LINKS), draw(LINKS), inside)


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    st.lists(links(), min_size=1, max_size=4, unique_by=lambda text: text[:15]),
    st.lists(joints(), max_size=4, unique_by=lambda text: text[:16]),
    st.sampled_from(["urdf", "fixed", "omni"]),
    st.sampled_from([None, "a", "tool"]),
)
def test_a_file_of_any_pieces_is_a_robot_or_one_line(tmp_path, some_links, some_joints, base, tool):
    write(tmp_path, "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n", "b.obj")
    path = write(tmp_path, f"<robot>{''.join([*some_links, *some_joints])}</robot>")
    answer_or_refuse(path, ImportOptions(base=base, tool=tool))


@settings(max_examples=100, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.data())
def test_a_good_file_with_a_hole_is_a_robot_or_one_line(tmp_path, data):
    text = extend(FINGERS)
    start = data.draw(st.integers(0, len(text)))
    piece = data.draw(st.sampled_from(["", '"', "<", "/>", "nan", "9" * 400, "\x00", "&a;", "<a>", "-"]))
    path = write(tmp_path, text[:start] + piece + text[start + data.draw(st.integers(0, 40)) :])
    answer_or_refuse(path, ImportOptions(tool="tip"))


def answer_or_refuse(path, options):
    try:
        robot = read_urdf(path, options).robot
    except IkdeError as error:
        assert len(str(error).splitlines()) == 1
        return
    saved = path.with_suffix(".yaml")
    robot.save(saved)
    again = ikde.load_robot(saved)
    assert again.joints == robot.joints
    q = robot.home
    for name, T in ikde.forward(robot, q).items():
        np.testing.assert_allclose(ikde.forward(again, q)[name], T, rtol=1e-12, atol=1e-12)


def test_the_account_says_what_was_decided(tmp_path):
    path = write(tmp_path, extend(FINGERS))
    imported = read_urdf(str(path), ImportOptions(tool="tip"))
    assert (imported.root, imported.robot.tool, imported.tool_was_chosen) == ("base_link", "tip", False)
    assert [held.name for held in imported.held] == ["grip", "grip_mimic"]
    assert [(link.link, link.spheres) for link in imported.links] == [("base_link", 1), ("upper", 1), ("fore", 1)]
    assert (imported.home, imported.is_home_free, imported.warnings) == (
        "0, or mid-range where 0 is outside the limits",
        True,
        (),
    )
    assert read_urdf(write(tmp_path, ARM)).tool_was_chosen


def test_a_frozen_joint_that_would_move_with_the_chain_is_a_warning(tmp_path):
    text = extend(FINGERS.replace('mimic joint="grip"', 'mimic joint="shoulder"'))
    assert read_urdf(write(tmp_path, text), ImportOptions(tool="tip")).warnings == (
        "grip_mimic mimics shoulder, which moves: what it carries is checked where it is frozen",
    )
    both = read_urdf(write(tmp_path, text), ImportOptions(tool="tip", hold={"shoulder": 0.1}))
    assert not [warning for warning in both.warnings if "mimics" in warning]


def test_the_short_call_gives_the_same_robot(tmp_path):
    path = write(tmp_path, extend(FINGERS))
    robot = import_urdf(path, tool="tip", base="omni", hold={"grip": 0.02}, protrusion_m=0.01)
    options = ImportOptions(tool="tip", base="omni", hold={"grip": 0.02}, protrusion_m=0.01)
    other = read_urdf(path, options).robot
    assert robot.joints == other.joints
    for frame, same in zip(robot.frames, other.frames, strict=True):
        assert frame.p_parent_frame.tolist() == same.p_parent_frame.tolist()
    assert ikde.import_urdf(path, tool="tip", spheres=False).detectors == {}


def test_states_and_pairs_come_from_the_srdf(tmp_path):
    srdf = write(
        tmp_path,
        '<robot name="arm"><group_state name="home" group="g"><joint name="shoulder" value="0.4"/></group_state>'
        '<disable_collisions link1="base_link" link2="fore" reason="Never"/>'
        '<disable_collisions link1="base_link" link2="hand"/></robot>',
        "arm.srdf",
    )
    text = srdf.read_text(encoding="utf-8")
    beyond = write(tmp_path, text.replace('"0.4"', '"9"'), "beyond.srdf")
    assert read_urdf(write(tmp_path, ARM), ImportOptions(srdf=beyond)).robot.home.tolist() == [2.0, 0.25]
    imported = read_urdf(write(tmp_path, ARM), ImportOptions(srdf=srdf))
    assert imported.robot.home.tolist() == [0.4, 0.25]
    assert imported.home == "SRDF state home of g"
    assert [(pair.a, pair.b, pair.reason) for pair in imported.robot.adjacent] == [("base_link", "fore", "SRDF: Never")]
    assert imported.warnings[0] == "the SRDF names links that there are not: hand"


def test_a_tool_that_nothing_moves_is_refused(tmp_path):
    with pytest.raises(IkdeError, match="no joint moves the tool 'base_link'; name another link or a base"):
        import_urdf(write(tmp_path, ARM), tool="base_link")
    assert import_urdf(write(tmp_path, ARM), tool="base_link", base="omni").joint_names[2] == "base_yaw"


def test_a_urdf_is_a_robot_wherever_one_is_named(tmp_path):
    path = write(tmp_path, ARM)
    assert ikde.load_robot(path).joint_names == ikde.load_robot(str(path)).joint_names == ("shoulder", "slide")
    assert ikde.load_robot(path.rename(tmp_path / "ARM.URDF")).joint_names == ("shoulder", "slide")
    path = write(tmp_path, ARM)
    with pytest.raises(IkdeError, match="no such file"):
        ikde.load_robot("nowhere.urdf")
    run = {"robot": str(path), "targets": {"inline": [{"position": [0.3, 0.1, 0.8]}]}}
    assert ikde.load_batch(run).robot.joint_names == ("shoulder", "slide")


def test_a_pair_that_is_asked_for_is_compared(tmp_path):
    path = write(tmp_path, ARM)
    assert ("upper", "fore") not in ikde.import_urdf(path).pair_lists["non_adjacent"]
    assert ("upper", "fore") in ikde.import_urdf(path, compare=[("upper", "fore")]).pair_lists["non_adjacent"]
    with pytest.raises(InputError, match="no link with spheres is called 'uper'"):
        ikde.import_urdf(path, compare=[("uper", "fore")])
    for wrong in ("upper:fore", ["upper:fore"], [("upper",)], [(1, 2)]):
        with pytest.raises(InputError, match="compare: expected pairs of links"):
            ikde.import_urdf(path, compare=wrong)
