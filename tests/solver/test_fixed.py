"""Where no joint may move the one configuration is the answer, graded, with what is off or collides."""

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

import ikde
from ikde.model.rotation import rotation_about
from ikde.solver.engines.pool import runs_on_tables
from ikde.solver.fixed import tell_fixed
from ikde.solver.quick import Quick, find_quick
from ikde.solver.search import make_engine, search
from ikde.solver.settings import BulkOptions
from ikde.solver.verify import verify
from tests.conftest import random_q
from tests.problems import problem_of
from tests.random_robots import random_robot
from tests.substitutes import never
from tests.targets import free_q, targets_near

METHODS = ("auto", "lm", "memetic", "de")


@pytest.fixture(autouse=True)
def no_engines(substitute):
    """None is made, whatever is asked."""
    substitute(make_engine, never)


def hold(robot, q):
    """The `freeze` that holds every joint."""
    return dict(zip(robot.joint_names, q.tolist(), strict=True))


def colliding_q(robot, rng):
    """Joint values [N] that collide."""
    return next(q for q in random_q(robot, rng, 500) if ikde.check(robot, q).collision)


def tool_of(robot, q):
    return ikde.forward(robot, q)[robot.tool]


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("near", [False, True])
def test_what_is_met_where_the_joints_are_is_reached(any_robot, rng, method, near):
    q = free_q(any_robot, rng)
    T = tool_of(any_robot, q)
    asked = {"freeze": any_robot.joint_names, "near": q} if near else {"freeze": hold(any_robot, q)}
    for target in (ikde.Target(T[:3, 3], T[:3, :3]), ikde.Target(T[:3, 3], axis_world_tool=T[:3, 2])):
        result = ikde.solve(any_robot, target, method=method, **asked)
        assert (result.reached, result.verified, bool(result.collision)) == (True, True, False)
        assert result.q.tolist() == q.tolist()
        assert (result.method, result.attempts, result.evaluations, result.rejected) == ("none", 1, 1, 0)
        assert (result.stop_reason, result.hint) == ("reached", None)


@pytest.mark.parametrize("method", METHODS)
def test_what_is_not_met_is_told_by_how_much(qiao, substitute, rng, method):
    substitute(search, once(search))
    q = free_q(qiao, rng)
    T = tool_of(qiao, q)
    target = ikde.Target(T[:3, 3] + np.array([0.0, 0.3, 0.4]), T[:3, :3] @ rotation_about(np.array([0, 0, 1.0]), 0.25))
    result = ikde.solve(qiao, target, method=method, freeze=hold(qiao, q))
    assert (result.reached, result.stop_reason, result.collision) == (False, "out_of_reach", False)
    assert result.reason == "no joint may move: the tool stays 0.5 m and 0.25 rad off"
    assert (result.position_error_m, result.orientation_error_rad) == pytest.approx((0.5, 0.25))
    assert (result.attempts, result.evaluations, result.rejected, result.blocking_pairs) == (1, 1, 0, {})
    assert result.hint.startswith("free ")
    assert result.hint.endswith(": then the bound no longer excludes the target")


def once(function):
    """The search itself, and no probe after it."""
    calls = []

    def call(*arguments, **options):
        calls.append(1)
        assert len(calls) == 1, "searched again for a reason"
        return function(*arguments, **options)

    return call


@pytest.mark.parametrize("off_m", [0.0, 0.1])
def test_what_collides_is_named(qiao, rng, substitute, off_m):
    substitute(search, once(search))
    q = colliding_q(qiao, rng)
    target = ikde.Target(tool_of(qiao, q)[:3, 3] + np.array([off_m, 0.0, 0.0]))
    result = ikde.solve(qiao, target, freeze=hold(qiao, q))
    pairs = set(verify(qiao, target, q).colliding_pairs)
    assert (result.reached, result.collision) == (False, True)
    collide = f"{' and '.join(result.closest_pair)} collide"
    assert result.closest_pair in pairs
    if off_m:
        assert (result.stop_reason, result.rejected, result.blocking_pairs) == ("out_of_reach", 0, {})
        assert result.reason.endswith(f" m off, and {collide}")
    else:
        assert (result.stop_reason, result.rejected) == ("collision", 1)
        assert result.blocking_pairs == dict.fromkeys(pairs, 1)
        assert result.reason == f"no joint may move: the target is met, but {collide}"


def test_without_a_detector_collision_is_not_checked(qiao, rng):
    q = colliding_q(qiao, rng)
    target = ikde.Target(tool_of(qiao, q)[:3, 3])
    result = ikde.solve(qiao, target, freeze=hold(qiao, q), collision="none")
    assert (result.reached, result.collision, result.rejected) == (True, None, 0)


@pytest.mark.parametrize("explain", [True, False])
def test_many_are_told_what_each_is_told_alone(qiao, rng, explain):
    q = free_q(qiao, rng)
    T = tool_of(qiao, q)
    turned = ikde.Target(T[:3, 3], T[:3, :3] @ rotation_about(np.array([1.0, 0, 0]), 1.0))
    targets = [ikde.Target(T[:3, 3]), turned, ikde.Target((9.0, 9.0, 9.0))]
    rows = ikde.solve_many(qiao, targets, freeze=hold(qiao, q), bulk=BulkOptions(explain=explain))
    alone = [ikde.solve(qiao, target, freeze=hold(qiao, q), stream=k) for k, target in enumerate(targets)]
    for row, one in zip(rows, alone, strict=True):
        for name in ("reached", "stop_reason", "reason", "method", "attempts", "evaluations", "position_error_m"):
            assert getattr(row, name) == getattr(one, name)
        assert row.hint == (one.hint if explain else None)
    assert rows.reached.tolist() == [True, False, False]


def test_a_colliding_row_that_was_not_diagnosed_names_its_pair_whatever_the_time(qiao, rng):
    q = colliding_q(qiao, rng)
    timed = ikde.SolveSettings(timeout_s=1e-9)
    asked = {"freeze": hold(qiao, q), "bulk": BulkOptions(explain=False, verify="none")}
    row = ikde.solve_many(qiao, [ikde.Target(tool_of(qiao, q)[:3, 3])], timed, **asked)[0]
    assert row.stop_reason == "collision"
    assert row.reason == f"no joint may move: the target is met, but {' and '.join(row.closest_pair)} collide"


def test_a_robot_whose_ranges_are_points_has_one_answer(qiao):
    joints = [replace(joint, lower=joint.home, upper=joint.home) for joint in qiao.joints]
    robot = replace(qiao, joints=tuple(joints))
    here = ikde.Target(tool_of(qiao, qiao.home)[:3, 3])
    result = ikde.solve(robot, here)
    assert (result.reached, result.method) == (True, "none")
    other = ikde.solve(robot, ikde.Target((0.8, 0.5, 1.0)))
    assert other.stop_reason == "out_of_reach"
    assert other.hint.startswith("a larger range for ")
    named = other.hint.removeprefix("a larger range for ").split(":")[0].replace(", or a larger range for ", " and ")
    wide = {joint.name: joint for joint in qiao.joints if joint.name in named.split(" and ")}
    freed = replace(robot, joints=tuple(wide.get(joint.name, joint) for joint in robot.joints))
    problem = problem_of(freed)
    assert not problem.is_fixed
    assert len(ikde.solve_distinct(robot, here, 3)) == 1


def test_machine_code_and_python_see_the_same_bits(qiao, rng, monkeypatch):
    q = colliding_q(qiao, rng)
    targets = targets_near(qiao, np.array([q, free_q(qiao, rng), free_q(qiao, rng)]), rng)
    asked = {"freeze": hold(qiao, q), "bulk": BulkOptions(explain=False, verify="none")}
    plain = ikde.solve_many(qiao, targets, **asked)
    monkeypatch.setattr("ikde.solver.fixed.MAX_PLAIN", 0)
    compiled = ikde.solve_many(qiao, targets, **asked)
    for name in (
        "q",
        "position_error_m",
        "orientation_error_rad",
        "clearance_m",
        "closest_pair",
        "reached",
        "attempts",
    ):
        assert getattr(plain, name).tobytes() == getattr(compiled, name).tobytes(), name
        assert getattr(plain, name).dtype == getattr(compiled, name).dtype
    assert [row.reason for row in plain] == [row.reason for row in compiled]


def test_no_compiler_is_needed():
    code = """
import sys
import ikde
robot = ikde.load_robot("ur5")
asked = {"freeze": robot.joint_names}
ikde.solve(robot, ikde.Target((0.8, 0.5, 1.0)), **asked)
ikde.solve_many(robot, [ikde.Target((0.8, 0.5, 1.0))] * 3, **asked)
sys.exit("numba" in sys.modules)
"""
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_the_quick_way_is_not_prepared_for_it(qiao, substitute):
    """Which would draw a pool of seeds and compile an engine."""
    robot = replace(qiao, joints=tuple(replace(joint, lower=joint.home, upper=joint.home) for joint in qiao.joints))
    substitute(runs_on_tables, lambda: False)
    substitute(Quick, lambda *arguments: never())
    assert find_quick(robot, None, "auto", None, "position") is None


@pytest.mark.parametrize("method", METHODS)
def test_there_is_one_distinct_solution(qiao, method):
    target = ikde.Target(tool_of(qiao, qiao.home)[:3, 3])
    solutions = ikde.solve_distinct(qiao, target, 5, method=method, freeze=qiao.joint_names)
    assert [solution.reached for solution in solutions] == [True]


def test_what_is_met_is_met_by_random_robots():
    for seed in range(30):
        robot, rng = random_robot(seed), np.random.default_rng(seed)
        q = rng.uniform(robot.lower, robot.upper)
        T = tool_of(robot, q)
        result = ikde.solve(robot, ikde.Target(T[:3, 3], T[:3, :3]), freeze=hold(robot, q))
        assert result.reached is not result.collision
        assert result.stop_reason == ("collision" if result.collision else "reached")


def test_a_line_says_what_is_off():
    assert tell_fixed(0.51239, 0.0, None) == "no joint may move: the tool stays 0.512 m off"
    assert tell_fixed(0.0, 0.3339, ("a", "b")) == "no joint may move: the tool stays 0.334 rad off, and a and b collide"
    assert tell_fixed(2.0, 1.0, None) == "no joint may move: the tool stays 2 m and 1 rad off"
    assert tell_fixed(0.0, 0.0, ("a", "b")) == "no joint may move: the target is met, but a and b collide"
