"""Wheels and twist are each other's inverse; mecanum wheels roll as their rollers let them; slip there and back."""

import numpy as np
import pytest

from ikde.errors import InputError
from ikde.model.robot import Wheels
from ikde.model.wheels import (
    DIFFERENTIAL,
    MECANUM,
    ground_speed,
    slip_ratio,
    twist_by_wheels,
    wheel_names,
    wheel_speeds,
    wheels_by_twist,
)

TWO = Wheels(radius_m=0.08, half_track_m=0.3)
FOUR = Wheels(radius_m=0.0825, half_track_m=0.24, half_wheelbase_m=0.36)


@pytest.mark.parametrize(("wheels", "count"), [(TWO, 2), (FOUR, 4)])
def test_one_is_the_pseudo_inverse_of_the_other(wheels, count):
    inverse, forward = wheels_by_twist(wheels), twist_by_wheels(wheels)
    assert (inverse.shape, forward.shape, len(wheel_names(wheels))) == ((count, 3), (3, count), count)
    np.testing.assert_allclose(forward, np.linalg.pinv(inverse), rtol=0, atol=1e-15)
    kept = np.eye(3) if count == 4 else np.diag([1.0, 0.0, 1.0])  # two wheels do not move to the left
    np.testing.assert_allclose(forward @ inverse, kept, rtol=0, atol=1e-15)


def test_two_wheels_are_those_that_tracks_are_graded_by(rng):
    assert wheel_names(TWO) == DIFFERENTIAL
    v, omega = rng.uniform(-1, 1, (2, 20))
    twist = np.stack([v, rng.uniform(-1, 1, 20), omega], axis=-1)
    np.testing.assert_allclose(twist @ wheels_by_twist(TWO).T, wheel_speeds(TWO, v, omega), rtol=0, atol=1e-14)


def test_a_driven_wheel_rolls_without_slipping():
    left, right = wheel_speeds(TWO, np.array(0.3), np.array(0.5))
    assert left == pytest.approx((0.3 - 0.3 * 0.5) / 0.08)
    assert right == pytest.approx((0.3 + 0.3 * 0.5) / 0.08)


def test_a_mecanum_wheel_drives_along_its_roller_alone(rng):
    """The point of contact moves along the free direction of the roller: derived from the geometry, not from (1)."""
    places = np.array([[0.36, 0.24], [-0.36, 0.24], [-0.36, -0.24], [0.36, -0.24]])
    assert MECANUM[0] == "wheel_front_left"
    for vx, vy, omega in rng.uniform(-1, 1, (10, 3)):
        speeds = wheels_by_twist(FOUR) @ [vx, vy, omega]
        for (x, y), speed in zip(places, speeds, strict=True):
            hub = np.array([vx - omega * y, vy + omega * x])
            roller = np.array([1.0, -np.sign(x * y)])  # axis of the roller on the floor: what it cannot roll along
            assert roller @ (hub - [speed * FOUR.radius_m, 0.0]) == pytest.approx(0.0, abs=1e-14)


def test_the_signs_that_the_print_lost():
    """[Zhang2022, eq. 1]: A front left, B rear left, C rear right, D front right, W and L half of the sizes."""
    speeds = wheels_by_twist(FOUR) * FOUR.radius_m
    np.testing.assert_allclose(speeds, [[1, -1, -0.6], [1, 1, -0.6], [1, -1, 0.6], [1, 1, 0.6]], atol=1e-15)
    np.testing.assert_allclose(twist_by_wheels(FOUR) @ [1.0, -1.0, -1.0, 1.0], 0.0, atol=1e-17)


def test_slip_and_back(rng):
    rim, ground = rng.uniform(0.01, 2.0, (2, 200))
    slip = slip_ratio(rim, ground)
    assert np.all(np.abs(slip) < 1.0)
    assert np.all((slip > 0.0) == (rim > ground))
    np.testing.assert_allclose(ground_speed(rim, slip), ground, rtol=1e-12)
    np.testing.assert_allclose(ground_speed(-rim, slip_ratio(-rim, -ground)), -ground, rtol=1e-12)


def test_slip_at_its_ends():
    assert slip_ratio([0.0, 1.0, 0.0], [0.0, 0.0, 1.0]).tolist() == [0.0, 1.0, -1.0]
    assert ground_speed(1.0, 0.8) == pytest.approx(0.2)  # not the 1.8 of a factor 1 + s
    assert ground_speed(1.0, -0.5) == pytest.approx(2.0)
    with pytest.raises(InputError, match="expected the rim of a wheel and the ground to run the same way"):
        slip_ratio(1.0, -1.0)
    for wrong in (-1.0, 1.1, np.nan):
        with pytest.raises(InputError, match="expected a slip above -1, up to 1"):
            ground_speed(1.0, wrong)


def test_equal_slip_on_four_wheels_scales_the_twist(rng):
    twist = rng.uniform(-1, 1, 3)
    rim = wheels_by_twist(FOUR) @ twist * FOUR.radius_m
    slipping = twist_by_wheels(FOUR) @ ground_speed(rim, 0.8) / FOUR.radius_m
    np.testing.assert_allclose(slipping, 0.2 * twist, rtol=1e-12)
