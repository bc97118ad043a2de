"""Bounds of one instant: their ends, where each comes from, and that a joint always stops in time."""

import numpy as np
import pytest

from ikde.io.robots import load_robot
from ikde.model.actuators import speeds_by
from ikde.track.limits import MotionLimits
from ikde.track.velocity_bounds import FREE, Motion, make_bounds


def bounds_of(robot, q, dt_s=0.01, before=None, **limits):
    motion = Motion(q, speeds_by(robot, q, "twist"), dt_s, before)
    return make_bounds(robot, MotionLimits.of(robot, **limits), motion)


def ends(named, name):
    row = named.names.index(name)
    return named.bounds.lower[row], named.bounds.upper[row], named.low[row], named.high[row]


def test_speed_range_and_acceleration():
    robot = load_robot("ur5")
    name, q = robot.joint_names[1], robot.home.copy()
    speed, upper = MotionLimits.of(robot).speed[1], robot.upper[1]
    assert ends(bounds_of(robot, q), name) == (-speed, speed, "speed", "speed")
    q[1] = upper - 1e-3
    assert ends(bounds_of(robot, q), name) == (-speed, pytest.approx(0.1), "speed", "range")
    assert ends(bounds_of(robot, q, ranges=False), name)[1] == speed
    q[1] = robot.home[1]
    found = bounds_of(robot, q, before=np.full(6, 0.5), acceleration=np.full(6, 10.0))
    assert ends(found, name) == (pytest.approx(0.4), pytest.approx(0.6), "acceleration", "acceleration")
    assert ends(bounds_of(robot, q, acceleration=np.full(6, 10.0)), name)[:2] == (-speed, speed)


def test_outside_its_range_a_joint_goes_no_farther_and_is_not_thrown_back():
    robot = load_robot("ur5")
    q = robot.upper + 0.1
    assert ends(bounds_of(robot, q), robot.joint_names[0])[1] == 0.0
    assert ends(bounds_of(robot, q), robot.joint_names[0])[0] < -1.0


def test_ranges_and_speeds_come_before_accelerations():
    robot = load_robot("ur5")
    q, before = robot.upper - 1e-9, np.full(6, 2.0)
    low, high, low_why, _ = ends(bounds_of(robot, q, before=before, acceleration=np.ones(6)), robot.joint_names[0])
    assert low == high == pytest.approx(1e-9 / 0.01, rel=0.1)
    assert low_why == "range"


@pytest.mark.parametrize("acceleration", [0.3, 2.0, 25.0])
def test_a_joint_driven_as_fast_as_it_may_stops_at_the_end(acceleration):
    robot = load_robot("ur5")
    limits = {"acceleration": np.full(6, acceleration), "speed": np.full(6, 1.0)}
    q, before, dt = robot.upper - 0.5 - 0.1 * np.arange(6), np.zeros(6), 0.02
    for _ in range(400):
        upper = bounds_of(robot, q, dt, before, **limits).bounds.upper
        assert (upper >= before - acceleration * dt - 1e-12).all()
        before, q = upper, q + upper * dt
    np.testing.assert_allclose(q, robot.upper, atol=1e-6)
    assert (q <= robot.upper + 1e-12).all()


def test_a_base_on_two_wheels_is_limited_along_its_heading():
    robot = load_robot("qiao2021")
    q = robot.home.copy()
    q[2] = 0.7
    named = bounds_of(robot, q, wheel_speed_rad_s=3.0)
    speed = MotionLimits.of(robot).speed
    assert ends(named, "base forward")[:2] == (-speed[:2].min(), speed[:2].min())
    row = named.names.index("base forward")
    np.testing.assert_allclose(named.bounds.rows[row], [1, 0, *np.zeros(6)], atol=1e-15)
    assert ends(named, "wheel_left")[:2] == (-3.0, 3.0)
    wheels = named.bounds.rows[[named.names.index(name) for name in ("wheel_left", "wheel_right")], :2]
    half, radius = robot.wheels.half_track_m, robot.wheels.radius_m
    np.testing.assert_allclose(wheels, np.array([[1, -half], [1, half]]) / radius, atol=1e-12)


def test_four_mecanum_wheels_have_a_row_each():
    robot = load_robot("ur5e_mecanum")
    q = robot.home.copy()
    q[2] = -1.1
    named = bounds_of(robot, q, wheel_speed_rad_s=5.0)
    rows = named.bounds.rows[[name.startswith("wheel") for name in named.names]][:, :3]
    reach = robot.wheels.half_track_m + robot.wheels.half_wheelbase_m
    expected = np.array([[1, -1, -reach], [1, 1, -reach], [1, -1, reach], [1, 1, reach]]) / robot.wheels.radius_m
    np.testing.assert_allclose(rows, expected, atol=1e-12)
    assert not [name for name in bounds_of(robot, q).names if name.startswith("wheel")]


def test_without_limits_there_are_no_bounds():
    robot = load_robot("ur5")
    named = bounds_of(robot, robot.home, speed=None, ranges=False)
    assert named.names == ()
    assert named.bounds.rows.shape == (0, 6)
    assert FREE > 1e5
