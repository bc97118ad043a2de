"""Planning problems as questions: what is asked, what is held, and rows that are kept."""

import numpy as np
import pytest

import ikde
from ikde.batch.scenes import Margins, ask, make_question, read_known, refuse, run_scenes, summarise_rows
from ikde.errors import InputError
from ikde.model.collision_model import CollisionModel
from ikde.solver.result import SolveResult
from tests.three_joints import ROBOT

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
