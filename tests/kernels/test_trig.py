"""Sine, cosine and arc tangent against extended precision."""

import math

import numba
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from ikde.kernels.trig import angle_from_sides, full_angle, sin_cos

few = settings(max_examples=300)
needs_long_double = pytest.mark.skipif(np.finfo(np.longdouble).nmant < 63, reason="needs extended precision")


@numba.njit
def sin_cos_of_all(x):
    out = np.empty((2, x.size))
    for k in range(x.size):
        out[0, k], out[1, k] = sin_cos(x[k])
    return out


@numba.njit
def angles_of_all(opposite, adjacent):
    out = np.empty(opposite.size)
    for k in range(out.size):
        out[k] = angle_from_sides(opposite[k], adjacent[k])
    return out


def largest_error(x):
    """Largest absolute error of sine and of cosine."""
    exact = np.array([np.sin(x.astype(np.longdouble)), np.cos(x.astype(np.longdouble))])
    return np.abs(sin_cos_of_all(x) - exact).max()


@needs_long_double
@pytest.mark.parametrize("limit", [0.1, math.pi / 4, math.pi, 100.0, 1e5])
def test_sine_and_cosine_are_within_1_7e_16(limit, rng):
    assert largest_error(rng.uniform(-limit, limit, 200_000)) < 1.7e-16


@needs_long_double
def test_sine_and_cosine_are_within_1_7e_16_around_the_quarter_turns(rng):
    quarters = rng.integers(-60_000, 60_000, 100_000) * (math.pi / 4)
    assert (
        largest_error(quarters + rng.normal(size=quarters.size) * 10.0 ** rng.uniform(-16, -1, quarters.size)) < 1.7e-16
    )


@few
@given(x=st.floats(-1e5, 1e5))
@example(0.0)
@example(math.pi / 2)
@example(1e5)
def test_squares_add_up_to_one(x):
    s, c = sin_cos(x)
    assert abs(s * s + c * c - 1.0) <= 3e-16


@few
@given(x=st.floats(-1e5, 1e5))
def test_sine_is_odd_and_cosine_is_even(x):
    s, c = sin_cos(x)
    assert sin_cos(-x) == (-s, c)


def test_zero_is_exact():
    assert sin_cos(0.0) == (0.0, 1.0)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_the_sine_of_no_number_is_no_number(value):
    if numba.config.DISABLE_JIT:
        pytest.skip("Python's integers refuse NaN")
    assert all(math.isnan(part) for part in sin_cos(value))


SIDES = [
    (0.0, 1.0), (0.0, -1.0), (1.0, 0.0), (1.0, 1.0), (1.0, -1.0), (1e-300, 1.0), (1e-300, -1.0), (1e-8, 1.0),
    (1e-8, -1.0), (1e-16, -1.0), (1.0, 1e-16), (1.0, -1e-16), (3.0, 4.0), (1.0, math.tan(math.pi / 8)),
    (math.tan(math.pi / 8), 1.0), (math.tan(math.pi / 8), -1.0), (2.0, 1e300),
]  # fmt: skip


@pytest.mark.parametrize(("opposite", "adjacent"), SIDES)
def test_the_angle_of_edge_cases_is_atan2s(opposite, adjacent):
    assert angle_from_sides(opposite, adjacent) == pytest.approx(math.atan2(opposite, adjacent), rel=3e-16, abs=3e-16)


def test_the_angle_of_no_sides_is_zero():
    assert angle_from_sides(0.0, 0.0) == 0.0


@pytest.mark.parametrize(
    ("opposite", "adjacent", "angle"), [(0.0, 2.0, 0.0), (0.0, -2.0, math.pi), (3.0, 0.0, math.pi / 2)]
)
def test_zero_a_right_angle_and_pi_are_exact(opposite, adjacent, angle):
    assert angle_from_sides(opposite, adjacent) == angle


def angle_error(opposite, adjacent):
    exact = np.arctan2(opposite.astype(np.longdouble), adjacent.astype(np.longdouble))
    return np.abs(angles_of_all(opposite, adjacent) - exact)


@needs_long_double
def test_the_angle_is_within_5e_16_and_below_a_right_angle_within_3e_16(rng):
    angle, length = rng.uniform(0, math.pi, 200_000), 10.0 ** rng.uniform(-3, 3, 200_000)
    error = angle_error(length * np.sin(angle), length * np.cos(angle))
    assert error.max() < 5e-16  # of pi, one unit in the last place is 4.4e-16
    assert error[angle < 1.57].max() < 3e-16


@needs_long_double
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_angle_keeps_its_digits_near_zero_and_is_within_4e_16_near_pi(sign, rng):
    opposite = 10.0 ** rng.uniform(-18, -2, 100_000)
    error = angle_error(opposite, np.full(opposite.size, sign))
    assert error.max() < 4e-16
    if sign > 0:
        assert (error / opposite).max() < 3e-16


@numba.njit
def full_angles_of_all(opposite, adjacent):
    out = np.empty(opposite.size)
    for k in range(out.size):
        out[k] = full_angle(opposite[k], adjacent[k])
    return out


@pytest.mark.parametrize(("opposite", "adjacent"), [*SIDES, *((-opposite, adjacent) for opposite, adjacent in SIDES)])
def test_the_full_angle_of_edge_cases_is_atan2s(opposite, adjacent):
    assert full_angle(opposite, adjacent) == pytest.approx(math.atan2(opposite, adjacent), rel=3e-16, abs=3e-16)


def test_the_full_angle_knows_its_side_of_zero():
    assert full_angle(0.0, 0.0) == 0.0
    assert full_angle(0.0, -1.0) == math.pi
    assert full_angle(-0.0, -1.0) == -math.pi
    assert full_angle(-2.0, 0.0) == -math.pi / 2


@pytest.mark.parametrize("sides", [(math.nan, 1.0), (1.0, math.nan), (math.nan, math.nan)])
def test_the_full_angle_of_no_sides_is_no_number(sides):
    assert math.isnan(full_angle(*sides))


@needs_long_double
def test_the_full_angle_is_within_5e_16(rng):
    angle, length = rng.uniform(-math.pi, math.pi, 200_000), 10.0 ** rng.uniform(-3, 3, 200_000)
    opposite, adjacent = length * np.sin(angle), length * np.cos(angle)
    exact = np.arctan2(opposite.astype(np.longdouble), adjacent.astype(np.longdouble))
    assert np.abs(full_angles_of_all(opposite, adjacent) - exact).max() < 5e-16
