"""Rows of a step against differences of what they hold."""

import numpy as np
import pytest

from ikde.kernels import step_constraints as kernels
from ikde.kernels.step_constraints import MAX_PAIRS
from ikde.model.base_motion import step_base
from ikde.model.collision_model import CollisionModel
from ikde.solver.plain import compute_frames, compute_gaps
from tests.conftest import random_q
from tests.kernels.driving import Stand
from tests.kernels.step_rows import DIFFERENCE, end_of, rows_at


@pytest.mark.parametrize("name", ["differential", "omnidirectional"])
def test_pairs_are_the_nearest_with_their_gaps_and_slopes(qiao, rng, name):
    detector = CollisionModel.of(qiao).detector
    for _ in range(2):
        stand = Stand(qiao, random_q(qiao, rng), name)
        stand.q[:2] = 0.0
        stand.track = stand.track._replace(reach=0.3)
        step = rng.uniform(-1, 1, stand.size)
        slack, slope, pair = rows_at(stand, step)
        gaps = compute_gaps(CollisionModel(robot=qiao, detector=detector), end_of(stand, step))
        near = np.sort(gaps[gaps < 0.3])[:MAX_PAIRS]
        np.testing.assert_allclose(np.sort(slack), near - stand.track.margin, atol=1e-12)
        for k in range(stand.size):
            move = DIFFERENCE * np.eye(stand.size)[k]
            ends = [
                compute_gaps(CollisionModel(robot=qiao, detector=detector), end_of(stand, step + d))[pair]
                for d in (move, -move)
            ]
            np.testing.assert_allclose(slope[:, k], (ends[0] - ends[1]) / (2 * DIFFERENCE), atol=1e-6)


def test_no_pair_is_constrained_without_reach(qiao):
    stand = Stand(qiao, qiao.home)
    stand.track = stand.track._replace(reach=-np.inf)
    assert len(rows_at(stand, np.zeros(8))[0]) == 0


def test_a_base_keeps_its_place(qiao, rng):
    stand = Stand(qiao, qiao.home)
    stand.q[:3] = [4.99, -4.97, 0.4]
    stand.track = stand.track._replace(reach=-np.inf)
    step = rng.uniform(-1, 1, 8)
    slack, slope, _ = rows_at(stand, step)
    x, y, _ = end_of(stand, step)[:3]
    np.testing.assert_allclose(slack, [5.0 - x - kernels.INSIDE, y + 5.0 - kernels.INSIDE], atol=1e-12)
    for k in range(8):
        move = DIFFERENCE * np.eye(8)[k]
        change = (end_of(stand, step + move) - end_of(stand, step - move)) / (2 * DIFFERENCE)
        np.testing.assert_allclose(slope[:, k], [-change[0], change[1]], atol=1e-8)


def test_an_arc_from_the_end_of_a_range_stays_inside_on_its_way(qiao, rng):
    """Arcs that the rows allow never leave the range; arcs that end inside but leave it before do not pass them."""
    stand = Stand(qiao, qiao.home, speed=np.full(9, 20.0))
    stand.track = stand.track._replace(reach=-np.inf)
    passed, refused, shares = 0, 0, np.linspace(0.0, 1.0, 60)
    for _ in range(1200):
        axis, side, step = rng.integers(2), rng.choice([-1.0, 1.0]), rng.uniform(-1, 1, 8)
        stand.q[:2], stand.q[2] = 0.0, (axis + 1 + 2 * rng.integers(2)) * np.pi / 2 + rng.uniform(-0.4, 0.4)
        stand.q[axis] = side * (5.0 - rng.choice([0.0, 1.0]) * rng.uniform(0.0, 0.06))
        slack, slope, _ = rows_at(stand, step)
        np.testing.assert_allclose(slack[1:] - slope[1:] @ step, 5.0 - side * stand.q[axis], atol=1e-12)
        twist = (np.full(60, largest * share) for largest, share in zip(stand.drive.largest[:2], step[:2], strict=True))
        way = side * step_base(stand.q[:3], *twist, shares)[:, axis]
        leaves = (way > 5.0 + 1e-9).any()
        passed += (slack >= -1e-12).all()
        assert not (leaves and (slack >= -1e-12).all())
        refused += leaves and way[-1] <= 5.0
    assert (passed > 200, refused > 20) == (True, True)


def test_wheels_keep_their_speed(qiao, rng):
    stand = Stand(qiao, qiao.home, wheel_speed_rad_s=3.0)
    stand.track = stand.track._replace(reach=-np.inf)
    step = rng.uniform(-1, 1, 8)
    slack, slope, _ = rows_at(stand, step)
    travel = 3.0 * 0.1 * 0.02
    left, right = (0.01 * step[0] + sign * 0.259 * 0.5 * np.pi * 0.02 * step[1] for sign in (-1, 1))
    np.testing.assert_allclose(slack, [travel - left, travel + left, travel - right, travel + right], atol=1e-15)
    np.testing.assert_allclose(slack - slope @ step, np.full(4, travel), atol=1e-15)


def test_wheels_that_the_base_implies_need_no_rows(qiao):
    stand = Stand(qiao, qiao.home, wheel_speed_rad_s=(0.5 + 0.259 * 0.5 * np.pi) / 0.1)
    stand.track = stand.track._replace(reach=-np.inf)
    assert len(rows_at(stand, np.zeros(8))[0]) == 0


@pytest.mark.parametrize("name", ["differential", "omnidirectional"])
def test_the_tool_keeps_near_the_platform(qiao, rng, name):
    stand = Stand(qiao, 0.5 * random_q(qiao, rng), name, max_distance_m=1.2, center="Oc")
    stand.q[:2] = 0.0
    stand.track = stand.track._replace(reach=-np.inf)
    step = rng.uniform(-1, 1, stand.size)

    def slack_at(step):
        frames = compute_frames(qiao, end_of(stand, step))
        return 1.2 - np.linalg.norm(frames["tool"][:3, 3] - frames["Oc"][:3, 3]) - kernels.INSIDE

    slack, slope, _ = rows_at(stand, step)
    assert slack == pytest.approx([slack_at(step)], abs=1e-12)
    for k in range(stand.size):
        move = DIFFERENCE * np.eye(stand.size)[k]
        change = (slack_at(step + move) - slack_at(step - move)) / (2 * DIFFERENCE)
        assert slope[0, k] == pytest.approx(change, abs=1e-8)
