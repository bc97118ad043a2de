"""Whole turns are taken as far as the range allows, and nothing else is touched."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ikde.kernels.turns import TURN, unwind, unwind_rows

angles = st.floats(-40.0, 40.0)


def unwound(q, lower, upper, centre=0.0, is_revolute=1):
    values = np.array([q], dtype=float)
    unwind(np.array([lower]), np.array([upper]), np.array([is_revolute]), np.array([centre]), values)
    return float(values[0])


@given(q=angles, centre=angles, below=st.floats(0.0, 30.0), above=st.floats(0.0, 30.0))
def test_no_full_turn_inside_the_range_is_nearer_than_what_comes_out(q, centre, below, above):
    lower, upper = q - below, q + above
    value = unwound(q, lower, upper, centre)
    others = [value + turns * TURN for turns in range(-20, 21) if turns]
    nearest = min((abs(v - centre) for v in others if lower + 1e-9 <= v <= upper - 1e-9), default=np.inf)
    assert lower <= value <= upper
    assert abs(value - centre) <= nearest + 1e-9
    turns = round((value - q) / TURN)
    assert abs(q + turns * TURN - value) < 1e-13
    assert unwound(value, lower, upper, centre) == value


@given(q=angles, away=st.floats(-np.pi, np.pi))
def test_what_is_within_half_a_turn_stays_to_the_bit(q, away):
    assert unwound(q, -np.inf, np.inf, q - away) == q or abs(q - (q - away)) > np.pi  # rounding of q - away


def test_a_turn_ends_inside_the_range_or_is_not_made():
    assert unwound(6.0, -1.0, 7.0) == 6.0 - TURN
    assert unwound(6.0, -0.1, 7.0) == 6.0
    assert unwound(-6.0, -7.0, 1.0) == -6.0 + TURN
    assert unwound(-6.0, -7.0, 0.1) == -6.0
    assert unwound(TURN, 0.0, TURN) == 0.0
    assert unwound(20.0, 5.0, 21.0) == 20.0 - 2.0 * TURN  # three would be nearest


def test_between_one_turn_and_several_each_is_the_number_that_is_nearest():
    for half_turns, turns in ((2.95, 1), (3.05, 2)):
        for sign in (1.0, -1.0):
            value = sign * half_turns * np.pi
            assert unwound(value, -20.0, 20.0) == pytest.approx(value - sign * turns * TURN, abs=1e-14)


def test_a_joint_without_limits_comes_all_the_way():
    assert unwound(1000.0, -np.inf, np.inf) == 1000.0 - 159.0 * TURN
    assert unwound(-1000.0, -np.inf, np.inf, centre=-999.0) == -1000.0


def test_a_slide_and_what_is_no_number_stay():
    assert unwound(6.0, -10.0, 10.0, is_revolute=0) == 6.0
    assert np.isnan(unwound(np.nan, -10.0, 10.0))
    q = np.array([50.0, np.nan, 50.0])
    unwind(np.full(3, -99.0), np.full(3, 99.0), np.array([0, 1, 1]), np.zeros(3), q)
    np.testing.assert_array_equal(q, [50.0, np.nan, 50.0 - 8.0 * TURN])


def test_rounding_costs_a_turn_at_most_never_the_range():
    lower = np.nextafter(7.0 - TURN, np.inf)  # the turn ends one digit below
    assert unwound(7.0, lower, 8.0) == 7.0
    assert lower <= unwound(7.0 + TURN, lower, 20.0) <= 7.0


def test_where_rounding_leaves_two_turns_equally_far_the_joint_stays():
    value = 9216.0 + np.pi
    while value - 9216.0 <= np.pi:
        value = float(np.nextafter(value, np.inf))
    assert (value - TURN) - 9216.0 == -(value - 9216.0)
    assert unwound(value, -np.inf, np.inf, centre=9216.0) == value


def test_rows_are_unwound_like_one(rng):
    Q, centre = rng.uniform(-20.0, 20.0, (50, 4)), rng.uniform(-3.0, 3.0, 4)
    lower, upper, is_revolute = (
        np.array([-9.0, -np.inf, -7.0, -20.0]),
        np.array([9.0, np.inf, 2.0, 20.0]),
        np.arange(4) % 3,
    )
    rows = Q.copy()
    unwind_rows(lower, upper, is_revolute, centre, rows)
    for row in Q:
        unwind(lower, upper, is_revolute, centre, row)
    np.testing.assert_array_equal(rows, Q)
