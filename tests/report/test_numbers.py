"""Figures are written the same everywhere."""

import pytest

from ikde.report.numbers import fixed, percent, significant, vector, with_interval


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
