"""What ikde writes into its URDFs for itself: read to the bit, and refused in one line where it is wrong."""

from math import cos, sin

import pytest

import ikde
from ikde.errors import FileError
from ikde.io.urdf_import.description import read_description
from ikde.io.urdf_import.own_marks import OwnMarks
from tests.urdf_texts import ARM, extend, write

END = """\
<link name="component_pad"><collision><geometry><sphere radius="0.03"/></geometry></collision></link>
<joint name="glue" type="fixed"><origin xyz="0 0 0.05" rpy="0 0 1"/>
  <parent link="fore"/><child link="component_pad"/></joint>
"""
MOVES = '<joint name="m" type="continuous"><parent link="fore"/><child link="e"/></joint>'
PAD = '<component name="pad" link="component_pad"/>'


def test_of_a_file_without_the_element_there_is_nothing(tmp_path):
    assert read_description(write(tmp_path, ARM)).marks == OwnMarks()


def test_a_component_is_no_frame_and_stands_where_its_link_does(tmp_path):
    path = write(tmp_path, extend(f'{END}<ikde tool="tip">{PAD}</ikde>'))
    robot = ikde.import_urdf(path)
    assert robot.tool == "tip"
    assert "component_pad" not in [frame.name for frame in robot.frames]
    (pad,) = [entry for entry in robot.approximations["spheres"] if entry.component == "pad"]
    assert (pad.frame, pad.spheres) == ("fore", ((0.0, 0.0, 0.05, 0.03),))


def test_spheres_of_a_component_turn_with_its_link(tmp_path):
    end = END.replace('<geometry><sphere radius="0.03"', '<origin xyz="0.1 0 0"/><geometry><sphere radius="0.03"')
    robot = ikde.import_urdf(write(tmp_path, extend(f'{end}<ikde tool="tip">{PAD}</ikde>')))
    (pad,) = [entry for entry in robot.approximations["spheres"] if entry.component == "pad"]
    assert pad.spheres[0] == pytest.approx((0.1 * cos(1.0), 0.1 * sin(1.0), 0.05, 0.03), abs=1e-15)


def test_joints_that_are_not_marked_stand_before_those_that_are(tmp_path):
    robot = ikde.import_urdf(write(tmp_path, extend('<ikde tool="tip"><coordinate joint="shoulder"/></ikde>')))
    assert robot.joint_names == ("slide", "shoulder")


def test_a_component_is_no_tool_as_it_is_no_frame(tmp_path):
    path = write(tmp_path, extend(f"{END}<ikde>{PAD}</ikde>"))
    message = "tool: the link 'component_pad' holds spheres of 'pad' and is no frame; expected another .* 'fore'$"
    for tool in ("component_pad", {"pad": "component_pad"}):
        with pytest.raises(FileError, match=message):
            ikde.import_urdf(path, tool=tool)
    own = write(tmp_path, extend(f'{END}<ikde tool="component_pad">{PAD}</ikde>'))
    with pytest.raises(FileError, match=message):
        ikde.import_urdf(own)


def test_a_placeholder_counts_as_long_as_nobody_has_changed_the_number(tmp_path):
    mark = '<ikde><placeholder joint="shoulder" velocity="1.2" effort="31"/><placeholder link="upper" mass="2"/></ikde>'
    robot = ikde.import_urdf(write(tmp_path, extend(mark)))
    assert (robot.joints[0].max_speed, robot.joints[0].max_effort, dict(robot.inertias)) == (None, 30.0, {})


def test_joints_are_in_the_order_of_the_marks_and_move_off_the_chain_as_well(tmp_path):
    mark = '<ikde tool="upper"><coordinate joint="slide" acceleration="3"/><coordinate joint="shoulder"/></ikde>'
    path = write(tmp_path, extend(mark))
    robot = ikde.import_urdf(path)
    assert robot.joint_names == ("slide", "shoulder")
    assert [joint.max_acceleration for joint in robot.joints] == [3.0, None]
    held = ikde.read_urdf(path, ikde.ImportOptions(hold={"slide": 0.2})).robot
    assert held.joint_names == ("shoulder",)


def test_the_safe_distance_is_that_of_the_detector(tmp_path):
    robot = ikde.import_urdf(write(tmp_path, extend('<ikde safe_distance="0.01"/>')))
    assert robot.detectors[robot.default_detector].safe_distance_m == 0.01


@pytest.mark.parametrize(
    ("mark", "message"),
    [
        ('<ikde tool="tipp"/>', "ikde.tool: no link is called 'tipp' (did you mean 'tip'?)"),
        ('<ikde safe_distance="-1"/>', "ikde.safe_distance: expected a distance of at least 0 m, got -1"),
        (
            '<ikde><coordinate joint="slid"/></ikde>',
            "ikde.coordinate: no joint is called 'slid' (did you mean 'slide'?)",
        ),
        (
            '<ikde><coordinate joint="slide" acceleration="-2"/></ikde>',
            "expected a number above 0, up to 1e+09, got -2",
        ),
        ('<ikde><component link="upper" name="u"/></ikde>', "expected a link at an end, on a fixed joint, got 'upper'"),
        ('<ikde><component link="gone" name="u"/></ikde>', "ikde.component: no link is called 'gone'"),
        ('<ikde><component link="tip"/></ikde>', "expected an attribute 'name'"),
        ('<link name="e"/>' + MOVES + '<ikde><component link="e" name="e"/></ikde>', "on a fixed joint, got 'e'"),
        (
            '<ikde>\n<component link="tip" name="a&#10;b"/></ikde>',
            "arm.urdf:22 → ikde.component: expected a name of printable characters",
        ),
        ('<ikde><placeholder joint="slide" velocity="fast"/></ikde>', "expected a number, got 'fast'"),
    ],
)
def test_what_is_wrong_is_one_line(tmp_path, mark, message):
    with pytest.raises(FileError) as caught:
        ikde.import_urdf(write(tmp_path, extend(mark)), tool="tip")
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)
