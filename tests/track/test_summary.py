"""The figures of a motion, against what is known of one that was made up."""

import numpy as np
import pytest

from tests.track.measured import DT_S, make_measured, wave


@pytest.fixture(scope="module")
def motion(qiao):
    return make_measured(qiao)


def test_it_meets_its_own_path(motion):
    assert motion.met_points == 20
    assert motion.largest_axis_errors_m.max() == 0.0
    assert motion.started
    assert [motion.robot.joint_names[k] for k in motion.arm] == ["q1", "q2", "q3", "q4", "q5", "q6"]


def test_the_base_counts_by_its_arc(motion):
    np.testing.assert_allclose(motion.driven[:, :2], 0.2)
    np.testing.assert_allclose(motion.driven[:, 2], 0.3)
    assert motion.largest_step("prismatic") == pytest.approx(0.2 * DT_S)
    assert motion.wheel_limit_rad_s == pytest.approx((0.5 + 0.259 * np.pi / 2) / 0.1)


def test_without_wheels_the_base_counts_by_its_arc_all_the_same(motion, unwheeled):
    bare = make_measured(unwheeled)
    np.testing.assert_array_equal(bare.driven, motion.driven)
    assert bare.trajectory.wheel_speeds is None
    assert bare.wheel_limit_rad_s == np.inf


def test_the_fastest_joint_is_named(qiao, motion):
    speeds = np.abs(np.diff(wave(qiao, 20, 0.05), axis=0)) / DT_S
    name, value, limit = motion.fastest
    assert (name, limit) == ("d_x", 0.5)
    assert value == pytest.approx(0.2)
    name, value, limit = make_measured(qiao, amplitude=0.2).fastest
    assert (name, limit) == ("q3", np.pi / 2)
    assert value == pytest.approx(4 * speeds[:, 5].max())


def test_the_rest_of_a_range_is_the_smallest(qiao, motion):
    name, left, end = motion.range_left
    assert name == "q1"
    assert end == pytest.approx(np.radians(169))
    assert left == pytest.approx(np.radians(169) - qiao.home[3] - 0.025)


def test_limits_that_are_off_have_no_worst(qiao):
    motion = make_measured(qiao, speed=None)
    assert motion.fastest is None
    assert motion.largest_acceleration is None
    assert motion.wheel_limit_rad_s == np.inf


def test_an_acceleration_is_named(qiao):
    motion = make_measured(qiao, acceleration=np.full(9, 10.0))
    name, value, limit = motion.largest_acceleration
    assert (name, limit) == ("q3", 10.0)
    assert value > 0.0


def test_what_collides_is_named(qiao):
    free, folded = make_measured(qiao), make_measured(qiao, amplitude=2.6)
    assert not any(free.colliding)
    assert any(folded.colliding)
    assert folded.verification.breaches.collision == sum(map(bool, folded.colliding))
    worst = np.argmin(folded.verification.gaps_m.min(axis=1))
    assert set(folded.closest_pair) <= folded.colliding[worst]


def test_without_a_detector_nothing_collides(qiao):
    motion = make_measured(qiao, detector="none")
    assert motion.closest_pair is None
    assert not any(motion.colliding)
