"""One sample, and many: targets are met inside box and constraints, or it is said how they are not."""

import numpy as np
import pytest

from ikde.kernels.arrays import CLEARANCE
from ikde.kernels.tracking import INFEASIBLE, NO_STEP, REACHED, STUCK, make_sample, track_sample, track_span
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_targets
from ikde.model.target import Targets
from ikde.solver.forward import forward
from ikde.solver.plain import compute_gaps
from tests.conftest import random_q
from tests.kernels.driving import Stand

NAMES = ("differential", "omnidirectional")


def take(stand, target, last=None, first_step=False, **changes):
    """Status, rounds, least; where it ends, and the step."""
    q, step = np.empty(9), np.empty(stand.size)
    last = np.zeros(stand.size) if last is None else last
    track = stand.track._replace(**changes)
    parts = (stand.arrays, stand.spheres, stand.drive, track, target, 0, stand.weights, stand.q, last, first_step)
    return track_sample(*parts, stand.work, q, step), q, step


def clear_q(robot, rng):
    """A random configuration near the world's middle with some clearance."""
    while True:
        q = random_q(robot, rng)
        q[:3] = 0.0
        if compute_gaps(CollisionModel.of(robot), q).min() > 0.02:
            return q


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("kind", ["position", "axis", "pose"])
def test_a_near_target_is_met(qiao, rng, name, kind):
    for _ in range(10):
        stand = Stand(qiao, clear_q(qiao, rng), name)
        stand.weights[:3] = 0.3
        target = stand.target(kind, rng.uniform(-2e-3, 2e-3, 3))
        (status, rounds, least), q, step = take(stand, target)
        assert status == REACHED
        assert 0 < rounds < 10
        assert np.abs(step).max() <= 1.0
        T = forward(qiao, q)["tool"]
        np.testing.assert_allclose(T[:3, 3], target.T_world_tool[0, :, 3], atol=1e-9)
        if kind != "position":
            np.testing.assert_allclose(T[:3, 2], target.T_world_tool[0, :, 2], atol=1e-7)
        gaps = compute_gaps(CollisionModel.of(qiao), q)
        if gaps.min() < 0.1:
            assert least == pytest.approx(gaps.min() - 1e-4, abs=1e-9)


def test_what_is_too_far_is_stuck(qiao):
    stand = Stand(qiao, qiao.home)
    (status, _, _), _, step = take(stand, stand.target(shift=(0.0, 0.3, 0.0)))
    assert status == STUCK
    assert np.abs(step).max() == 1.0


def test_pairs_that_are_kept_too_far_apart_leave_no_way(qiao):
    stand = Stand(qiao, qiao.home)
    (status, _, _), _, _ = take(stand, stand.target(), margin=0.3, reach=0.4)
    assert status in (STUCK, INFEASIBLE)


def test_a_joint_that_cannot_brake_has_no_step(qiao):
    stand = Stand(qiao, qiao.home, acceleration=np.full(9, 0.1))
    stand.q[8] = qiao.upper[8] - 1e-4
    assert take(stand, stand.target(), last=np.eye(8)[7])[0][0] == NO_STEP


def test_the_first_step_may_be_any(qiao):
    stand = Stand(qiao, qiao.home, acceleration=np.full(9, 1.0))
    target = stand.target(shift=(0.0, 0.005, 0.0))
    assert take(stand, target)[0][0] == STUCK
    assert take(stand, target, first_step=True)[0][0] == REACHED


def test_a_span_is_its_samples(qiao):
    stand = Stand(qiao, qiao.home)
    p = forward(qiao, stand.q)["tool"][:3, 3] + np.outer(np.arange(31), [0.0, 0.002, -0.001])
    p[25:, 0] += 1.0
    target = pack_targets(Targets(p))
    weights = np.zeros((31, 3 + stand.size))
    weights[:, CLEARANCE] = 0.3
    spans = []
    for cuts in ([30], [10, 30], list(range(1, 31))):
        q, steps = np.zeros((31, 9)), np.zeros((31, stand.size))
        rounds, least = np.zeros(31, dtype=np.int64), np.zeros(31)
        q[0], last = stand.q, 0
        work = make_sample(stand.arrays, stand.spheres, 9, stand.size)
        for cut in cuts:
            packed = (stand.arrays, stand.spheres, stand.drive, stand.track, target, last, cut)
            last, status = track_span(*packed, weights, q, steps, work, rounds, least)
            if status != REACHED:
                break
        assert (last, status) == (24, STUCK)
        spans.append(q[:25])
    np.testing.assert_array_equal(spans[0], spans[1])
    np.testing.assert_array_equal(spans[0], spans[2])
