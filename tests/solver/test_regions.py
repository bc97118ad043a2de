"""Regions solved: answers lie inside by the grader, a no has its reason, and the same seed gives the same bits."""

from dataclasses import replace

import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from ikde.model.region import Region
from ikde.solver import region_grade, regions
from ikde.solver.region_grade import RegionGrade, grade_region
from ikde.solver.regions import RegionQuestion, solve_region
from ikde.solver.result import StopReason
from tests.problems import TARGET, problem_of


@pytest.fixture(scope="module")
def ur5():
    return ikde.load_robot("ur5")


@pytest.fixture(scope="module")
def goal(ur5):
    return ikde.Target.from_matrix(ikde.forward(ur5, ur5.home + 0.3)["tool"])


def ball(goal, offset, radius):
    place = (goal.p_world_tool + np.array(offset)).tolist()
    return ikde.load_world({"obstacles": {"ball": {"sphere": {"radius": radius}, "position": place}}})


def is_inside(region, result, robot):
    tool = ikde.forward(robot, result.q)["tool"]
    return grade_region(region, tool, ikde.SolveSettings()).is_inside


def list_regions(goal):
    point = goal.p_world_tool + 0.2 * goal.axis_world_tool
    yield Region.box(goal, 0.05, [(0, 0), (0, 0), (-1, 2)])
    yield Region.box(goal.p_world_tool, (0.05, 0.0, 0.01))
    yield Region.turn(goal)
    yield Region.turn(goal, (1, 0, 0), position_m=0.01)
    yield Region.cone(goal, 0.3, 0.05)
    yield Region.look_at(point, (0.1, 0.4))


def test_answers_lie_inside_and_are_verified(ur5, goal):
    for region in list_regions(goal):
        result = ikde.solve(ur5, region)
        assert result.reached
        assert result.verified
        assert is_inside(region, result, ur5)
        assert (result.region, result.alternative, result.poses) == (region, 0, 1)
        assert ikde.verify(ur5, region, result.q).accepted


def test_where_the_centre_is_blocked_another_pose_is_found(ur5, goal):
    world = ball(goal, (0.03, 0, 0), 0.05)
    region = Region.box(goal, 0.15)
    assert not ikde.solve(ur5, goal, collision=world).reached
    result = ikde.solve(ur5, region, collision=world)
    assert result.reached
    assert result.poses > 1
    assert not np.array_equal(result.target.T_world_tool, goal.T_world_tool)
    again = ikde.solve(ur5, region, collision=world)
    assert again.q.tobytes() == result.q.tobytes()
    assert ikde.solve(ur5, region, collision=world, seed=1).q.tobytes() != result.q.tobytes()


def test_an_answer_that_the_grader_of_regions_refuses_is_none(ur5, goal, monkeypatch):
    region = Region.box(goal, 0.05)
    monkeypatch.setattr(region_grade, "grade_region", lambda *_: RegionGrade(0, 0.1, 0.0, False))
    result = ikde.solve(ur5, region, {"restarts": 3})
    assert not result.reached
    assert result.poses == 3


def test_a_region_out_of_reach_is_proved_and_says_by_how_much(ur5):
    result = ikde.solve(ur5, Region.box((3.0, 0.0, 0.0), 0.5))
    assert result.stop_reason is StopReason.OUT_OF_REACH
    assert result.reason.startswith("out of reach: every pose of the region is at least 1.2")
    assert result.poses == 1
    assert result.hint is None


def test_a_region_inside_an_obstacle_is_proved(ur5, goal):
    result = ikde.solve(ur5, Region.box(goal, 0.01), collision=ball(goal, (0, 0, 0), 0.08))
    assert result.stop_reason is StopReason.WORLD
    assert result.reason.startswith("no solution, proved: whatever the joints do, every pose of the region puts")
    assert dict(result.blocking_pairs) == {("ur5", "ball"): 1}


def test_a_no_counts_what_was_tried_and_what_was_in_the_way(ur5, goal):
    region = Region.box(goal, (0.3, 0.0, 0.0))
    result = ikde.solve(ur5, region, {"restarts": 1}, collision=ball(goal, (0, 0, 0), 0.2))
    assert result.stop_reason is StopReason.WORLD
    assert result.reason.startswith("1 pose of the region tried: 1 met only in collision; ")
    assert "blocked by ball (" in result.reason
    assert result.hint == "more restarts: so many poses of the region are tried"
    assert result.poses == 1
    assert result.verified


def test_the_first_alternative_that_is_reached_is_named(ur5, goal):
    far, other = (3.0, 0.0, 0.0), Region.cone(goal, 0.2)
    result = ikde.solve(ur5, Region.any_of([far, other, goal]))
    assert (result.reached, result.alternative) == (True, 1)
    assert ikde.solve(ur5, Region.any_of([far, (0, 0, 9)])).stop_reason is StopReason.OUT_OF_REACH


def test_alternatives_that_are_proved_out_of_reach_are_not_tried_again(ur5, goal):
    region = Region.any_of([Region.box((3.0, 0.0, 0.0), 0.1), Region.box(goal, (0.3, 0.0, 0.0))])
    result = ikde.solve(ur5, region, {"restarts": 4}, collision=ball(goal, (0, 0, 0), 0.2))
    assert not result.reached
    assert result.poses == 1 + 4


def test_many_alternatives_have_a_budget_together():
    auto, slow = ikde.SolveSettings(), ikde.SolveSettings(method="memetic")
    counts = [regions._find_budget(auto, count) for count in (1, 4, 10, 100)]
    assert counts == [1024, 4096, 4096, 12800]
    assert regions._find_budget(slow, 2) == 40
    assert regions._find_budget(auto.with_changes(restarts=7), 3) == 21


def test_the_best_alternative_moves_the_least(ur5, goal):
    near = ur5.home + 0.31
    goals = [ikde.forward(ur5, ur5.home + step)["tool"] for step in (1.0, 0.3, -0.5)]
    result = ikde.solve(ur5, Region.any_of(goals, "best"), near=near)
    assert result.alternative == 1
    assert result.motion <= min(ikde.solve(ur5, each, near=near).motion for each in goals)


def test_near_inside_the_region_is_the_answer(ur5, goal):
    near = ur5.home + 0.3
    near[5] += 0.4
    result = ikde.solve(ur5, Region.turn(goal), near=near)
    assert result.q.tobytes() == near.tobytes()
    assert result.motion == 0.0


def test_near_outside_the_region_the_nearest_pose_is_tried_first(ur5, goal):
    near = ur5.home + 0.4
    region = Region.box(goal, 0.05, 0.1)
    first, centre = ikde.solve(ur5, region, near=near), ikde.solve(ur5, goal, near=near)
    assert first.reached
    assert first.poses == 1
    assert first.motion < 0.9 * centre.motion


def test_a_robot_that_may_not_move_is_inside_or_not(ur5, goal):
    there = dict(zip(ur5.joint_names, (ur5.home + 0.3).tolist(), strict=True))
    assert ikde.solve(ur5, Region.box(goal, 0.01), freeze=there).reached
    result = ikde.solve(ur5, Region.box(goal, 0.01), freeze=ur5.joint_names)
    assert result.stop_reason is StopReason.OUT_OF_REACH
    assert result.reason.startswith("no joint may move, and the tool is 0.317 m and 0.945 rad out")


def test_a_timeout_ends_it(ur5, goal):
    settings = {"timeout_s": 1e-9}
    result = ikde.solve(ur5, Region.box(goal, 0.05), settings)
    assert result.stop_reason is StopReason.TIMED_OUT
    assert result.reason.startswith("timed out after 1e-09 s, with ")


def test_rows_are_what_single_calls_give(ur5, goal):
    goals = [goal, Region.box(goal, 0.05), Region.cone(goal, 0.2), Region.box((3.0, 0.0, 0.0), 0.5)]
    rows = ikde.solve_many(ur5, goals)
    singles = [ikde.solve(ur5, each, stream=k) for k, each in enumerate(goals)]
    assert rows.reached.tolist() == [True, True, True, False]
    assert rows.alternatives.tolist() == [-1, 0, 0, 0]
    assert [row.q.tobytes() for row in rows] == [single.q.tobytes() for single in singles]
    assert [row.reason for row in rows] == [single.reason for single in singles]
    assert rows.verified.all()
    part = rows[[3, 1]]
    assert part.reached.tolist() == [False, True]
    assert part[1].region == goals[1]
    table = part.to_arrow().to_pydict()
    assert (table["reached"], table["alternative"], table["poses"]) == ([False, True], [0, 0], [1, 1])
    assert rows.to_arrow()["alternative"].to_pylist()[0] is None
    assert "alternative" not in ikde.solve_many(ur5, [goal]).to_arrow().column_names


def test_distinct_solutions_of_a_region(ur5, goal):
    region = Region.box(goal, 0.1)
    found = ikde.solve_distinct(ur5, region, 3, rank="motion")
    assert len(found) == 3
    assert [result.motion for result in found] == sorted(result.motion for result in found)
    assert all(is_inside(region, result, ur5) for result in found)
    assert not ikde.solve_distinct(ur5, Region.box((3.0, 0.0, 0.0), 0.5), 3)[0].reached


def test_what_does_not_fit_is_refused(ur5, goal):
    region = Region.box(goal, 0.1)
    with pytest.raises(InputError, match="near"):
        ikde.solve(ur5, region, near=[0.0])
    with pytest.raises(InputError, match="seed"):
        ikde.solve(ur5, region, seed=-1)


def test_a_problem_of_its_own_is_asked_as_it_is(ur5, goal):
    asked = replace(problem_of(ur5), descends=False)
    assert solve_region(RegionQuestion(asked, Region.box(goal, 0.1), 0, 0)).reached


ELL = ikde.BaseRegion([(0, -1), (1.2, -1), (1.2, 0.2), (0.3, 0.2), (0.3, 1.5), (0, 1.5)])
ROUND = ikde.BaseRegion([(-1, -1), (2, -1), (2, 2), (-1, 2)], [[(0, 0), (1.5, 0), (1.5, 1.5), (0, 1.5)]])


@pytest.mark.parametrize("base", [ELL, ROUND], ids=repr)
def test_the_base_stands_in_its_region(qiao, base):
    goals = [Region.of(TARGET).with_base(base), Region.box(TARGET, 0.2).with_base(base)]
    rows = ikde.solve_many(qiao, goals * 5)
    assert rows.reached.all()
    assert base.contains(rows.q[:, :2]).all()
    assert rows[0].target == TARGET
    assert ikde.solve(qiao, goals[0]).q.tobytes() == rows[0].q.tobytes()
    assert all(base.contains(each.q[None, :2]).all() for each in ikde.solve_distinct(qiao, goals[0], 3))


def test_motions_begin_at_near_also_where_the_base_may_not_stand(qiao):
    near = qiao.home + np.array([-2.0, 1.0, 0, 0, 0, 0, 0, 0, 0])
    region = Region.of(TARGET).with_base(ELL)
    rows = ikde.solve_many(qiao, [region], near=near)
    weights = rows.problem.weights
    assert rows[0].reached
    assert rows[0].near.tolist() == near.tolist()
    assert rows[0].motion == pytest.approx(np.sqrt(np.sum((weights * (rows.q[0] - near)) ** 2)), rel=1e-12)
    assert rows[0].motion == pytest.approx(rows.motion[0], rel=1e-12)


def test_a_place_that_the_grader_refuses_is_none(qiao, monkeypatch):
    monkeypatch.setattr(region_grade, "measure_base", lambda *_: 1.0)
    result = ikde.solve(qiao, Region.of(TARGET).with_base(ELL), {"restarts": 4})
    assert not result.reached
    assert result.reason.startswith("4 places of the base tried: 4 ")
    assert not ikde.verify(qiao, Region.of(TARGET).with_base([(9, 9), (9, 8), (8, 8)]), result.q).accepted


def test_from_a_base_region_that_is_too_far_nothing_is_in_reach(qiao):
    result = ikde.solve(qiao, Region.of(TARGET).with_base([(5, 5), (6, 5), (6, 6)]))
    assert result.stop_reason is StopReason.OUT_OF_REACH
    assert result.reason == "out of reach: the target is at least 4.317 m too far, whatever the joints do"


def test_a_base_region_is_for_a_base(ur5, goal):
    with pytest.raises(InputError, match="base: ur5 has no planar base"):
        ikde.solve(ur5, Region.of(goal).with_base(ELL))


def test_the_best_of_what_is_not_reached_is_kept_by_its_score_without_written_kernels(monkeypatch):
    seen, search = [], regions._search
    monkeypatch.setenv("IKDE_KERNELS", "tables")
    monkeypatch.setattr(regions, "_search", lambda *asked: seen.append(search(*asked)[0]) or (seen[-1], "lm", False))
    region = Region.box(np.array([[1, 0, 0, 0.4], [0, 1, 0, 0.2], [0, 0, 1, 0.3], [0, 0, 0, 1.0]]), 0.01)
    ikde.solve("ur5", region, {"restarts": 2}, method="lm")
    scores = [row[6 + regions.METRICS + regions.SCORE : 6 + regions.METRICS + regions.BLOCKED] for row in seen]
    assert seen
    assert all(first in (0.0, 1.0) and np.isfinite(cost) for first, cost in scores)
