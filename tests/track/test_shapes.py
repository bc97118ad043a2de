"""Curves: where they start and end, what they keep, and what cannot be drawn."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import CubicSpline

from ikde.errors import InputError
from ikde.track.shapes import (
    Segment,
    ease,
    follow_points,
    follow_segments,
    make_arc,
    make_arc_through,
    make_line,
    make_spline,
)

few = settings(max_examples=50)
SHARE = np.linspace(0.0, 1.0, 41)
ORIGIN, X, Y, Z = np.zeros(3), *np.eye(3)


def test_a_line_is_even():
    np.testing.assert_allclose(make_line(X, Y)(np.array([0, 0.25, 1])), [X, [0.75, 0.25, 0], Y])
    np.testing.assert_array_equal(make_line(X, X)(SHARE), np.tile(X, (41, 1)))


def test_an_arc_turns_right_handed_and_may_turn_often():
    np.testing.assert_allclose(make_arc(X, ORIGIN, 5 * Z, np.pi / 2)(np.array([0, 1])), [X, Y], atol=1e-15)
    np.testing.assert_allclose(make_arc(X, ORIGIN, -Z, 4.5 * np.pi)(np.array([1.0])), [-Y], atol=1e-14)
    np.testing.assert_allclose(make_arc(X + Z, ORIGIN, Z, np.pi)(np.array([1.0])), [Z - X], atol=1e-15)


@few
@given(st.integers(0, 10**6))
def test_an_arc_through_three_points_goes_through_them_on_a_circle(seed):
    start, via, to = np.random.default_rng(seed).normal(size=(3, 3))
    p = make_arc_through(start, via, to)(np.linspace(0, 1, 20001))
    np.testing.assert_allclose(p[[0, -1]], [start, to], atol=1e-9)
    steps = np.linalg.norm(np.diff(p, axis=0), axis=1)
    np.testing.assert_allclose(steps, steps[0], rtol=1e-6)
    assert np.linalg.norm(p - via, axis=1).min() <= steps[0]


@few
@given(st.integers(0, 10**6), st.integers(2, 9))
def test_a_spline_is_the_natural_one_over_its_chords(seed, count):
    points = np.random.default_rng(seed).normal(size=(count, 3))
    knots = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    expected = CubicSpline(knots, points, bc_type="natural")(SHARE * knots[-1]) if count > 2 else None
    p = make_spline(points)(SHARE)
    np.testing.assert_allclose(p, make_line(*points)(SHARE) if expected is None else expected, atol=1e-12)


def test_between_points_in_a_row_there_are_straight_lines():
    p = follow_points(np.array([ORIGIN, X, X + 10 * Y]), np.array([0, 0.5, 1, 1.5, 2]))
    np.testing.assert_allclose(p, [ORIGIN, X / 2, X, X + 5 * Y, X + 10 * Y])


def test_a_chain_is_in_one_piece():
    chain = [
        Segment(curve=make_line(ORIGIN, X), samples=2),
        Segment(curve=make_arc(X, ORIGIN, Z, np.pi / 2), samples=4, smooth=True),
        Segment(curve=make_line(Y, ORIGIN), samples=1),
    ]
    p = follow_segments(chain, np.arange(0, 7.5, 0.5))
    np.testing.assert_allclose(
        p[[0, 2, 4, 8, 12, 14]], [ORIGIN, X / 2, X, [0.5**0.5, 0.5**0.5, 0], Y, ORIGIN], atol=1e-15
    )
    assert np.linalg.norm(p[5] - p[4]) < np.linalg.norm(p[8] - p[7]) / 10  # it starts from rest


def test_a_smooth_pace_rests_at_its_ends():
    np.testing.assert_allclose(ease(np.array([0.0, 0.5, 1.0])), [0, 0.5, 1])
    h = 1e-3
    for rest in (0.0, 1.0 - 2 * h):
        speeds = np.diff(ease(rest + h * np.arange(3))) / h
        assert np.abs(speeds).max() < 1e-4
    assert np.diff(ease(SHARE)).max() * 40 <= 15 / 8


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: make_arc(X, ORIGIN, ORIGIN, 1.0), "normal: a normal of length 0"),
        (lambda: make_arc(Z, ORIGIN, Z, 1.0), "center: the arc starts on its own axis"),
        (lambda: make_arc_through(ORIGIN, X, 2 * X), "via: start, via and to lie on one line"),
        (lambda: make_arc_through(ORIGIN, ORIGIN, X), "via: start, via and to lie on one line"),
        (lambda: make_arc_through(ORIGIN, X, ORIGIN), "via: start, via and to lie on one line"),
        (lambda: make_spline(np.array([ORIGIN, X, X])), "[2]: this point is the one before it"),
    ],
)
def test_what_cannot_be_drawn_is_refused(make, words):
    with pytest.raises(InputError) as caught:
        make()
    assert str(caught.value).startswith(words)
