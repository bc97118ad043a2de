"""Figures are written the same everywhere."""

import numpy as np
import pytest

from ikde.report.numbers import Units, count_of, fixed, format_fixed, percent, significant, vector, with_interval

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
