"""Verdicts of pairs for all joint values: no random configuration contradicts one, and what is constant is exact."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ikde.kernels.arrays import COORDINATE
from ikde.model.apart import MAX_JOINTS, compute_gaps, decide, find_chains, is_apart, list_clusters
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot
from ikde.model.robot import Detector
from ikde.solver import plain
from tests.collision_robots import make_row
from tests.random_robots import make_frame, make_robot, random_robot

BOXES = 2_000


def find_all(robot):
    """Pairs of the default detector with their chains, and the packed robot."""
    collision, packed = CollisionModel.of(robot), pack_robot(robot)
    clusters = list_clusters(collision.arrays)
    pairs = collision.arrays.pairs.astype(int).tolist()
    return packed, [find_chains(packed, clusters[a], clusters[b]) for a, b in pairs]


@given(seed=st.integers(0, 200), limit=st.sampled_from([-0.02, 0.0, 0.01, 0.1]))
def test_no_configuration_contradicts_a_verdict(seed, limit):
    robot = random_robot(seed)
    packed, every = find_all(robot)
    q = np.random.default_rng(seed).uniform(*robot.drawn, (60, len(robot.joints)))
    for chains, gaps in zip(every, plain.compute_gaps(CollisionModel.of(robot), q).T, strict=True):
        verdict = decide(packed, chains, limit, robot.drawn, BOXES)
        is_near = len(chains.joined) <= MAX_JOINTS
        assert is_apart(packed, chains, limit, robot.drawn, BOXES) == (is_near and verdict.answer == "apart")
        if verdict.answer == "apart":
            assert gaps.min() > limit
        if verdict.answer == "touching":
            assert gaps.max() <= limit - verdict.depth_m + 1e-9


def test_gaps_are_those_of_plain_numpy():
    robot = random_robot(3)
    packed, every = find_all(robot)
    q = np.random.default_rng(0).uniform(*robot.drawn, (20, len(robot.joints)))
    for chains, gaps in zip(every, plain.compute_gaps(CollisionModel.of(robot), q).T, strict=True):
        own = q[:, packed.bodies[chains.joined, COORDINATE]]
        np.testing.assert_allclose(compute_gaps(packed, chains, own), gaps, atol=1e-12)


def on_the_axis(height, **limits):
    """A fixed sphere, and one on the axis of the joint above it."""
    frames = [
        make_frame("base", "world"),
        make_frame("turn", "world", (0.1, 0.2, 0.3), rpy=(0.3, -0.4, 0.5), joint="turn", axis=(1, 2, 3)),
        make_frame("tool", "turn", 0.1 * np.array([1.0, 2.0, 3.0]) / np.sqrt(14.0)),
    ]
    away = np.linalg.norm(np.array([0.1, 0.2, 0.3]) + frames[1].R_parent_frame @ frames[2].p_parent_frame)
    rows = [make_row("base", "base", "base", away - 0.05 - height), make_row("tool", "tool", "tool", 0.05)]
    return make_robot(
        {"turn": "revolute"},
        frames,
        approximations={"spheres": tuple(rows)},
        pair_lists={"some": (("base", "tool"),)},
        detectors={"some": Detector(name="some", spheres="spheres", pairs="some")},
        default_detector="some",
        **limits,
    )


@pytest.mark.parametrize("limits", [{}, {"lower": -7.0, "upper": 9.0}])
def test_what_stands_on_the_axis_is_decided_exactly(limits):
    """A pair whose distance does not change: its depth is exact, and so is a clearance of 10 um."""
    robot = on_the_axis(-0.0125, **limits)
    packed, (chains,) = find_all(robot)
    verdict = decide(packed, chains, 0.0, robot.drawn, BOXES)
    assert verdict.answer == "touching"
    assert verdict.depth_m == pytest.approx(0.0125, abs=1e-9)
    robot = on_the_axis(1e-5, **limits)
    packed, (chains,) = find_all(robot)
    assert decide(packed, chains, 0.0, robot.drawn, 1).answer == "apart"
    assert decide(packed, chains, 2e-5, robot.drawn, 1).answer == "touching"


def test_a_pair_many_joints_apart_is_given_up_at_once_or_by_the_budget():
    names = [f"j{k}" for k in range(MAX_JOINTS + 1)]
    frames = [make_frame(n, f"j{k - 1}" if k else "world", joint=n, axis=(0, 0, 1)) for k, n in enumerate(names)]
    rows = (make_row("base", "world", "world", 0.1), make_row("tool", "tool", "tool", 0.1))
    robot = make_robot(
        dict.fromkeys(names, "revolute"),
        [*frames, make_frame("tool", names[-1], (0, 0, 5))],
        approximations={"spheres": rows},
        pair_lists={"some": (("base", "tool"),)},
        detectors={"some": Detector(name="some", spheres="spheres", pairs="some")},
        default_detector="some",
    )
    packed, (chains,) = find_all(robot)
    assert not is_apart(packed, chains, 0.0, robot.drawn, BOXES)
    assert decide(packed, chains, 0.0, robot.drawn, 1).answer == "unknown"
    assert decide(packed, chains, 0.0, robot.drawn, BOXES).answer == "apart"


@pytest.mark.parametrize("limits", [{"lower": 0.5, "upper": 0.5}, None])
def test_what_does_not_move_is_decided_at_the_limit_itself(limits):
    robot = on_the_axis(0.0, **(limits or {}))
    packed, (chains,) = find_all(robot)
    still = chains if limits else chains._replace(bodies=((), ()))
    gap = float(compute_gaps(packed, still, np.full((1, len(still.joined)), 0.5))[0])
    for limit, answer in ((gap, "touching"), (gap - 1e-9, "apart"), (gap + 1e-9, "touching")):
        verdict = decide(packed, still, limit, robot.drawn, BOXES)
        assert (verdict.answer, verdict.boxes) == (answer, 1)
