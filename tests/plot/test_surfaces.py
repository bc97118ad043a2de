"""A function of two variables: where its axes run, what is marked, and which line is 0."""

import numpy as np
import pytest

from ikde.plot.style import Axis
from ikde.plot.surfaces import LEVELS, Mark, Zero, plot_surface

X, Y = (Axis(label=name, unit="deg", limits=(0.0, 360.0)) for name in ("across", "up"))
BAR = Axis(label="height", unit="m")
VALUES = np.add.outer(np.linspace(0.0, 1.0, 5), np.zeros(9))  # grows down the rows, which is up


def test_rows_are_y_and_levels_run_from_0_to_the_largest():
    axes, bar = plot_surface(X, Y, VALUES, bar=BAR).axes
    assert (axes.get_xlabel(), axes.get_ylabel(), bar.get_ylabel()) == ("across [deg]", "up [deg]", "height [m]")
    assert (axes.get_xlim(), axes.get_ylim()) == ((0.0, 360.0), (0.0, 360.0))
    filled = axes.collections[0]
    np.testing.assert_allclose(filled.levels, np.linspace(0.0, 1.0, LEVELS + 1))
    highest = filled.get_paths()[-1].vertices
    assert highest[:, 1].min() >= 360.0 * (LEVELS - 1) / LEVELS - 1e-9
    assert np.ptp(highest[:, 0]) == 360.0


def test_degrees_are_marked_at_quarters():
    axes = plot_surface(X, Y, VALUES, bar=BAR).axes[0]
    for ticks in (axes.get_xticks(), axes.get_yticks()):
        assert {0.0, 90.0, 180.0, 270.0, 360.0} <= set(ticks)


def test_marks_and_the_zero_line_stand_where_they_are_and_in_the_legend():
    zero = Zero(label="level", values=VALUES - 0.25)
    figure = plot_surface(
        X, Y, VALUES, bar=BAR, marks=[Mark(label="here", places=[(90.0, 45.0), (10.0, 20.0)])], zero=zero
    )
    axes = figure.axes[0]
    (mark,) = [line for line in axes.lines if line.get_label() == "here"]
    assert mark.get_xydata().tolist() == [[90.0, 45.0], [10.0, 20.0]]
    line = axes.collections[2].get_paths()[0].vertices
    np.testing.assert_allclose(line[:, 1], 90.0)
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["level", "here"]


def test_an_axis_without_limits_is_refused():
    with pytest.raises(ValueError, match="across has no limits"):
        plot_surface(Axis(label="across"), Y, VALUES, bar=BAR)
