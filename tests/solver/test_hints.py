"""Every hint is true: what it says is done, and then the bound is open, or the target is reached."""

import re
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

import ikde
from ikde.model.bounds import find_bounds
from ikde.solver.engines import pool
from ikde.solver.hints import Probe, hint_at_tolerance, meets, try_longer, try_widening
from ikde.solver.verify import verify
from tests.endless_robot import ENDLESS
from tests.flat_settings import flat_settings
from tests.problems import problem_of
from tests.random_robots import make_frame, make_robot, random_robot, with_ranges
from tests.robot_files import load_text
from tests.scara import make_scara
from tests.targets import make_target

OPEN = ": then the bound no longer excludes the target"
LM = ikde.SolveSettings(method="lm", restarts=20)
TARGET = ikde.Target((0.8, 0.5, 1.0))


def hint(robot, target, freeze=None, settings=LM):
    result = ikde.solve(robot, target, settings, freeze=freeze, collision="none")
    assert result.stop_reason == "out_of_reach"
    return result.hint


@pytest.fixture
def few_seeds(monkeypatch):
    """Pools of few configurations, a second less each: what is told does not depend on where searches start."""
    monkeypatch.setattr(pool, "DRAWN", pool.DRAWN_NARROW)


# ---- what bounds prove


@pytest.mark.parametrize(
    ("position", "named", "ranges"),
    [
        ((7.0, 0.0, 0.6), "d_x", {"d_x": (-5.0, 7.0)}),
        ((0.3, -9.0, 0.6), "d_y", {"d_y": (-9.0, 5.0)}),
        ((2000.0, 0.0, 0.6), "d_x", {"d_x": (-5.0, 2000.0)}),
        ((-99999.0, 0.0, 0.6), "d_x", {"d_x": (-1e5, 5.0)}),
        ((40.0, 700.0, 0.6), "d_x and d_y", {"d_x": (-5.0, 50.0), "d_y": (-5.0, 700.0)}),
    ],
)
def test_the_slides_that_are_named_bring_the_target_into_reach(qiao, position, named, ranges):
    assert hint(qiao, ikde.Target(position)) == f"a larger range for {named}{OPEN}"
    assert ikde.solve(with_ranges(qiao, ranges), ikde.Target(position)).reached


def test_either_of_two_slides_along_one_direction_is_named():
    robot = make_robot(
        {"rail": "prismatic", "sledge": "prismatic", "lift": "prismatic", "turn": "revolute"},
        [
            make_frame("a", "world", joint="rail", axis=(1, 0, 0)),
            make_frame("b", "a", joint="sledge", axis=(1, 0, 0)),
            make_frame("c", "b", joint="lift", axis=(0, 0, 1)),
            make_frame("d", "c", joint="turn", axis=(0, 0, 1)),
            make_frame("tool", "d", (0.5, 0, 0)),
        ],
    )
    assert hint(robot, ikde.Target((9.0, 0.0, 0.0))) == f"a larger range for rail, or a larger range for sledge{OPEN}"
    assert hint(robot, ikde.Target((0.0, 0.0, 2e3))) == f"a larger range for lift{OPEN}"
    assert hint(robot, ikde.Target((0.0, 5.0, 0.0))).startswith("a target closer to the robot")


@pytest.mark.parametrize("far_m", [2.0, 2e3, 1e5])
def test_a_vertical_slide_is_not_said_to_reach_far_out(far_m):
    """Wherever it stands in the arm."""
    assert hint(make_scara(), ikde.Target((far_m, 0.0, 0.0))).startswith("a target closer to the robot")
    assert hint(make_scara(), ikde.Target((0.7, 0.0, -far_m))) == f"a larger range for quill{OPEN}"


def test_frozen_joints_are_named_that_are_in_the_way(qiao):
    target = ikde.Target((3.0, 0.0, 1.0))
    assert hint(qiao, target, freeze=["d_x", "d_y", "q2"]) == f"free d_x{OPEN}"
    assert ikde.solve(qiao, target, freeze=["d_y", "q2"]).reached
    both = ikde.Target((3.0, 3.0, 1.0))
    assert hint(qiao, both, freeze=["d_x", "d_y", "q2"]) == f"free d_x and d_y{OPEN}"
    assert ikde.solve(qiao, both, freeze=["q2"]).reached
    far = ikde.Target((30.0, 0.0, 1.0))
    assert hint(qiao, far, freeze=["d_x", "d_y"]) == f"free d_x and a larger range for d_x{OPEN}"
    assert hint(qiao, far, freeze=["d_y"]) == f"a larger range for d_x{OPEN}"


def test_frozen_joints_that_keep_the_tool_from_turning_are_named(qiao):
    frozen = ["q_z", "q1", "q2", "q3", "q4", "q5"]
    target = ikde.Target(ikde.forward(qiao, qiao.home)[qiao.tool][:3, 3], axis_world_tool=(0, 0, 1))
    told = hint(qiao, target, freeze=frozen)
    assert "free q4" in told
    assert "q_z" not in told


def read_ways(told):
    """Each alternative of a hint: joints to free, and slides to widen."""
    for way in told.removesuffix(OPEN).split(", or "):
        freed, _, wide = way.partition("a larger range for ")
        yield set(freed.removeprefix("free ").replace(" and ", " ").split()), set(wide.replace(" and ", " ").split())


def excludes(robot, target, frozen, wide):
    lower, upper = robot.lower, robot.upper
    for k, joint in enumerate(robot.joints):
        if joint.name in frozen:
            lower[k] = upper[k] = frozen[joint.name]
        elif joint.name in wide:
            lower[k], upper[k] = -1e5, 1e5
    far_m, off_rad = find_bounds(robot, lower, upper).excess(target)
    return far_m > LM.position_tolerance_m or off_rad > 1e-4


@pytest.mark.usefixtures("few_seeds")
def test_what_bounds_prove_holds_for_random_robots():
    """Each way that is told opens the bound, and nothing of it could be spared; if none is told there is none."""
    kinds = Counter()
    for seed in range(80):
        robot, rng = random_robot(seed), np.random.default_rng(seed)
        q = rng.uniform(robot.lower, robot.upper)
        T = ikde.forward(robot, q)[robot.tool]
        p = T[:3, 3] + rng.choice([0.0, 3.0, 300.0, 3e4]) * rng.normal(size=3)
        axis = T[:3, 2] + rng.choice([0.0, 0.5]) * rng.normal(size=3)
        target = ikde.Target(p, axis_world_tool=axis) if seed % 2 else ikde.Target(p)
        frozen = {name: float(value) for name, value in zip(robot.joint_names, q, strict=True) if rng.random() < 0.4}
        slides = {joint.name for joint in robot.joints if joint.kind == "prismatic"}
        if not excludes(robot, target, frozen, ()):
            continue
        told = hint(robot, target, freeze=frozen, settings=LM.with_changes(restarts=1))
        if not told.endswith(OPEN):
            assert told.endswith("no joint range brings the tool there")
            assert excludes(robot, target, {}, slides)
            kinds["none"] += 1
            continue
        for freed, wide in read_ways(told):
            assert freed <= set(frozen)
            assert wide <= slides - (set(frozen) - freed)
            kinds[bool(freed), bool(wide)] += 1
            rest = {name: value for name, value in frozen.items() if name not in freed}
            assert not excludes(robot, target, rest, wide)
            for name in freed:
                assert excludes(robot, target, {**rest, name: frozen[name]}, wide - {name})
            for name in wide:
                assert excludes(robot, target, rest, wide - {name})
    assert min(kinds["none"], kinds[True, False], kinds[False, True], kinds[True, True]) >= 2


# ---- what was found by trying


def widen(robot, frozen, names):
    """The robot with the ranges that the short search looked in, of these joints only."""
    ranges = {}
    for joint in robot.joints:
        grow = 1.5 * (joint.upper - joint.lower)
        wide = (joint.lower - grow, joint.upper + grow)
        turn = (min(joint.lower, -np.pi), max(joint.upper, np.pi))
        ranges[joint.name] = wide if joint.kind == "prismatic" else turn
    return with_ranges(robot, {name: ranges[name] for name in names if name not in frozen})


@pytest.mark.usefixtures("few_seeds")
def test_what_was_tried_is_done_again_and_reaches():
    """Joints are freed or their ranges widened as told: the same search then reaches."""
    kinds = Counter()
    for seed in range(60):
        robot, rng = random_robot(seed), np.random.default_rng(seed)
        q = rng.uniform(robot.lower, robot.upper)
        target = ikde.Target(ikde.forward(robot, q)[robot.tool][:3, 3] + rng.choice([0.0, 0.1]) * rng.normal(size=3))
        frozen = {name: None for name in robot.joint_names if rng.random() < 0.4}
        result = ikde.solve(robot, target, LM, freeze=frozen, collision="none")
        told = result.hint or ""
        names = re.sub("^a wider range for |^free |: a solution was found.*", "", told).split(", ")
        if told.startswith("free") and "was found" in told:
            assert names == list(frozen)
            assert ikde.solve(robot, target, LM, collision="none").reached
            kinds["free"] += 1
        if told.startswith("a wider range"):
            assert not set(names) & set(frozen)
            wide = widen(robot, frozen, names)
            assert ikde.solve(wide, target, freeze=frozen, collision="none", seed=1).reached
            kinds["wider"] += 1
        if "was found" in told:
            assert result.stop_reason == "limits"
            assert f"found in {result.attempts} attempts; the best is off by" in result.reason
    assert min(kinds["free"], kinds["wider"]) >= 4


def test_an_engine_that_claims_too_much_makes_no_hint(qiao):
    """A short search is believed only as far as plain numpy confirms it."""
    problem = problem_of(qiao, LM, freeze={"d_x": 0.0})
    probe = Probe(TARGET, 0, 0, 0.0)
    found = probe.run(problem)
    assert probe.confirms(problem, found)
    assert not probe.confirms(problem, replace(found, q=found.q + 1e-3))
    assert not probe.confirms(replace(problem, lower=problem.lower + 0.1), found)
    assert not probe.confirms(problem, replace(found, counts=np.zeros_like(found.counts)))


def test_what_collides_answers_nothing(qiao):
    q = qiao.home.copy()
    q[4] = 2.5
    target = ikde.Target(ikde.forward(qiao, q)[qiao.tool][:3, 3])
    problems = [problem_of(qiao, LM, collision=name) for name in (None, "none")]
    assert [meets(problem, target, q) for problem in problems] == [False, True]


def test_a_solution_inside_the_limits_asks_for_no_wider_range(qiao, monkeypatch):
    problem = problem_of(qiao, LM)
    probe = Probe(TARGET, 0, 0, 0.0)
    inside = probe.run(problem)
    monkeypatch.setattr(Probe, "run", lambda self, problem, **told: inside)
    assert probe.confirms(problem, inside)
    assert try_widening(problem, probe) is None


@pytest.mark.parametrize("seed", [2, 5])
def test_going_on_is_told_if_it_helps(qiao, seed):
    coarse = flat_settings(update="in_place", generations=400, restarts=1, position_tolerance_m=1e-5)
    missed = ikde.solve(qiao, TARGET, coarse, collision="none", seed=seed)
    assert missed.hint == "more restarts: a solution was found by going on"
    again = ikde.solve(qiao, TARGET, coarse.with_changes(restarts=25), collision="none", seed=seed)
    assert again.reached
    assert again.attempts > 1


def test_going_on_begins_where_the_search_ended(qiao, monkeypatch):
    asked = []
    monkeypatch.setattr(Probe, "run", lambda self, problem, **told: asked.append(told))
    monkeypatch.setattr(Probe, "confirms", lambda self, problem, found: False)
    for settings, first in ((LM, 20), (ikde.SolveSettings(), 20), (ikde.SolveSettings(method="lm"), 1000)):
        problem = problem_of(qiao, settings)
        try_longer(problem, Probe(TARGET, 0, 0, 0.0))
        assert asked.pop() == {"first_attempt": first, "attempts": 2}


# ---- tolerances


def near_miss(robot, *, position_m=0.0, turn_rad=0.0):
    """A target that `home` misses by so much, and its problem."""
    T = ikde.forward(robot, robot.home)[robot.tool]
    c, s = np.cos(turn_rad), np.sin(turn_rad)
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    target = ikde.Target(T[:3, 3] + [position_m, 0.0, 0.0], R_world_tool=T[:3, :3] @ turn)
    return target, problem_of(robot)


def ask_tolerance(robot, q, *, detector=None, **miss):
    target, problem = near_miss(robot, **miss)
    graded = verify(robot, target, q, settings=problem.settings, collision=detector)
    return hint_at_tolerance(problem, target, q, graded)


@pytest.mark.parametrize(
    ("miss", "told"),
    [
        ({"position_m": 2.34e-5}, {"m": 2.4e-5}),
        ({"turn_rad": 1.23e-3}, {"rad": 1.3e-3}),
        ({"position_m": 9.85e-4, "turn_rad": 9.72e-3}, {"m": 9.9e-4, "rad": 9.8e-3}),
        ({"position_m": 0.9e-5, "turn_rad": 5.55e-4}, {"rad": 5.6e-4}),
    ],
)
def test_only_tolerances_are_told_that_were_too_narrow(qiao, miss, told):
    hint = ask_tolerance(qiao, qiao.home, **miss)
    assert (
        hint
        == f"a tolerance of {' and '.join(f'{value:.2g} {unit}' for unit, value in told.items())} would accept the best"
    )
    wide = ikde.SolveSettings().with_changes(
        position_tolerance_m=told.get("m"), orientation_tolerance_rad=told.get("rad")
    )
    target, _ = near_miss(qiao, **miss)
    assert verify(qiao, target, qiao.home, settings=wide).accepted
    assert not verify(qiao, target, qiao.home).accepted


@pytest.mark.parametrize("miss", [{"position_m": 1.1e-3}, {"turn_rad": 1.1e-2}, {"position_m": 1e-6}, {}])
def test_no_tolerance_is_told_that_is_far_wider_or_was_asked_for(qiao, miss):
    assert ask_tolerance(qiao, qiao.home, **miss) is None


def test_no_tolerance_makes_up_for_a_collision_or_a_limit(qiao):
    target, problem = near_miss(qiao, position_m=2e-5)
    q = qiao.home.copy()
    q[4] = 2.5
    assert ikde.check(qiao, q).collision
    T = ikde.forward(qiao, q)[qiao.tool]
    colliding = ikde.Target(T[:3, 3] + [2e-5, 0.0, 0.0])
    assert hint_at_tolerance(problem, colliding, q, verify(qiao, colliding, q)) is None
    unchecked = problem_of(qiao, collision="none")
    assert hint_at_tolerance(unchecked, colliding, q, verify(qiao, colliding, q, collision="none"))
    narrow = with_ranges(qiao, {"d_x": (0.1, 0.2)})
    problem = problem_of(narrow, collision="none")
    assert hint_at_tolerance(problem, target, qiao.home, verify(qiao, target, qiao.home)) is None


def test_no_orientation_tolerance_beyond_half_a_turn_is_told(qiao):
    target, problem = near_miss(qiao, turn_rad=3.141)
    wide = replace(problem, settings=ikde.SolveSettings(orientation_tolerance_rad=1.0))
    assert hint_at_tolerance(wide, target, qiao.home, verify(qiao, target, qiao.home)) is None


def test_a_joint_without_limits_is_freed_and_never_widened():
    robot, settings = load_text(ENDLESS), ikde.SolveSettings(method="memetic", restarts=1)
    q = robot.home + np.array([2.0, 0.0, 0.0, 0.5, 0.0, 0.5])
    result = ikde.solve(robot, make_target(robot, q, "pose"), settings, freeze={"pan": 50.0})
    assert result.hint.startswith("free pan: ")
    q[1] = 2.2  # beyond its limit
    hinted = try_widening(problem_of(robot, settings), Probe(make_target(robot, q, "pose"), 0, 0, 0.0))
    assert "lift" in hinted
    assert "pan" not in hinted
    assert "spin" not in hinted


def test_a_turn_is_no_reason_for_a_wider_range():
    """The first joint may stand at -0.28 or at 6.0, which is inside; only the second is beyond its range."""
    robot = with_ranges(make_wrist(), {"a": (0.0, 2.0 * np.pi), "b": (-0.5, 0.5)})
    target = make_target(robot, np.array([6.0, 0.8]), "position")
    hinted = try_widening(problem_of(robot, LM, collision="none"), Probe(target, 0, 0, 0.0))
    assert hinted == "a wider range for b: a solution was found beyond the limits"


def make_wrist():
    frames = [
        make_frame("one", "world", joint="a", axis=(0, 0, 1)),
        make_frame("two", "one", (0.5, 0, 0), joint="b", axis=(0, 1, 0)),
        make_frame("tool", "two", (0.5, 0, 0)),
    ]
    return make_robot({"a": "revolute", "b": "revolute"}, frames, lower=0.0)
