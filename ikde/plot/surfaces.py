"""A function of two variables as filled level lines, with marked places, in the house style."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.plot.images import INK
from ikde.plot.style import COLORS, DASHES, MARKERS, Axis, drawing, pick

LEVELS, SQUARE_IN = 10, 4.3
LINE_PT, MARK_PT = 0.4, 9.0
COLORMAP = "cividis"  # as much lighter a level, for all eyes and in print
ZERO_COLOR, ZERO_PT, ZERO_DASH = COLORS[1], 2.2, DASHES[1]
QUARTER_DEG = 90.0
MARK_EDGE, MARK_FACE = "#000000", "#ffffff"  # seen on every level, whatever the paper


@dataclass(frozen=True, slots=True, kw_only=True)
class Mark:
    """Places [n, 2] on a surface that share a mark."""

    label: str
    places: Sequence[tuple[float, float]]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Zero:
    """The line on which another function is 0."""

    label: str
    values: Floats
    """[rows, columns], as those of the surface."""


def plot_surface(
    x: Axis, y: Axis, values: Floats, *, bar: Axis, marks: Sequence[Mark] = (), zero: Zero | None = None
) -> Any:
    """`values` [rows, columns] over the axes' limits, both ends included: the first variable down the rows is y.

    Levels are equal steps from 0 to the largest value; an axis in deg is marked at quarters of a turn.
    Raises ValueError for an axis without limits.
    """
    from matplotlib.ticker import MultipleLocator

    rows, columns = values.shape
    with drawing(x, y, height_in=SQUARE_IN, grid="both") as (figure, axes):
        grid_x, grid_y = np.linspace(*_ends(x), columns), np.linspace(*_ends(y), rows)
        levels = np.linspace(0.0, float(values.max()), LEVELS + 1)
        filled = axes.contourf(grid_x, grid_y, values, levels=levels, cmap=COLORMAP)
        axes.contour(grid_x, grid_y, values, levels=levels, colors=INK, linewidths=LINE_PT, alpha=0.5)
        if zero is not None:
            look = {"colors": ZERO_COLOR, "linewidths": ZERO_PT, "linestyles": [ZERO_DASH]}
            axes.contour(grid_x, grid_y, zero.values, levels=[0.0], **look)
            axes.plot([], [], color=ZERO_COLOR, linewidth=ZERO_PT, linestyle=ZERO_DASH, label=zero.label)
        for number, mark in enumerate(marks):
            look = {"marker": pick(MARKERS, number), "markersize": MARK_PT, "markeredgewidth": 1.3, "clip_on": False}
            colors = {"color": MARK_FACE, "markeredgecolor": MARK_EDGE}
            axes.plot(*zip(*mark.places, strict=True), label=mark.label, linestyle="none", **colors, **look)
        axes.set_aspect("equal")
        for ticks, axis in ((axes.xaxis, x), (axes.yaxis, y)):
            if axis.unit == "deg":
                ticks.set_major_locator(MultipleLocator(QUARTER_DEG))
        shown = figure.colorbar(filled, ax=axes, label=bar.title, shrink=0.85, ticks=levels[::2])
        shown.ax.tick_params(colors=INK, length=3.5)
        shown.outline.set_edgecolor(INK)
    return figure


def _ends(axis: Axis) -> tuple[float, float]:
    low, high = axis.limits
    if low is None or high is None:
        raise ValueError(f"{axis.label} has no limits")
    return low, high
