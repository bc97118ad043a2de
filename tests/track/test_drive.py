"""Bases: arcs and twists are each other's inverse, wheels, and what is packed."""

from dataclasses import replace

import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from ikde.model.robot import Wheels
from ikde.track.drive import (
    base_twist,
    find_wheels,
    implied_wheel_speed,
    pack_drive,
    step_base,
    wheel_speeds,
)
from ikde.track.follow_path import base_joints
from ikde.track.limits import MotionLimits


def test_a_twist_is_what_an_arc_was_driven_with(rng):
    start = rng.uniform(-1, 1, (200, 3))
    v, omega = rng.uniform(-1, 1, 200), rng.uniform(-3, 3, 200)
    omega[:3] = 0.0, 1e-9, -1e-5
    end = step_base(start, v, omega, 0.3)
    found = base_twist(start, end, 0.3)
    np.testing.assert_allclose(found[0], v, atol=1e-12)
    np.testing.assert_allclose(found[1], omega, atol=1e-12)
    np.testing.assert_allclose(found[2], 0.0, atol=1e-14)


def test_half_an_arc_twice_is_the_arc(rng):
    start, v, omega = rng.uniform(-1, 1, 3), np.array(0.7), np.array(-2.0)
    once = step_base(start, v, omega, 0.4)
    np.testing.assert_allclose(step_base(step_base(start, v, omega, 0.2), v, omega, 0.2), once, atol=1e-15)


def test_a_quarter_turn():
    end = step_base(np.zeros(3), np.array(0.5 * np.pi), np.array(0.5 * np.pi), 1.0)
    np.testing.assert_allclose(end, [1.0, 1.0, 0.5 * np.pi], atol=1e-15)


def test_sliding_sideways_is_told():
    residual = base_twist(np.array([0, 0, 0.3]), np.array([-np.sin(0.3), np.cos(0.3), 0.3]), 0.5)[2]
    assert residual == pytest.approx(2.0)


def test_wheels():
    wheels = Wheels(radius_m=0.08, half_track_m=0.3)
    left, right = wheel_speeds(wheels, np.array(0.3), np.array(0.5))
    assert left == pytest.approx((0.3 - 0.3 * 0.5) / 0.08)
    assert right == pytest.approx((0.3 + 0.3 * 0.5) / 0.08)
    fastest = wheel_speeds(wheels, np.array(0.4), np.array(1.0))[1]
    assert implied_wheel_speed(wheels, np.array([0.5, 0.4, 1.0]), np.arange(3)) == pytest.approx(fastest)


def test_what_is_packed(qiao):
    limits = MotionLimits.of(qiao, acceleration=np.full(9, 10.0), wheel_speed_rad_s=4.0, farthest_m=1.2, center="Oc")
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


def test_what_is_refused(qiao):
    with pytest.raises(InputError, match="no base that drives"):
        find_wheels(ikde.load_robot("panda"), "differential")
    with pytest.raises(InputError, match="expected one of differential, omnidirectional"):
        find_wheels(qiao, "tracked")


def test_a_base_stays_one_with_narrow_ranges(qiao):
    joints = tuple(replace(joint, lower=-0.5, upper=0.5) if joint.name == "q_z" else joint for joint in qiao.joints)
    narrow = replace(qiao, joints=joints)
    assert find_wheels(narrow, "differential").tolist() == [0, 1, 2]
    assert base_joints(narrow) == ("d_x", "d_y", "q_z")


def test_long_samples_have_short_steps(qiao):
    drive = pack_drive(qiao, "omnidirectional", MotionLimits.of(qiao), dt_s=10.0)
    np.testing.assert_array_equal(drive.largest, [0.5, 0.5, *[0.5 * np.pi] * 7])
