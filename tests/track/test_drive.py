"""What is packed of a base, its wheels and the limits."""

from dataclasses import replace

import numpy as np
import pytest

import ikde
from ikde.model.robot import Wheels
from ikde.model.wheels import wheel_speeds
from ikde.track.drive import implied_wheel_speed, pack_drive
from ikde.track.limits import MotionLimits


def test_what_is_packed(qiao):
    limits = MotionLimits.of(
        qiao, acceleration=np.full(9, 10.0), wheel_speed_rad_s=4.0, max_distance_m=1.2, center="Oc"
    )
    drive = pack_drive(qiao, "differential", limits, 0.02, frozen=("q6",))
    assert drive.base.tolist() == [0, 1, 2]
    assert drive.others.tolist() == [3, 4, 5, 6, 7, 8]
    np.testing.assert_allclose(drive.largest, [0.01] + 6 * [0.01 * np.pi] + [0.0])
    np.testing.assert_allclose(drive.change, [0.4] + 6 * [0.004 / (0.01 * np.pi)] + [np.inf])
    assert (drive.wheel_travel, drive.max_distance, drive.centre_body) == (4.0 * 0.1 * 0.02, 1.2, 3)
    assert drive.half_track == 0.259
    np.testing.assert_allclose(drive.p_body_centre, [0.34, 0.0, 0.119])


def test_wheels_are_the_robots(qiao, unwheeled):
    own = replace(qiao, wheels=Wheels(radius_m=0.05, half_track_m=0.4))
    limits = MotionLimits.of(own, wheel_speed_rad_s=4.0)
    drive = pack_drive(own, "differential", limits, 0.02)
    assert (drive.half_track, drive.wheel_travel) == (0.4, 4.0 * 0.05 * 0.02)
    none = pack_drive(unwheeled, "differential", MotionLimits.of(unwheeled), 0.02)
    assert (none.base.tolist(), none.wheel_travel) == ([0, 1, 2], np.inf)


def test_a_base_with_wheels_keeps_to_the_lower_of_two_speeds(qiao):
    speed = np.array([0.5, 0.2, *np.ones(7)])
    assert pack_drive(qiao, "differential", MotionLimits(speed=speed), 0.1).largest[0] == pytest.approx(0.02)
    largest = pack_drive(qiao, "omnidirectional", MotionLimits(speed=speed), 0.1).largest
    np.testing.assert_allclose(largest, 0.1 * speed)


def test_without_speed_limits_a_step_is_large_not_endless(qiao):
    for speed in (None, np.full(9, np.inf)):
        largest = pack_drive(qiao, "omnidirectional", MotionLimits(speed=speed), 0.02).largest
        assert ((largest > 0.2) & (largest < 2.0)).all()


def test_an_arm_without_base_moves_joint_by_joint():
    panda = ikde.load_robot("panda")
    drive = pack_drive(panda, "omnidirectional", MotionLimits.of(panda), 0.01)
    assert drive.base.tolist() == [-1, -1, -1]
    assert len(drive.largest) == len(panda.joints)


def test_long_samples_have_short_steps(qiao):
    drive = pack_drive(qiao, "omnidirectional", MotionLimits.of(qiao), dt_s=10.0)
    np.testing.assert_array_equal(drive.largest, [0.5, 0.5, *[0.5 * np.pi] * 7])


def test_speed_limits_imply_a_wheel_speed():
    wheels = Wheels(radius_m=0.08, half_track_m=0.3)
    fastest = wheel_speeds(wheels, np.array(0.4), np.array(1.0))[1]
    assert implied_wheel_speed(wheels, np.array([0.5, 0.4, 1.0]), np.arange(3)) == pytest.approx(fastest)
