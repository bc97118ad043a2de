"""Limits: the paper's for any robot, each of them switchable, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from ikde.track.limits import MotionLimits
from tests.endless_robot import ENDLESS
from tests.robot_files import load_text


def test_those_of_the_paper(qiao):
    limits = MotionLimits.of(qiao)
    np.testing.assert_allclose(limits.speed, [0.5, 0.5] + 7 * [0.5 * np.pi])
    assert (limits.ranges, limits.acceleration, limits.wheel_speed_rad_s, limits.max_distance_m) == (
        True,
        None,
        None,
        None,
    )
    assert (limits.position_error_m, limits.orientation_error_rad) == (1e-6, 1e-4)
    assert MotionLimits.of(qiao, speed=None).speed is None


def test_a_robots_own_speeds_and_accelerations_come_first(qiao):
    own = (replace(qiao.joints[0], max_speed=0.2), *qiao.joints[1:4], replace(qiao.joints[4], max_acceleration=3.0))
    limits = MotionLimits.of(replace(qiao, joints=(*own, *qiao.joints[5:])))
    np.testing.assert_array_equal(limits.speed, [0.2, 0.5] + 7 * [0.5 * np.pi])
    np.testing.assert_array_equal(limits.acceleration, 4 * [np.inf] + [3.0] + 4 * [np.inf])
    panda = MotionLimits.of(ikde.load_robot("panda"))
    assert (panda.speed[4], panda.acceleration[1]) == (2.61, 7.5)
    assert MotionLimits.of(ikde.load_robot("ur5")).speed.tolist() == [np.pi] * 6
    assert MotionLimits.of(ikde.load_robot("panda"), acceleration=None).acceleration is None


def test_they_fit_other_robots(any_robot):
    assert MotionLimits.of(any_robot).check(any_robot).speed.shape == (len(any_robot.joints),)


def test_a_speed_may_be_zero_or_any_an_acceleration_must_not_be_zero():
    assert MotionLimits(speed=[0.0, np.inf], acceleration=[1.0, np.inf]).speed.tolist() == [0.0, np.inf]
    with pytest.raises(InputError, match="above 0"):
        MotionLimits(speed=None, acceleration=[0.0])


@pytest.mark.parametrize(
    ("given", "key"),
    [
        ({"speed": [-1.0]}, "speed"),
        ({"speed": [np.nan]}, "speed"),
        ({"speed": "fast"}, "speed"),
        ({"speed": 1.0}, "speed"),
        ({"wheel_speed_rad_s": 0.0}, "wheel_speed_rad_s"),
        ({"max_distance_m": np.inf, "center": "Oc"}, "max_distance_m"),
        ({"max_distance_m": 1.0}, "center"),
        ({"position_error_m": 0.0}, "position_error_m"),
    ],
)
def test_what_is_refused(given, key):
    with pytest.raises(InputError) as caught:
        MotionLimits(**{"speed": None, **given})
    assert caught.value.where == ("limits", key)


def test_what_does_not_fit_a_robot_is_refused():
    panda = ikde.load_robot("panda")
    for given, key in (
        ({"speed": [1.0]}, "speed"),
        ({"max_distance_m": 1.0, "center": "Oc"}, "center"),
        ({"wheel_speed_rad_s": 1.0}, "wheel_speed_rad_s"),
    ):
        with pytest.raises(InputError) as caught:
            MotionLimits(**{"speed": None, **given}).check(panda)
        assert caught.value.where == ("limits", key)


def test_what_is_given_is_copied_and_kept():
    speed = np.ones(3)
    limits = MotionLimits(speed=speed)
    speed[0] = 2.0
    assert limits.speed.tolist() == [1.0, 1.0, 1.0]
    assert not limits.speed.flags.writeable


def test_a_joint_that_turns_without_end_has_the_speed_of_any_that_turns():
    robot = load_text(ENDLESS)
    np.testing.assert_allclose(MotionLimits.of(robot).speed, np.full(6, np.pi / 2))
