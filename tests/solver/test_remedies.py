"""Every remedy among obstacles is true: what it says is done, and then the target is reached."""

import re
from dataclasses import replace

import numpy as np
import pytest

import ikde
from ikde.kernels.arrays import COLLIDING
from ikde.model.collision_model import CollisionModel
from ikde.solver import explain
from ikde.solver import remedies as module
from ikde.solver.engine_table import NAMES
from ikde.solver.hints import Probe
from ikde.solver.remedies import Tries
from tests.problems import problem_of
from tests.random_robots import with_ranges
from tests.three_joints import ROBOT, meet

Q = np.array([0.4, 0.7, 0.25])
NEAR = re.compile(r"with ([0-9.]+) mm less margin")


@pytest.fixture(scope="module")
def ur5():
    """The shipped robot."""
    return ikde.load_robot("ur5")


def world_of(**obstacles):
    return ikde.load_world({"obstacles": obstacles})


def ball(p, radius=0.05, **more):
    return {"sphere": {"radius": radius}, "position": list(map(float, p)), **more}


def solve(robot, target, world, margin_m=0.0, **margins_m):
    model = CollisionModel.of(robot).in_world(world, margin_m, margins_m)
    return ikde.solve(robot, target, {"restarts": 20}, collision=model)


@pytest.mark.parametrize("gap_m", [0.013, 0.02])
def test_the_largest_margin_that_is_left_is_found(gap_m):
    target = meet(ROBOT, Q, "pose")
    beside = target.p_world_tool + (0.05 + 0.05 + gap_m) * np.array([0.0, 0.0, 1.0])
    world = world_of(ball=ball(beside))
    blocked = solve(ROBOT, target, world, 0.05)
    assert blocked.stop_reason == "world"
    assert blocked.hint.startswith("without ball: a solution was found that touches nothing else; with ")
    less_m = 1e-3 * float(NEAR.search(blocked.hint)[1])
    assert solve(ROBOT, target, world, 0.05 - less_m).reached
    assert less_m == pytest.approx(0.05 - gap_m, abs=2e-3)


def test_margins_of_obstacles_are_lowered_where_the_caller_has_none():
    target = meet(ROBOT, Q, "pose")
    beside = target.p_world_tool + 0.11 * np.array([0.0, 0.0, 1.0])
    blocked = solve(ROBOT, target, world_of(ball=ball(beside, margin=0.03)))
    less_m = 1e-3 * float(NEAR.search(blocked.hint)[1])
    assert solve(ROBOT, target, world_of(ball=ball(beside, margin=0.03 - less_m))).reached


def test_an_arm_with_a_closed_form_needs_no_search(ur5, monkeypatch):
    q = np.array([0.3, -1.2, 1.4, -1.0, -1.5, 0.2])
    T = ikde.forward(ur5, q)[ur5.tool]
    target = ikde.Target(T[:3, 3], R_world_tool=T[:3, :3])
    world = world_of(ball=ball(T[:3, 3] + 0.12 * T[:3, 2]), far=ball((5, 5, 5)))
    blocked = solve(ur5, target, world, 0.1)
    assert "proved" in blocked.reason
    monkeypatch.setattr(Tries, "find", None)
    hint = blocked.hint
    assert hint.startswith("without ball: ")
    less_m = 1e-3 * float(NEAR.search(hint)[1])
    assert solve(ur5, target, world, 0.1 - less_m).reached
    assert not solve(ur5, target, world, 0.1 - less_m + 2e-4).reached  # all configurations are known: it is the least


def test_a_base_may_leave_its_range(qiao):
    narrow = with_ranges(qiao, {"d_x": (-0.4, 0.4), "d_y": (-0.4, 0.4)})
    world, target = world_of(wall={"box": [0.1, 3, 3], "position": [0.95, 0, 1.5]}), ikde.Target((1.35, 0.0, 0.9))
    blocked = solve(narrow, target, world)
    assert blocked.stop_reason == "world"
    found = re.search(r"if the base may leave its range: a solution was found at d_x=(\S+) m, d_y=(\S+)", blocked.hint)
    assert max(abs(float(value.removesuffix(";"))) for value in found.groups() if value != "m") > 0.4
    wide = with_ranges(qiao, {"d_x": (-1.6, 1.6), "d_y": (-1.6, 1.6)})
    assert solve(wide, target, world).reached


def test_searches_stop_when_they_have_cost_enough_and_that_is_said(monkeypatch):
    monkeypatch.setattr(module, "MAX_COST", 1)
    target = meet(ROBOT, Q, "position")
    blocked = solve(ROBOT, target, world_of(ball=ball(target.p_world_tool)), 0.01)
    assert blocked.hint.endswith(f"; {module.STOPPED}")
    assert "without ball" in blocked.hint
    assert "margin" not in blocked.hint


def test_where_no_obstacle_blocks_nothing_is_tried(monkeypatch):
    monkeypatch.setattr(Tries, "find", None)
    model = CollisionModel.of(ROBOT).in_world(world_of(ball=ball((5, 5, 5))), 0.01)
    problem = replace(problem_of(ROBOT), collision=model)
    probe = Probe(meet(ROBOT, Q, "position"), 0, 0, 0.0)
    assert module.try_in_world(problem, probe, {("post", "hand"): 3}) is None


def test_of_a_pose_whose_configurations_all_collide_with_themselves_nothing_is_said_to_help(ur5):
    q = np.array([0.8, -1.4, -2.8, -2.9, 1.9, 2.5])  # as do the seven others of this pose
    target = meet(ur5, q, "pose")
    blocked = solve(ur5, target, world_of(ball=ball(target.p_world_tool)), 0.01)
    assert (blocked.stop_reason, blocked.hint) == ("world", None)
    assert "of 8 configurations with this pose 8 in collision" in blocked.reason


def test_what_blocks_is_counted_on_solutions_of_lm_where_that_meets_the_target():
    """64 populations of `memetic` would take a second."""
    target = meet(ROBOT, Q, "position")
    model = CollisionModel.of(ROBOT).in_world(world_of(ball=ball(target.p_world_tool)))
    problem = replace(problem_of(ROBOT), collision=model)
    assert len(problem.settings.engines) > 1
    found = explain._search_often(problem, Probe(target, 0, 0, 0.0))
    assert {NAMES[engine] for engine in found.engine} == {"lm"}
    assert found.counts[:, COLLIDING].all()


def test_what_is_held_may_touch_what_it_touches():
    target = meet(ROBOT, Q, "pose")
    ahead = ikde.forward(ROBOT, Q)["tip"] @ (0.0, 0.0, 0.19, 1.0)
    T, world = np.eye(4), world_of(cup=ball((9, 0, 0)), block=ball(ahead[:3], 0.04))
    T[2, 3] = 0.12
    world = world.attach("cup", "tip", T_frame_object=T, spheres=[[0.0, 0.0, 0.0, 0.05]])
    blocked = solve(ROBOT, target, world)
    assert blocked.stop_reason == "world"
    assert blocked.hint.endswith("; if cup may touch block: a solution was found")
    thing = replace(world.attached[0], may_touch=("block",))
    assert solve(ROBOT, target, replace(world, attached=(thing,))).reached


def test_of_an_arm_with_a_closed_form_what_is_held_may_touch_the_robot(ur5, monkeypatch):
    monkeypatch.setattr(Tries, "find", None)
    target = meet(ur5, np.array([0.527, -1.176, -0.661, -0.81, 1.301, 0.32]), "pose")
    spheres, T = [[0.024, 0.242, -0.091, 0.08]], np.eye(4)
    held = world_of(cup=ball((9, 0, 0))).attach("cup", "tool", T_frame_object=T, spheres=spheres)
    blocked = solve(ur5, target, held)
    assert blocked.reason.endswith("2 in collision (forearm-cup in 2)")
    assert blocked.hint == "if cup may touch forearm: a solution was found"
    thing = replace(held.attached[0], may_touch=("forearm",))
    assert solve(ur5, target, replace(held, attached=(thing,))).reached


def test_pairs_that_what_is_held_was_in():
    world = world_of(cup=ball((9, 0, 0)), jar=ball((9, 1, 0)), block=ball((9, 2, 0)), top=ball((9, 3, 0)))
    world = world.attach("cup", "tip", T_frame_object=np.eye(4), may_touch=("top",))
    model = CollisionModel.of(ROBOT).in_world(world.attach("jar", "sleeve", T_frame_object=np.eye(4)))
    blocking = [(ROBOT.name, "block"), ("floor", "cup"), ("floor", "hand"), (ROBOT.name, "top"), ("cup", "jar")]
    assert module.list_touches(model, blocking) == [
        ("cup", "block"),
        ("jar", "block"),
        ("cup", "floor"),
        ("jar", "top"),
        ("cup", "jar"),
    ]
    assert ("floor", "cup") in model.pairs
    changed = module.let_touch(model, "cup", "floor")
    assert ("floor", "cup") not in changed.pairs
    assert changed.world.attached[1] == model.world.attached[1]
