"""What is called reached is reached: random robot files, random questions, answers graded by code of the tests' own."""

import ast
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import ikde
from ikde.model.collision_model import CollisionModel
from ikde.model.rotation import rotation_from_rpy
from ikde.solver.engines import pool
from ikde.solver.plain import compute_gaps
from tests import regrade, robot_texts, three_joints
from tests.asking import account_for_pairs, ask, ask_and_regrade, draw_question, grade_answers
from tests.conftest import ROBOTS, random_q
from tests.regrade import Grader, find_faults
from tests.robot_files import load_text
from tests.robot_texts import random_robot_text

SHIPPED = [Path(ikde.__file__).parent / "robots" / f"{name}.yaml" for name in ROBOTS]
RANDOM = range(12)
ROUNDING = 1e-12  # m
HAND_MADE = """
name: hand made
units: {length: mm, angle: deg}
joints:
  slide: {kind: prismatic, lower: -100, upper: 1000}
  turn: {kind: revolute, lower: -90, upper: 90, home: 10}
frames:
  tip: {parent: arm, xyz: [0, 0, 250], rpy: [90, 0, 90]}
  arm: {parent: rail, xyz: [0, 0, 500], joint: turn, axis: [0, 2, 0]}
  rail: {parent: world, joint: slide, axis: [1, 0, 0]}
tool: tip
spheres:
  rows:
    - {component: floor, from: world, radius: 200}
    - {component: bar, from: arm, to: tip, radius: 20, count: 4, spacing: even}
    - {component: bar, from: arm, to: tip, radius: 30, count: 2}
    - {component: hand, from: arm, to: tip, radius: 10}
    - {component: box, from: rail, radius: 50}
pairs:
  inner: {pairs: {floor: [bar]}}
  outer: {pairs: {box: [hand]}, include: [inner]}
adjacent: {pairs: {hand: {floor: out of reach}}}
detectors:
  every: {spheres: rows, safe_distance: 5}
  outer: {spheres: rows, pairs: outer}
default_detector: outer
"""


def grader_and_robot(seed):
    text = random_robot_text(seed)
    return Grader.of_text(text), load_text(text)


def pairs(*names):
    return {frozenset(pair.split("-")) for pair in names}


# ---- the grader


def test_grader_and_robot_texts_know_nothing_of_ikde():
    for module in (regrade, robot_texts):
        nodes = [node for node in ast.walk(ast.parse(Path(module.__file__).read_text())) if hasattr(node, "names")]
        names = {getattr(node, "module", None) or node.names[0].name for node in nodes}
        assert not any("ikde" in name for name in names)


def test_the_grader_agrees_with_figures_made_by_hand():
    grader = Grader.of_text(HAND_MADE)
    assert grader.lower == pytest.approx([-0.1, -np.pi / 2])
    assert grader.home == pytest.approx([0.0, np.radians(10.0)])
    Q = np.array([[0.3, np.pi / 2], [0.0, 0.0]])
    R, p = grader.place(Q)["tip"]
    assert p == pytest.approx(np.array([[0.55, 0.0, 0.5], [0.0, 0.0, 0.75]]))
    # Rolled by 90 deg about the fixed x, z becomes -y; yawed by 90 deg about the fixed z, -y becomes x.
    assert R[1] == pytest.approx(np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]]), abs=1e-15)
    assert R[0, :, 2] == pytest.approx([0.0, 0.0, -1.0], abs=1e-15)
    gaps = grader.clearances(Q[:1], "outer")
    assert gaps[frozenset(("floor", "bar"))] == pytest.approx([np.hypot(0.3, 0.5) - 0.22])
    assert gaps[frozenset(("box", "hand"))] == pytest.approx([np.hypot(0.125, 0.5) - 0.06])
    centres, radii = grader.spheres("rows", Q[1:])["bar"]
    assert centres[0, :, 2] == pytest.approx([0.5, 0.5 + 0.25 / 3, 0.5 + 0.5 / 3, 0.75, 0.595, 0.655])
    assert radii == pytest.approx([0.02] * 4 + [0.03] * 2)


def test_the_grader_knows_which_pairs_are_compared_and_why_others_are_not():
    grader = Grader.of_text(HAND_MADE)
    assert grader.compared() == grader.compared("outer") == pairs("floor-bar", "box-hand")
    assert grader.compared("every") == pairs("floor-bar")
    assert grader.compared("none") == set()
    assert grader.safe_distance("every") == pytest.approx(0.005)
    assert grader.left_out("every") == {
        frozenset(("floor", "hand")): "adjacent: out of reach",
        frozenset(("floor", "box")): "joined by joint slide",
        frozenset(("bar", "box")): "joined by joint turn",
        frozenset(("hand", "box")): "joined by joint turn",
        frozenset(("bar", "hand")): "one body",
    }
    assert grader.left_out()[frozenset(("floor", "hand"))] == "adjacent: out of reach"


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_the_grader_sees_what_ikde_sees_on_robots_that_ship(path, rng):
    check_agreement(Grader.of_text(path.read_text(encoding="utf-8")), ikde.load_robot(path.stem), rng)


@pytest.mark.parametrize("seed", RANDOM)
def test_the_grader_sees_what_ikde_sees_on_random_robots(seed, rng):
    check_agreement(*grader_and_robot(seed), rng)


def check_agreement(grader, robot, rng):
    """Limits, poses, errors, every clearance of every detector, and every pair."""
    assert grader.lower == pytest.approx(robot.lower, abs=1e-15, rel=1e-15)
    assert grader.upper == pytest.approx(robot.upper, abs=1e-15, rel=1e-15)
    Q = random_q(robot, rng, 20)
    T_world = ikde.forward(robot, Q)
    for name, (R, p) in grader.place(Q).items():
        T_world_frame = T_world.get(name, np.broadcast_to(np.eye(4), (len(Q), 4, 4)))  # it leaves out the world
        np.testing.assert_allclose(np.concatenate([R, p[:, :, None]], axis=2), T_world_frame[:, :3], atol=ROUNDING)
    for name, detector in robot.detectors.items():
        gaps = grader.clearances(Q, name)
        for k, q in enumerate(Q):
            seen = {frozenset((pair.a, pair.b)): pair.clearance_m for pair in ikde.check(robot, q, detector).pairs}
            assert {pair: gap[k] for pair, gap in gaps.items()} == pytest.approx(seen, abs=ROUNDING)
    assert not account_for_pairs(robot, grader).faults


# ---- the robots


def test_a_seed_always_draws_the_same_robot():
    assert random_robot_text(3) == random_robot_text(3) != random_robot_text(4)


def test_random_robots_are_as_odd_as_the_law_asks():
    graders = [Grader.of_text(random_robot_text(seed)) for seed in range(60)]
    counts = [len(grader.joints) for grader in graders]
    assert min(counts) <= 2
    assert max(counts) == robot_texts.MAX_JOINTS
    odd = [sum(bool(is_odd(grader)) for grader in graders) for is_odd in ODDITIES]
    assert min(odd) >= 3, odd


def has_branches(grader):
    below = [grader._below(name) for name, frame in grader.frames.items() if "joint" in frame]
    return len(set(below)) < len(below)


def has_bare_links_between_compared_parts(grader):
    carriers = set(grader.components().values())
    return bool(grader.compared()) and any(grader.body(name) not in carriers for name in grader.frames)


ODDITIES = [
    has_branches,
    has_bare_links_between_compared_parts,
    lambda grader: not grader.compared(),
    lambda grader: grader.compared() and grader.body(grader.tool) != list(grader.joints)[-1],
    lambda grader: np.any(grader.lower == grader.upper),
    lambda grader: any(grader.is_prismatic.values()) and not all(grader.is_prismatic.values()),
    lambda grader: grader.length != 1.0,
    lambda grader: "adjacent" in grader.file,
    lambda grader: len(grader.file.get("detectors", ())) > 1,
    lambda grader: "world" in grader.components().values(),
    lambda grader: np.any((grader.upper - grader.lower > 3.0 * np.pi) & ~grader.is_endless),
    lambda grader: grader.is_endless.any(),
]


# ---- the law


@pytest.mark.parametrize("seed", RANDOM)
def test_what_is_called_reached_is_reached(seed, monkeypatch):
    monkeypatch.setattr(pool, "DRAWN", pool.DRAWN_NARROW)  # a robot's pools are most of the time of so few questions
    grader, robot = grader_and_robot(seed)
    tally = ask_and_regrade(robot, grader, np.random.default_rng(seed), 60, most=12)
    assert not tally.faults
    assert tally.counts["reached"] >= 5


def test_what_written_kernels_call_reached_is_reached(monkeypatch):
    """Of a robot whose kernels other tests compile as well."""
    monkeypatch.delenv("IKDE_KERNELS")
    grader, robot = Grader.of_text(three_joints.FILE.read_text(encoding="utf-8")), three_joints.ROBOT
    tally = ask_and_regrade(robot, grader, np.random.default_rng(0), 60, most=12, kinds=("pose",), detectors=(None,))
    assert not tally.faults
    assert tally.counts["reached"] > 10


# ---- the law has teeth


FREE, TOUCHING, OUTSIDE = (0.3, 0.2), (0.0, 1.5), (0.3, 1.6)


@pytest.mark.parametrize(
    ("q", "away_m", "turned_rad", "frozen", "fault"),
    [
        (FREE, 0.9e-3, 0.9e-2, {"slide": 0.3}, None),
        (FREE, 1.1e-3, 0.0, {}, "out of position tolerance"),
        (FREE, np.nan, 0.0, {}, "out of position tolerance"),
        (FREE, 0.0, 1.1e-2, {}, "out of orientation tolerance"),
        (FREE, 0.0, 0.0, {"turn": 0.2 + 1e-11}, "frozen joint moved"),
        (OUTSIDE, 0.0, 0.0, {}, "outside the limits"),
        (TOUCHING, 0.0, 0.0, {}, "in collision"),
    ],
)
@pytest.mark.parametrize("kind", ["axis", "pose"])
def test_each_fault_is_told_by_its_name(kind, q, away_m, turned_rad, frozen, fault):
    grader, Q = Grader.of_text(HAND_MADE.replace("radius: 200", "radius: 490")), np.array([q])
    R, p = grader.place(Q)["tip"]
    turned = R @ Rotation.from_rotvec([turned_rad, 0.0, 0.0]).as_matrix()
    T = np.concatenate([turned, (p + away_m * np.eye(3)[1])[:, :, None]], axis=2)
    figures = np.column_stack(grader.grade(Q, (np.array([kind]), T)))
    faults = find_faults(grader, Q, figures, (1e-3, 1e-2), frozen=frozen)
    assert [name for name, rows in faults.items() if rows.any()] == ([fault] if fault else [])


def test_whatever_is_called_reached_and_is_not_is_found():
    grader, robot = grader_and_robot(1)
    question = draw_question(grader, np.random.default_rng(0), 100)
    answers = ask(robot, replace(question, how="many", method="lm", restarts=8))
    lied = grade_answers(grader, question, replace(answers, reached=np.ones(len(answers.q), dtype=bool)))
    assert len({tuple(fault["q"]) for fault in lied.faults}) == (~answers.reached).sum() > 0


@pytest.mark.parametrize("detector", [None, "none"])
def test_a_verdict_on_what_was_not_compared_is_found_as_well_as_a_wrong_one(detector):
    grader, robot = grader_and_robot(0)
    question = replace(draw_question(grader, np.random.default_rng(0), 9), how="many", detector=detector)
    answers = ask(robot, question)
    assert not grade_answers(grader, question, answers).faults
    answers.collides[3] = None if detector is None else False
    answers.verified[5] = False
    told = [fault["fault"] for fault in grade_answers(grader, question, answers).faults]
    assert told == ["other verdict on collision than told", "graders of ikde disagree"]


@pytest.mark.parametrize("column", range(3))
def test_a_figure_that_is_not_so_is_found(column):
    grader, robot = grader_and_robot(0)
    question = replace(draw_question(grader, np.random.default_rng(0), 9), method="lm", restarts=8, detector=None)
    answers = ask(robot, question)
    answers.figures[4, column] += 1e-8
    assert [fault["fault"] for fault in grade_answers(grader, question, answers).faults] == ["other figures than told"]


def turn_the_other_way_round(rpy_rad):
    roll, pitch, yaw = (rotation_from_rpy(one) for one in np.diag(rpy_rad))
    return roll @ pitch @ yaw


def forget_a_sphere(robot):
    """Of the first row that has several."""
    fine = list(robot.approximations["fine"])
    k = next(k for k, row in enumerate(fine) if row.count > 1)
    fine[k] = replace(fine[k], count=fine[k].count - 1)
    return replace(robot, approximations={**robot.approximations, "fine": tuple(fine)})


def forget_a_pair(robot):
    """The one that touches most often."""
    detector, Q = CollisionModel.of(robot).detector, random_q(robot, np.random.default_rng(0), 200)
    pairs = CollisionModel(robot=robot, detector=detector).pairs
    hits = compute_gaps(CollisionModel(robot=robot, detector=detector), Q) <= detector.safe_distance_m
    forgotten = pairs[np.argmax(hits.sum(axis=0))]
    kept = tuple(pair for pair in pairs if pair != forgotten)
    return replace(robot, pair_lists={**robot.pair_lists, detector.pairs: kept})


@pytest.mark.parametrize("spoil", [forget_a_sphere, forget_a_pair])
def test_answers_for_a_robot_that_lacks_something_are_found_out(spoil):
    grader, robot = grader_and_robot(SPOILT)
    tally = ask_and_regrade(spoil(robot), grader, np.random.default_rng(0), 100, most=50)
    assert any(fault["fault"] == "in collision" for fault in tally.faults)


def test_answers_for_a_robot_whose_rpy_is_read_the_other_way_round_are_found_out(substitute):
    substitute(rotation_from_rpy, turn_the_other_way_round)
    grader, robot = grader_and_robot(SPOILT)
    tally = ask_and_regrade(robot, grader, np.random.default_rng(0), 50, most=50)
    assert any("tolerance" in fault["fault"] for fault in tally.faults)


@pytest.mark.parametrize("spoil", [lambda robot: replace(robot, neighbours=()), forget_a_pair])
def test_a_pair_without_account_is_found_out(spoil):
    grader, robot = grader_and_robot(LISTED)
    assert account_for_pairs(spoil(robot), grader).faults


SPOILT, LISTED = 4, 6
