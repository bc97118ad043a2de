"""Figures are written the same everywhere."""

import numpy as np
import pytest

from ikde.report.numbers import (
    Units,
    angle,
    count_of,
    fixed,
    format_fixed,
    length,
    percent,
    seconds,
    significant,
    vector,
    with_interval,
)

MM_DEG = Units("mm", "deg")


@pytest.mark.parametrize(
    ("value", "digits", "text"), [(1481.1, 2, "1,481.10"), (-0.0001, 2, "0.00"), (9.3, 0, "9"), (-191.47, 1, "-191.5")]
)
def test_fixed_digits(value, digits, text):
    assert fixed(value, digits) == text


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [
        (0.001543, 3, "0.00154"),
        (83, 3, "83.0"),
        (1240, 3, "1,240"),
        (0.9999, 3, "1.00"),
        (0, 3, "0"),
        (1e-14, 2, "1.0e-14"),
        (-12.34, 3, "-12.3"),
    ],
)
def test_significant_digits(value, digits, text):
    assert significant(value, digits) == text


def test_percentages():
    assert percent(73.0) == "73.0 %"


def test_numbers_with_their_interval():
    assert with_interval(0.5, (-0.0001, 1481.1), 2) == "0.50 (0.00–1,481.10)"


def test_vectors():
    assert vector([540, 0, 569.2], 1) == "540.0, 0.0, 569.2"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (Units().format_length(0.0401), "0.0401 m"),
        (MM_DEG.format_length(0.0401), "40.1 mm"),
        (Units().format_error(7.4525e-6), "7.45e-06 m"),
        (MM_DEG.format_error(7.4525e-6), "0.00745 mm"),
        (Units().format_angle(np.pi), "3.14 rad"),
        (MM_DEG.format_angle(np.pi), "180 deg"),
        (format_fixed(-1e-9, 3), "0.000"),
        (format_fixed(2.5, 1), "2.5"),
    ],
)
def test_figures_are_written_with_their_unit(text, expected):
    assert text == expected


def test_a_joint_has_the_unit_of_its_kind(qiao):
    slide, turn = qiao.joints[0], qiao.joints[3]
    assert (MM_DEG.joint_unit(slide), MM_DEG.joint_unit(turn)) == ("mm", "deg")
    assert MM_DEG.joint_value(slide, 0.5) == pytest.approx(500)
    assert MM_DEG.joint_value(turn, np.pi / 2) == pytest.approx(90)
    assert Units().joint_value(turn, 0.25) == 0.25


@pytest.mark.parametrize(("number", "text"), [(0, "0 arms"), (1, "1 arm"), (1200, "1,200 arms")])
def test_one_is_no_plural(number, text):
    assert count_of(number, "arm") == text


@pytest.mark.parametrize(
    ("write", "value", "text"),
    [
        (seconds, 0.0, "0"),
        (seconds, 9.994e-10, "< 1 ns"),
        (seconds, 9.996e-10, "1 ns"),  # rounds to 1
        (seconds, 2.3e-8, "23 ns"),
        (seconds, 9.994e-7, "999 ns"),
        (seconds, 9.996e-7, "1 µs"),  # not 1,000 ns
        (seconds, 2.30e-5, "23 µs"),
        (seconds, 9.996e-4, "1 ms"),
        (seconds, 1.0, "1 s"),
        (seconds, 1250.0, "1,250 s"),
        (length, 5e-10, "< 1 nm"),
        (length, -5e-10, "< 1 nm"),
        (length, 5.1e-8, "51 nm"),
        (length, 7.9e-6, "7.9 µm"),
        (length, 9.996e-6, "0.01 mm"),
        (length, 5e-5, "0.05 mm"),
        (length, -1.5079e-3, "-1.51 mm"),
        (length, 9.99, "9,990 mm"),
        (length, 12.4, "12.4 m"),
        (angle, 0.0, "0"),
        (angle, 5e-10, "< 1 nrad"),
        (angle, 5.1e-8, "51 nrad"),
        (angle, 7.9e-6, "7.9 µrad"),
        (angle, np.radians(0.05), "0.05 deg"),
        (angle, np.radians(-120.0), "-120 deg"),
    ],
)
def test_units_follow_the_magnitude(write, value, text):
    assert write(value) == text
