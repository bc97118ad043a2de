"""Several charts over one x: plain numbers in, a matplotlib `Figure` out."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ikde.plot.charts import Line
from ikde.plot.images import INK
from ikde.plot.style import COLORS, DASHES, Axis, drawing_panels, pick

PANEL_IN = 1.75  # height of a row
TITLE_PT = 9.5
BOUND = (0, (6, 2))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Panel:
    """One chart: curves, and horizontal lines that they should stay between."""

    y: Axis
    lines: Sequence[Line]
    bounds: Sequence[float] = ()
    bound: str = "limit"
    """What the legend calls the bounds."""
    marks: Sequence[float] = ()
    """Places on x where something is wrong: small triangles on the lower edge."""
    mark: str = "collision"
    title: str = ""
    """What stands above the chart, where its y axis has no room for it."""
    least: float = 0.0
    """The smallest span of the y axis, so that rounding is no mountain."""


def plot_panels(panels: Sequence[Panel], *, x: Axis, columns: int = 1, height_in: float = PANEL_IN) -> Any:
    """Charts row by row; curves of one label share their look and one entry in the legend, one without has none."""
    labels = list(dict.fromkeys(line.label for panel in panels for line in panel.lines if line.label))
    with drawing_panels(x, [panel.y for panel in panels], columns=columns, height_in=height_in) as (figure, charts):
        for axes, panel in zip(charts, panels, strict=True):
            for line in panel.lines:
                k = labels.index(line.label) if line.label else 0
                look = {"color": pick(COLORS, k), "linestyle": pick(DASHES, k), "linewidth": 1.6}
                axes.plot(line.x, line.y, label=line.label or "_nolegend_", **look)
            for number, value in enumerate(panel.bounds):
                label = "_nolegend_" if number else panel.bound
                axes.axhline(value, color=INK, linewidth=0.9, linestyle=BOUND, label=label)
            if len(panel.marks):
                _draw_marks(axes, panel)
            if panel.title:
                axes.set_title(panel.title, loc="left", fontsize=TITLE_PT, color=INK)
            _widen(axes, panel.least)
        figure.align_ylabels()
    return figure


def _widen(axes: Any, least: float) -> None:
    """Let the y axis span at least so much, with what it shows in its middle."""
    low, high = axes.get_ylim()
    if high - low < least:
        middle = 0.5 * (low + high)
        axes.set_ylim(middle - 0.5 * least, middle + 0.5 * least)


def _draw_marks(axes: Any, panel: Panel) -> None:
    look = {"marker": "^", "markersize": 5, "color": INK, "linestyle": "none", "clip_on": False, "zorder": 5}
    edge = axes.get_xaxis_transform()
    axes.plot(panel.marks, [0.0] * len(panel.marks), transform=edge, label=panel.mark, **look)
