"""Tools of one robot: one is asked, the other arm is held where it stands, and still collides."""

from dataclasses import replace

import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from ikde.model.tools import find_tool, list_chain, list_held, name_tool, with_tool
from tests.dual_arm import DUAL, TOOLS
from tests.urdf_texts import write

RIGHT = ("right_shoulder", "right_elbow")


@pytest.fixture(scope="module")
def dual(tmp_path_factory):
    return ikde.import_urdf(write(tmp_path_factory.mktemp("dual"), DUAL), tool=TOOLS)


def test_the_first_tool_is_asked_and_the_other_arm_is_held_at_home(dual):
    assert (dual.tool, name_tool(dual), list_held(dual)) == ("left_hand", "left", RIGHT)
    assert len(dual.joints) == 5
    held = [joint for joint in dual.joints if joint.name in RIGHT]
    assert all((joint.lower, joint.upper, joint.kind) == (joint.home, joint.home, "revolute") for joint in held)
    assert [joint.kind for joint in dual.whole.joints] == ["revolute"] + 2 * ["revolute", "continuous"]


def test_another_tool_frees_what_was_held(dual):
    right = dual.with_tool("right")
    assert (right.tool, list_held(right)) == ("right_hand", ("left_shoulder", "left_elbow"))
    assert right.with_tool("left") == dual
    assert right.with_tool() == right
    assert list_chain(right, right.tool) == ("waist", *RIGHT)


def test_held_joints_stand_where_they_are_asked_to(dual):
    robot = dual.with_tool("left", {"right_shoulder": 0.5, "right_elbow": 2.0})
    assert dict(zip(robot.joint_names, robot.home.tolist(), strict=True)) == {
        "waist": 0.0, "left_shoulder": 0.0, "left_elbow": 0.0, "right_shoulder": 0.5, "right_elbow": 2.0
    }  # fmt: skip


def place(robot, joints, frame):
    """Where a frame is with these joints, others at home, and a target there."""
    q = [joints.get(joint.name, joint.home) for joint in robot.joints]
    return ikde.Target(tuple(ikde.forward(robot, np.array(q))[frame][:3, 3]))


def test_a_search_moves_the_asked_arm_alone(dual):
    robot = dual.with_tool("left", {"right_shoulder": 0.6, "right_elbow": -0.4})
    target = place(dual.whole, {"waist": 0.3, "left_shoulder": 0.9, "left_elbow": -1.2}, "left_hand")
    for seed in range(4):
        result = ikde.solve(robot, target, seed=seed)
        assert result.reached
        assert result.q[[dual.joint_names.index(name) for name in RIGHT]].tolist() == [0.6, -0.4]


def test_where_the_other_arm_stands_nothing_is_reached(dual):
    """Its hand is where the left hand is asked to be, and the waist cannot help."""
    waist = dual.joints[0]
    still = replace(dual.whole, joints=(replace(waist, lower=0.0, upper=0.0), *dual.whole.joints[1:]))
    there = {"right_shoulder": 1.2, "right_elbow": 0.0}
    target = place(still, there, "right_hand")
    assert ikde.solve(still.with_tool("left"), target, {"restarts": 20}).reached
    result = ikde.solve(still.with_tool("left", there), target, {"restarts": 20})
    assert not result.reached
    assert "right_fore" in result.reason


def test_a_saved_robot_has_all_joints_and_loads_with_the_same_tool(dual, tmp_path):
    right = dual.with_tool("right")
    right.save(tmp_path / "dual.yaml")
    again = ikde.load_robot(tmp_path / "dual.yaml")
    assert again.tools == TOOLS
    assert (again.tool, list_held(again)) == (right.tool, list_held(right))
    assert again.whole.joints == dual.whole.joints
    np.testing.assert_array_equal(again.home, right.home)


def test_a_frame_of_a_robot_without_tools_is_a_tool_as_well(qiao):
    robot = ikde.load_robot("xarm7")
    chain = list_chain(robot, robot.tool)
    frame = next(frame.name for frame in robot.frames if frame.joint == chain[4])
    assert list_held(with_tool(robot, frame)) == chain[5:]
    assert with_tool(robot, robot.tool) is robot
    assert find_tool(robot, "tool") == robot.tool
    with pytest.raises(InputError, match="the frame 'tool' stands for the tool"):
        with_tool(qiao, qiao.frames[-2].name)


@pytest.mark.parametrize(
    ("name", "held", "message"),
    [
        ("lefft", {}, "no tool and no frame of dual is called 'lefft' (did you mean 'left'?)"),
        ("middle", {}, "no tool and no frame of dual is called 'middle'; its tools are left, right"),
        ("base", {}, "no joint moves 'base'"),
        ("left", {"right_shoulde": 0.0}, "no joint is called 'right_shoulde' (did you mean 'right_shoulder'?)"),
        ("left", {"right_shoulder": 3.0}, "expected a number from -2 to 2, got 3"),
        ("left", {"right_shoulder": "up"}, "expected a number from -2 to 2"),
        ("left", {"waist": 0.5}, "waist: this joint moves the tool and is not held"),
    ],
)
def test_what_is_wrong_is_one_line(dual, name, held, message):
    with pytest.raises(InputError) as caught:
        dual.with_tool(name, held)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)
