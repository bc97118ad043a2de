"""What the null space is used for: gradients against differences, and the ways they point."""

import numpy as np
import pytest

from ikde.kernels import nullspace, tracking
from ikde.kernels.arrays import CLEARANCE, DRIFT, LIMITS, MANIPULABILITY
from ikde.kernels.drive import take_drive_step
from ikde.kernels.step_constraints import MAX_PAIRS
from ikde.model.collision_model import CollisionModel
from ikde.solver.plain import compute_gaps
from tests.conftest import random_q
from tests.kernels.driving import Stand
from tests.uncompiled import plain

set_preferred_step, compute_poses = plain(tracking.set_preferred_step), plain(tracking.compute_poses)
add_manipulability_gradient = plain(tracking.add_manipulability_gradient)
NAMES = ("differential", "omnidirectional")


def preferred_of(stand, kind="position", **weights):
    stand.weights[:] = 0.0
    for column, value in ((CLEARANCE, "apart"), (LIMITS, "middle"), (MANIPULABILITY, "manipulability")):
        stand.weights[column] = weights.get(value, 0.0)
    parts = (stand.arrays, stand.spheres, stand.drive, stand.track, stand.target(kind), 0, stand.weights)
    still = np.zeros(stand.size)
    set_preferred_step(*parts, stand.q, still, still, stand.work)
    return stand.work.preferred / (1.0 - nullspace.INERTIA)


def log_manipulability(stand, kind, q):
    """Log det(I + stiffness J^T J) / 2 at `q`, with the stiffness of where it stands."""
    work = stand.work
    compute_poses(stand.arrays, stand.q, work.T_world_body, work.T_world_tool)
    fill = plain(tracking.fill_step_jacobian)
    still = np.zeros(stand.size)
    rows = fill(stand.arrays, stand.drive, stand.track, stand.target(kind), 0, stand.q, still, work)
    stiffness = nullspace.MANIPULABILITY_STIFFNESS / ((work.jacobian[:rows] ** 2).sum() / rows)
    compute_poses(stand.arrays, q, work.T_world_body, work.T_world_tool)
    fill(stand.arrays, stand.drive, stand.track, stand.target(kind), 0, q, still, work)
    J = work.jacobian[:rows]
    return 0.5 * np.linalg.slogdet(np.eye(stand.size) + stiffness * J.T @ J)[1]


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("kind", ["position", "pose"])
def test_log_manipulability_is_a_gradient(qiao, rng, name, kind):
    for _ in range(3):
        stand = Stand(qiao, random_q(qiao, rng), name)
        stand.weights[MANIPULABILITY] = 1.0
        stand.work.preferred[:] = 0.0
        compute_poses(stand.arrays, stand.q, stand.work.T_world_body, stand.work.T_world_tool)
        parts = (stand.arrays, stand.drive, stand.track, stand.target(kind), 0, stand.weights)
        add_manipulability_gradient(*parts, stand.q, np.zeros(stand.size), stand.work)
        found = stand.work.preferred.copy()
        first = stand.size - len(stand.drive.others)
        np.testing.assert_array_equal(found[:first], 0.0)
        for k in range(first, stand.size):
            ends = []
            for sign in (1e-4, -1e-4):
                end = np.empty(9)
                plain(take_drive_step)(stand.drive, stand.q, sign * np.eye(stand.size)[k], end)
                ends.append(log_manipulability(stand, kind, end))
            assert found[k] == pytest.approx((ends[0] - ends[1]) / 2e-4, abs=1e-6)


def step_gaps(stand, step):
    """Clearance of each pair [P] at the end of a step."""
    end, detector = np.empty(9), CollisionModel.of(stand.robot).detector
    plain(take_drive_step)(stand.drive, stand.q, step, end)
    return compute_gaps(CollisionModel(robot=stand.robot, detector=detector), end)


@pytest.mark.parametrize("name", NAMES)
def test_near_pairs_are_moved_up_the_gradients_of_their_gaps(qiao, rng, name):
    """By all joints; a pair as hard as the square of how near it is, whatever the length of its gradient."""
    moved = 0
    for _ in range(8):
        stand = Stand(qiao, random_q(qiao, rng), name)
        moves = 1e-6 * np.eye(stand.size)
        gaps, expected = step_gaps(stand, np.zeros(stand.size)), np.zeros(stand.size)
        slopes = np.array([step_gaps(stand, move) - step_gaps(stand, -move) for move in moves]) / 2e-6
        nearest, track = np.argsort(gaps)[:MAX_PAIRS], stand.track
        for pair in nearest[gaps[nearest] < track.reach]:
            near = 1.0 - (gaps[pair] - track.margin) / (track.reach - track.margin)
            expected += 1e-2 * near**2 * slopes[:, pair] / np.linalg.norm(slopes[:, pair])
        np.testing.assert_allclose(preferred_of(stand, apart=1e-2), expected, atol=1e-8)
        moved += expected.any()
    assert moved >= 6


def test_limits_are_avoided_near_the_ends_only(qiao):
    stand = Stand(qiao, qiao.home)
    stand.q[3:] = 0.4 * qiao.upper[3:]
    np.testing.assert_array_equal(preferred_of(stand, middle=1.0), 0.0)
    stand.q[4], stand.q[5] = 0.75 * qiao.upper[4], 0.9 * qiao.lower[5]
    preferred = preferred_of(stand, middle=0.5)
    np.testing.assert_allclose(preferred, [0, 0, 0, -0.25, 0.4, 0, 0, 0], atol=1e-12)


def test_drift_is_taken_as_it_is_within_reason(qiao):
    stand = Stand(qiao, qiao.home, speed=np.array([0.5] * 8 + [0.0]))
    stand.weights[DRIFT:] = [0.1, -0.2, 3.0, -3.0, 0, 0, 0, 0.5]
    parts = (stand.arrays, stand.spheres, stand.drive, stand.track, stand.target(), 0, stand.weights)
    set_preferred_step(*parts, stand.q, np.zeros(8), np.zeros(8), stand.work)
    most, share = nullspace.MAX_SHARE, 1.0 - nullspace.INERTIA
    np.testing.assert_allclose(stand.work.preferred, share * np.array([0.1, -0.2, most, -most, 0, 0, 0, 0.0]))


def test_a_preferred_step_continues_the_step_before(qiao):
    stand = Stand(qiao, qiao.home, speed=np.array([0.5] * 8 + [0.0]))
    stand.weights[:] = 0.0
    parts = (stand.arrays, stand.spheres, stand.drive, stand.track, stand.target(), 0, stand.weights)
    last = np.array([0.9, -0.5, 0.0, 1.0, 0.1, 0, 0, 0.3])
    set_preferred_step(*parts, stand.q, last, np.zeros(8), stand.work)
    np.testing.assert_allclose(stand.work.preferred, nullspace.INERTIA * last * (stand.drive.largest > 0.0))
