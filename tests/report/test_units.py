"""Figures in the user's units."""

import numpy as np
import pytest

from ikde.report.units import Units, format_fixed

MM_DEG = Units("mm", "deg")


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
