"""The certificate between samples: never above what dense sampling sees, and near it."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

import ikde
from ikde.model.base_motion import step_base
from ikde.model.collision_model import CollisionModel
from ikde.solver.forward import forward
from ikde.solver.plain import compute_gaps
from ikde.track.certify import bound_pairs, bound_segments, certify, halfway, measure_deviation, travel_radii
from ikde.track.path import ToolPath
from tests.conftest import random_q
from tests.random_robots import random_robot

DENSE = 100


def sample_densely(robot, detector, q):
    """Smallest clearance [M] of each segment at many places."""
    shares = np.linspace(0, 1, DENSE + 1)[:, None]
    return np.array(
        [
            compute_gaps(CollisionModel(robot=robot, detector=detector), a + shares * (b - a)).min()
            for a, b in pairwise(q)
        ]
    )


def walk(robot, rng, steps, size):
    """Joint values [steps + 1, N] of a random walk in the middle of the ranges."""
    width = np.minimum(robot.upper - robot.lower, 2.0)
    middle = np.clip(random_q(robot, rng), robot.lower + 0.3 * width, robot.upper - 0.3 * width)
    return middle + np.cumsum(rng.uniform(-size, size, (steps + 1, len(width))) * width / 10, axis=0)


@pytest.mark.parametrize("size", [0.02, 0.3, 3.0])
def test_it_never_promises_too_much_and_hardly_too_little(qiao, rng, size):
    detector = CollisionModel.of(qiao).detector
    for _ in range(2):
        q = walk(qiao, rng, 12, size)
        lower = bound_segments(CollisionModel(robot=qiao, detector=detector), q)
        seen = sample_densely(qiao, detector, q)
        assert (lower <= seen + 1e-12).all()
        assert lower.min() > seen.min() - max(2e-4, 0.03 * abs(seen.min())) - 1e-3 * size


def test_each_pair_has_a_bound_of_its_own(qiao, rng):
    detector = CollisionModel.of(qiao).detector
    q = walk(qiao, rng, 6, 0.3)
    lower = bound_pairs(CollisionModel(robot=qiao, detector=detector), q)
    np.testing.assert_array_equal(lower.min(axis=1), bound_segments(CollisionModel(robot=qiao, detector=detector), q))
    shares = np.linspace(0, 1, DENSE + 1)[:, None]
    for row, (a, b) in zip(lower, pairwise(q), strict=True):
        seen = compute_gaps(CollisionModel(robot=qiao, detector=detector), a + shares * (b - a)).min(axis=0)
        assert (row <= seen + 1e-12).all()


@pytest.mark.parametrize("beyond", [0.0, 10.0])
@pytest.mark.parametrize("seed", range(25))
def test_it_holds_for_any_tree_and_beyond_its_ranges(seed, beyond):
    robot, rng = random_robot(seed), np.random.default_rng(seed)
    detector = CollisionModel.of(robot).detector
    q = walk(robot, rng, 6, 2.0)
    q[:, robot.is_prismatic] += beyond * (robot.upper - robot.lower)[robot.is_prismatic]
    lower = bound_segments(CollisionModel(robot=robot, detector=detector), q)
    assert (lower <= sample_densely(robot, detector, q) + 1e-12).all()


TELESCOPE = """
name: telescope
joints:
  turn: {kind: revolute, lower: -3, upper: 3}
  slide: {kind: prismatic, lower: 0, upper: 0.001}
frames:
  boom: {parent: world, joint: turn, axis: [0, 0, 1]}
  tip: {parent: boom, joint: slide, axis: [1, 0, 0]}
  post: {parent: world, xyz: [1, 0, 0]}
tool: tip
spheres: {round: [{component: ball, from: tip, radius: 0.05}, {component: post, from: post, radius: 0.05}]}
pairs: {all: {pairs: {post: [ball]}}}
detectors: {it: {spheres: round, pairs: all}}
default_detector: it
"""


def test_what_slides_beyond_its_range_is_carried_farther(tmp_path):
    (tmp_path / "telescope.yaml").write_text(TELESCOPE)
    robot = ikde.load_robot(tmp_path / "telescope.yaml")
    past_the_post = np.array([[-0.3, 1.0], [0.3, 1.0]])
    assert bound_segments(CollisionModel.of(robot), past_the_post)[0] <= -0.1


def test_a_contact_between_free_samples_is_seen(qiao):
    detector = CollisionModel.of(qiao).detector
    sweep = np.tile(qiao.home, (400, 1))
    sweep[:, 3], sweep[:, 4] = np.linspace(qiao.lower[3], qiao.upper[3], 400), 1.2
    free = compute_gaps(CollisionModel(robot=qiao, detector=detector), sweep).min(axis=1) > 0.01
    first = int(np.flatnonzero(free[:-1] & ~free[1:])[0])
    last = first + 1 + int(np.argmax(free[first + 1 :]))
    q = sweep[[first, last]]
    lower = bound_segments(CollisionModel(robot=qiao, detector=detector), q)
    assert free[[first, last]].all()
    assert lower[0] <= sample_densely(qiao, detector, q)[0] < 0.01


def test_only_joints_between_two_components_count(qiao):
    radii = travel_radii(CollisionModel.of(qiao), qiao.upper)
    pairs = CollisionModel.of(qiao).pairs
    np.testing.assert_array_equal(radii[:, :3], 0.0)
    row = radii[pairs.index(("J1", "J4"))]
    np.testing.assert_array_equal(row != 0.0, [False] * 4 + [True] * 2 + [False] * 3)
    row = radii[pairs.index(("M", "LT"))]
    np.testing.assert_array_equal(row > 0.0, [False] * 3 + [True] * 5 + [False])  # the tool lies on the last axis


def test_a_base_does_not_enter(qiao, rng):
    q = walk(qiao, rng, 5, 0.2)
    moved = q.copy()
    moved[:, :3] += rng.uniform(-3, 3, (6, 3))
    np.testing.assert_allclose(
        bound_segments(CollisionModel.of(qiao), q), bound_segments(CollisionModel.of(qiao), moved), atol=1e-12
    )


def test_without_a_detector_nothing_can_touch(qiao, rng):
    assert (bound_segments(CollisionModel.of(qiao, "none"), walk(qiao, rng, 3, 1.0)) == np.inf).all()


@pytest.mark.parametrize("samples", [0, 1])
def test_without_a_segment_there_is_no_certificate(qiao, samples):
    path = ToolPath.through([[0, 0, 1], [0, 0.1, 1]], dt_s=0.02)
    q = np.zeros((samples, 9))
    assert certify(CollisionModel.of(qiao), q) is None
    assert [len(values) for values in measure_deviation(qiao, path, q, "differential")] == [0, 0]


def test_without_a_detector_or_pairs_there_is_no_certificate(qiao, rng):
    q = walk(qiao, rng, 3, 0.1)
    assert certify(CollisionModel.of(qiao, "none"), q) is None
    nothing = replace(qiao.detectors["improved"], pairs="nothing")
    assert certify(CollisionModel(robot=replace(qiao, pair_lists={"nothing": ()}), detector=nothing), q) is None


def test_a_certificate_is_the_least_of_its_segments(qiao, rng):
    q = walk(qiao, rng, 4, 0.1)
    proof = certify(CollisionModel.of(qiao), q)
    np.testing.assert_array_equal(proof.segment_m, bound_segments(CollisionModel.of(qiao), q))
    assert proof.clearance_m == proof.segment_m.min()
    assert proof.is_free is bool(proof.clearance_m > 0.0)


def test_halfway_a_base_is_on_its_arc(qiao):
    q = np.tile(qiao.home, (2, 1))
    q[1, :3] = step_base(q[0, :3], np.array(0.5), np.array(1.5), 0.2)
    q[1, 5] += 0.2
    arc, chord = halfway(qiao, q, "differential", 0.2)[0], halfway(qiao, q, "omnidirectional", 0.2)[0]
    np.testing.assert_allclose(arc[:3], step_base(q[0, :3], np.array(0.5), np.array(1.5), 0.1), atol=1e-15)
    np.testing.assert_allclose(chord, q.mean(axis=0))
    assert arc[5] == chord[5]


def test_deviation_is_from_where_the_path_is_halfway(qiao):
    q = np.tile(qiao.home, (3, 1))
    q[:, 5] = [0.0, 0.1, 0.2]
    p = forward(qiao, q)["tool"][:, :3, 3]
    middle = forward(qiao, 0.5 * (q[:-1] + q[1:]))["tool"]
    on_it = ToolPath(dt_s=0.02, p_world_tool=p, p_half=middle[:, :3, 3])
    assert measure_deviation(qiao, on_it, q, "differential")[0].max() < 1e-12
    chords = ToolPath(dt_s=0.02, p_world_tool=p)
    expected = np.linalg.norm(middle[:, :3, 3] - 0.5 * (p[:-1] + p[1:]), axis=1)
    np.testing.assert_allclose(measure_deviation(qiao, chords, q, "differential")[0], expected)


@pytest.mark.parametrize("room", [1e-4, 1e-6])
def test_free_samples_are_not_doubted_for_lack_of_halvings(qiao, substitute, room):
    detector, shares = CollisionModel.of(qiao).detector, np.linspace(0.0, 1.0, 9)[:, None]
    q = qiao.home + 0.2 * shares * np.ones(9)
    least = compute_gaps(CollisionModel(robot=qiao, detector=detector), q).min()
    # as if the nearest pair kept no more than `room` at the samples
    substitute(compute_gaps, lambda *told: compute_gaps(*told) - (least - room))
    assert bound_segments(CollisionModel(robot=qiao, detector=detector), q).min() > 0.0
