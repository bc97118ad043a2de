"""Dong and Zhao's figures, drawn again: each with its caption, its units and its legend."""

import numpy as np
import pytest

from ikde.paper import manipulability_figures
from ikde.paper.manipulability_figures import DRAWN_STEP_DEG, draw_manipulability, name_angles
from ikde.report.page import Details, Gallery, Text


@pytest.fixture
def blocks(results, inputs):
    return draw_manipulability(results.sections["manipulability"], inputs)


def test_there_are_all_figures_and_nothing_is_compared(blocks):
    text, singular, along, pairs, uniform = blocks
    assert isinstance(text, Text)
    assert "nothing to compare them with" in text.markup
    assert [len(block.figures) for block in (singular, along, pairs) if isinstance(block, Gallery)] == [2, 3, 6]
    assert [figure.caption.split(",")[0] for figure in pairs.figures] == [f"Figure {k}" for k in (3, 3, 4, 4, 5, 5)]
    assert isinstance(uniform, Details)
    for words in ("θ2", "θ3", "θ4", "angle [deg]", "w2, lengths in m", "as printed", "rigid"):
        assert words in uniform.blocks[0].image
    for figure, name in zip(along.figures, ("θ4", "θ3", "θ2"), strict=True):
        for words in (f"{name} [deg]", "largest w2, share", "peak by the text"):
            assert words in figure.image


def test_a_surface_has_its_axes_and_marks(results, inputs, substitute):
    data, drawn = results.sections["manipulability"], []
    blank = manipulability_figures.plot_surface
    substitute(blank, lambda *args, **more: drawn.append((*args, more)) or blank())
    draw_manipulability(data, inputs)
    assert len(drawn) == 8
    for x, y, values, more in drawn:
        assert (x.limits, y.limits, x.unit) == ((0.0, 360.0), (0.0, 360.0), "deg")
        assert values.max() == 1.0
        np.testing.assert_allclose(values[-1], values[0], atol=1e-12)
        np.testing.assert_allclose(values[:, -1], values[:, 0], atol=1e-12)
        assert more["bar"].label in ("w1 / its largest", "w2 / its largest")
    for (x, y, values, more), row in zip(drawn[2:], data.optima, strict=True):
        assert [y.label, x.label] == name_angles(row.pair).split(", ")
        largest, printed = more["marks"]
        assert (*largest.places, *printed.places) == (tuple(row.top_deg[::-1]), tuple(row.undone_deg[::-1]))
        up, across = (round(angle / DRAWN_STEP_DEG) for angle in row.top_deg)
        assert values[up, across] > 0.97


def test_zero_runs_through_what_is_listed_without_an_offset_alone(results, inputs, substitute):
    drawn, blank = [], manipulability_figures.plot_surface
    substitute(blank, lambda *args, **more: drawn.append(more) or blank())
    draw_manipulability(results.sections["manipulability"], inputs)
    for more, away_m in zip(drawn[:2], (0.0, 0.1), strict=True):
        ((mark,), zero) = more["marks"], more["zero"]
        for across, up in mark.places:
            assert zero.values[round(up / DRAWN_STEP_DEG), round(across / DRAWN_STEP_DEG)] == pytest.approx(away_m)


def test_angles_by_their_letters():
    assert name_angles(["theta2", "theta4"]) == "θ2, θ4"
