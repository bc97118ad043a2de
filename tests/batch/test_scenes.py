"""Planning problems as questions: what is asked, what is held, and rows that are kept."""

from dataclasses import replace

import numpy as np
import pytest

import ikde
from ikde.batch.scenes import (
    LinkPose,
    Margins,
    ask,
    choose_tool,
    make_pose_question,
    make_question,
    read_known,
    refuse,
    run_scenes,
    summarise_rows,
)
from ikde.errors import InputError
from ikde.model.collision_model import CollisionModel
from ikde.solver.result import SolveResult
from tests.dual_arm import DUAL, TOOLS
from tests.three_joints import ROBOT
from tests.urdf_texts import write

GOAL = {"reach": 0.25, "turn": 1.5, "shoulder": 0.7}
WORLD = ikde.load_world({"obstacles": {"can": {"sphere": {"radius": 0.05}, "position": [2, 0, 0.5]}}})


def test_the_pose_is_that_of_the_goal_and_joints_are_by_name():
    question = make_question(ROBOT, {"finger": 0.4}, GOAL)
    T = ikde.forward(ROBOT, [1.5, 0.7, 0.25])["tip"]
    np.testing.assert_allclose(question.target.p_world_tool, T[:3, 3])
    np.testing.assert_allclose(question.target.R_world_tool, T[:3, :3])
    assert question.held == {}


def test_what_the_goal_does_not_name_or_does_not_move_the_tool_is_held():
    assert make_question(ROBOT, {"turn": 0.5}, {"reach": 0.25, "shoulder": 0.7}).held == {"turn": 0.5}
    on_post = make_question(ROBOT.with_tool("top"), {}, GOAL)
    assert on_post.held == {"shoulder": 0.7, "reach": 0.25}
    assert on_post.robot.tool == "top"
    with pytest.raises(InputError, match=r"no value of joint turn$"):
        make_question(ROBOT, {}, {"reach": 0.25, "shoulder": 0.7})


def test_an_answer_is_plain_data_and_was_graded():
    row = ask(make_question(ROBOT, {}, GOAL), CollisionModel.of(ROBOT), WORLD, Margins(0.01, {"hand": 0.0}))
    assert row["reached"]
    assert row["stop_reason"] == "reached"
    assert row["blockers"] == {}
    assert len(row["q"]) == 3
    assert min(row["new_s"], row["again_s"]) > 0.0
    q = np.array(row["q"])
    check = ikde.check(ROBOT, q, CollisionModel.of(ROBOT).in_world(WORLD))
    assert row["clearance_m"] == pytest.approx(check.clearance_m)


def test_a_target_in_an_obstacle_has_its_blocker():
    question = make_question(ROBOT, {}, GOAL)
    at = {"sphere": {"radius": 0.1}, "position": question.target.p_world_tool.tolist()}
    row = ask(question, CollisionModel.of(ROBOT), ikde.load_world({"obstacles": {"ball": at}}), Margins())
    assert (row["reached"], row["stop_reason"]) == (False, "world")
    assert list(row["blockers"]) == ["ball"]
    summary = summarise_rows("all", [row, refuse(InputError("no"))])
    assert (summary.problems, summary.reached, summary.blockers) == (2, 0, {"ball": 1})


@pytest.mark.parametrize(("reason", "proved"), [("no solution, proved: of 4", True), ("touches proved", False)])
def test_a_name_is_no_proof(reason, proved, monkeypatch):
    monkeypatch.setattr(SolveResult, "reason", reason)
    row = ask(make_question(ROBOT, {}, GOAL), CollisionModel.of(ROBOT), WORLD, Margins())
    assert row["proved"] is proved


def test_rows_that_are_known_are_not_asked_again():
    answered = ask(make_question(ROBOT, {}, GOAL), CollisionModel.of(ROBOT), WORLD, Margins())
    data = {
        "asked": {"a": 1},
        "problems": {"x": {**answered, "digest": "1"}, "y": {"reached": 1}, "z": refuse(InputError(""))},
    }
    assert list(read_known(data, {"a": 1})) == ["x"]
    assert read_known(data, {"a": 2}) == read_known([], {}) == {}
    asked, kept = [], []

    def ask_one(name):
        asked.append(name)
        return {"n": name}

    def keep(rows):
        kept.append(list(rows))

    rows = run_scenes([("x", "1"), ("y", "2")], read_known(data, {"a": 1}), ask_one, keep)
    assert (asked, kept, list(rows), rows["y"]["digest"]) == (["y"], [["x", "y"]], ["x", "y"], "2")
    run_scenes([("x", "other")], read_known(data, {"a": 1}), ask_one, keep)
    assert asked == ["y", "x"]


START = {"waist": 0.1, "left_shoulder": 0.3, "left_elbow": 7.0, "right_shoulder": -0.5, "right_elbow": 0.2, "lid": 1.0}
LEFT = {"left_elbow": -1.0, "waist": 0.2, "left_shoulder": 0.9}
RIGHT = {"right_elbow": 1.0, "right_shoulder": -0.9, "lid": 0.5}


@pytest.fixture(scope="module")
def dual(tmp_path_factory):
    return ikde.import_urdf(write(tmp_path_factory.mktemp("dual"), DUAL), tool=TOOLS)


def test_the_arm_that_the_goal_moves_is_asked_and_the_other_one_held_at_the_requests_values(dual):
    left = make_question(dual, START, LEFT, has_tool=False)
    assert (left.robot.tool, left.held) == ("left_hand", {"right_shoulder": -0.5, "right_elbow": 0.2})
    right = make_question(dual, START, RIGHT, has_tool=False)
    assert right.robot.tool == "right_hand"
    assert right.held == {"waist": 0.1, "left_shoulder": 0.3, "left_elbow": 7.0}
    q = [0.1, 0.3, 7.0, -0.9, 1.0]
    T = ikde.forward(dual.whole, q)["right_hand"]
    np.testing.assert_array_equal(right.target.p_world_tool, T[:3, 3])
    both = make_question(dual.with_tool("right"), START, {**LEFT, **RIGHT}, has_tool=False)
    assert (both.robot.tool, both.held) == ("right_hand", {"left_shoulder": 0.9, "left_elbow": -1.0})
    more = {**LEFT, "right_elbow": 1.0}
    assert choose_tool(dual.with_tool("right"), more).tool == "left_hand"


def test_a_goal_that_moves_another_arm_than_the_tool_and_a_held_value_outside_limits_are_refused(dual):
    with pytest.raises(InputError, match=r"^goal_constraints: names no joint that moves left_hand$"):
        make_question(dual, START, RIGHT)
    with pytest.raises(InputError, match=r"^goal_constraints: names no joint that moves left_hand$"):
        make_question(dual, START, {"lid": 1.0}, has_tool=False)
    with pytest.raises(InputError, match=r"^start_state: right_shoulder is held at 2.5, outside its limits, -2 to 2$"):
        make_question(dual, {**START, "right_shoulder": 2.5}, LEFT)


def test_the_pose_of_a_link_is_asked_as_it_is(dual):
    pose = LinkPose(link="right_hand", frame="world", p_frame_link=np.array([0.3, -0.4, 0.4]), R_frame_link=None)
    start = {name: value for name, value in START.items() if not name.startswith("right")}
    question = make_pose_question(dual, start, pose)
    assert (question.robot.tool, question.target.kind) == ("right_hand", "position")
    assert question.held == {"left_shoulder": 0.3, "left_elbow": 7.0}
    with pytest.raises(InputError, match=r"^goal_constraints: no frame that stays in its place is called 'left_hand'"):
        make_pose_question(dual, START, replace(pose, frame="left_hand"))


def test_the_arm_that_is_held_stands_in_the_way(dual):
    own, nothing = CollisionModel.of(dual), ikde.load_world({"obstacles": {}})
    free = ask(make_question(dual, START, RIGHT, has_tool=False), own, WORLD, Margins())
    assert (free["reached"], free["tool"], len(free["q"])) == (True, "right_hand", 5)
    assert free["q"][:3] == [0.1, 0.3, 7.0]
    across = {**START, "waist": 0.0, "left_shoulder": -1.4, "left_elbow": 0.0}
    question = make_question(dual, across, {"right_shoulder": 0.3, "right_elbow": 0.0}, has_tool=False)
    row = ask(question, own, nothing, Margins())
    assert (row["reached"], row["stop_reason"]) == (False, "collision")
    assert all("left" in name and "right" in name for name in row["blockers"])
