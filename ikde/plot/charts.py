"""Charts in the house style: plain numbers in, a matplotlib `Figure` out."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ikde.errors import printable
from ikde.kernels.arrays import Floats
from ikde.plot.images import INK
from ikde.plot.style import COLORS, DASHES, HATCHES, MARKERS, Axis, drawing, drawing_panels, legend_name, pick

MAX_POINTS = 500  # of a curve: more cannot be seen
SHARE = "%"
PANEL_IN = 1.75  # height of a row of panels
TITLE_PT = 9.5
BOUND = (0, (6, 2))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Line:
    """A curve through (x, y)."""

    label: str
    x: ArrayLike
    y: ArrayLike


@dataclass(frozen=True, slots=True, kw_only=True)
class Event:
    """Something that happens at `x`: a vertical line in the colour of the curve that it belongs to."""

    label: str
    x: float
    line: str = ""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Bars:
    """One bar in every group; intervals and published values are optional, nan where there is none."""

    label: str
    values: Sequence[float]
    lower: Sequence[float] = ()
    upper: Sequence[float] = ()
    published: Sequence[float] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Estimate:
    """A value with its interval."""

    label: str
    value: float
    lower: float
    upper: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sample:
    """Measured values; of `total` cases, where some have none (default: every case has one)."""

    label: str
    values: ArrayLike
    total: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Panel:
    """One chart: curves, and horizontal lines that they should stay between."""

    y: Axis
    lines: Sequence[Line]
    bounds: Sequence[float] | Floats = ()
    bound: str = "limit"
    """What the legend calls the bounds."""
    marks: Sequence[float] = ()
    """Places on x where something is wrong: small triangles on the lower edge."""
    mark: str = "collision"
    spot: tuple[float, float] | None = None
    """A point that a ring shows."""
    spot_label: str = ""
    title: str = ""
    """What stands above the chart, where its y axis has no room for it."""
    min_span: float = 0.0
    """The smallest span of the y axis, so that rounding is no mountain."""


def _look(k: int) -> dict[str, Any]:
    return {"color": pick(COLORS, k), "linestyle": pick(DASHES, k)}


def plot_lines(
    lines: Sequence[Line], *, x: Axis, y: Axis, events: Sequence[Event] = (), level: tuple[float, str] | None = None
) -> Any:
    """Curves over `x`, with events as marked vertical lines and one horizontal `level` (value, label)."""
    with drawing(x, y) as (figure, axes):
        colors = {line.label: pick(COLORS, k) for k, line in enumerate(lines)}
        for k, line in enumerate(lines):
            axes.plot(line.x, line.y, label=legend_name(line.label), **_look(k))
        if level is not None:
            axes.axhline(level[0], color=INK, linewidth=1.0, label=level[1])
        for k, event in enumerate(events):
            _draw_event(axes, event, colors.get(event.line, INK), pick(MARKERS, k))
    return figure


def _draw_event(axes: Any, event: Event, color: str, marker: str) -> None:
    """A thin line with a mark on its top, by which the legend tells it from the others."""
    axes.axvline(event.x, color=color, linewidth=1.1)
    head = {"color": color, "marker": marker, "markersize": 6.5, "linestyle": "none", "clip_on": False, "zorder": 5}
    axes.plot([event.x], [1.0], transform=axes.get_xaxis_transform(), label=legend_name(event.label), **head)


def plot_bars(groups: Sequence[str], bars: Sequence[Bars], *, x: Axis, y: Axis) -> Any:
    """Groups of bars with intervals as whiskers and published values as diamonds."""
    width = 0.8 / len(bars)
    with drawing(x, y) as (figure, axes):
        for k, series in enumerate(bars):
            places = np.arange(len(groups)) + (k - (len(bars) - 1) / 2) * width
            look = {"color": pick(COLORS, k), "hatch": pick(HATCHES, k), "edgecolor": "#ffffff"}
            axes.bar(places, series.values, 0.92 * width, label=legend_name(series.label), linewidth=0, **look)
            if len(series.lower):
                _draw_whiskers(axes, places, series)
            if len(series.published):
                label = None if any(len(earlier.published) for earlier in bars[:k]) else "published"
                diamond = {"marker": "D", "s": 44, "color": INK, "edgecolor": "#ffffff", "zorder": 4}
                axes.scatter(places, series.published, label=label, **diamond)
        axes.set_xticks(range(len(groups)), list(map(printable, groups)))
        axes.tick_params(axis="x", length=0)
    return figure


def _draw_whiskers(axes: Any, places: Any, series: Bars) -> None:
    values = np.asarray(series.values)
    spans = [values - series.lower, np.asarray(series.upper) - values]
    axes.errorbar(places, values, spans, fmt="none", ecolor=INK, elinewidth=1.2, capsize=3.5, zorder=3)


def plot_forest(estimates: Sequence[Estimate], *, x: Axis, published: float | None = None) -> Any:
    """One line an estimate, first on top, with its interval; filled where the interval holds the published value."""
    count = len(estimates)
    with drawing(x, Axis(label=""), height_in=1.2 + 0.26 * count, grid="x") as (figure, axes):
        if published is not None:
            axes.axvline(published, linewidth=1.4, label="published", **_look(1))
        rows = np.arange(count)
        holds = np.array([published is None or e.lower <= published <= e.upper for e in estimates], dtype=bool)
        _draw_estimates(axes, rows, estimates, holds, None if published is None else "interval holds it", "full")
        _draw_estimates(axes, rows, estimates, ~holds, "interval misses it", "none")
        axes.set_yticks(rows, [printable(estimate.label) for estimate in estimates])
        axes.set_ylim(count - 0.4, -0.6)
        axes.tick_params(axis="y", length=0)
        axes.spines["left"].set_visible(False)
    return figure


def _draw_estimates(
    axes: Any, rows: Any, estimates: Sequence[Estimate], shown: Any, label: str | None, fill: str
) -> None:
    if not shown.any():
        return
    low, value, high = np.array([[e.lower, e.value, e.upper] for e in estimates])[shown].T
    look = {"fmt": "o", "markersize": 6.5, "fillstyle": fill, "color": pick(COLORS, 0), "elinewidth": 1.6}
    axes.errorbar(value, rows[shown], xerr=[value - low, high - value], capsize=3, label=label, **look)


def plot_cdf(samples: Sequence[Sample], *, x: Axis, y: str = "cases") -> Any:
    """The share of all cases whose value is at most x; a curve that ends below 100 % has cases without a value."""
    numbers = [np.sort(_finite(sample)) for sample in samples]
    end = max((values[-1] for values in numbers if len(values)), default=0.0)
    with drawing(x, Axis(label=f"{y} done", unit=SHARE, limits=(0, 101))) as (figure, axes):
        for k, (sample, values) in enumerate(zip(samples, numbers, strict=True)):
            total = len(values) if sample.total is None else sample.total
            curve = _climb(values, total, end)
            axes.plot(*curve, label=legend_name(sample.label), drawstyle="steps-post", **_look(k))
    return figure


def _climb(values: Any, total: int, end: float) -> tuple[Any, Any]:
    """Places and percentages of a curve: up from 0 at the least of the sorted values, and level from the last on."""
    if not len(values):
        return [], []
    shown = np.unique(np.linspace(0, len(values) - 1, MAX_POINTS).astype(int))
    shares = 100.0 * (shown + 1) / total
    return np.r_[values[0], values[shown], end], np.r_[0.0, shares, shares[-1]]


def plot_histogram(samples: Sequence[Sample], *, x: Axis, bins: int = 60) -> Any:
    """Outlines of the samples' histograms over common bins, in percent of each sample."""
    values = [_finite(sample) for sample in samples]
    edges = _edges(values, bins, log=x.log)
    with drawing(x, Axis(label="share", unit=SHARE, limits=(0, None))) as (figure, axes):
        for k, (sample, numbers) in enumerate(zip(samples, values, strict=True)):
            counts = np.histogram(np.clip(numbers, edges[0], edges[-1]), edges)[0]
            shares = 100.0 * counts / max(len(numbers), 1)
            axes.stairs(shares, edges, label=legend_name(sample.label), linewidth=1.6, **_look(k))
    return figure


def _finite(sample: Sample) -> Any:
    values = np.asarray(sample.values, dtype=float)
    return values[np.isfinite(values)]


def _edges(values: Sequence[Any], bins: int, *, log: bool) -> Any:
    """Common bin edges; on a logarithmic axis zeros fall into the first bin."""
    joined = np.concatenate([numbers[numbers > 0] if log else numbers for numbers in values])
    if not len(joined):
        return np.array([1.0, 10.0]) if log else np.array([0.0, 1.0])
    return 10 ** np.histogram_bin_edges(np.log10(joined), bins) if log else np.histogram_bin_edges(joined, bins)


def plot_panels(panels: Sequence[Panel], *, x: Axis, columns: int = 1, height_in: float = PANEL_IN) -> Any:
    """Charts row by row; curves of one label share their look and one entry in the legend, one without has none."""
    labels = list(dict.fromkeys(line.label for panel in panels for line in panel.lines if line.label))
    with drawing_panels(x, [panel.y for panel in panels], columns=columns, height_in=height_in) as (figure, charts):
        for axes, panel in zip(charts, panels, strict=True):
            for line in panel.lines:
                k = labels.index(line.label) if line.label else 0
                axes.plot(line.x, line.y, label=line.label or "_nolegend_", linewidth=1.6, **_look(k))
            for number, value in enumerate(panel.bounds):
                label = "_nolegend_" if number else panel.bound
                axes.axhline(value, color=INK, linewidth=0.9, linestyle=BOUND, label=label)
            if len(panel.marks):
                _draw_marks(axes, panel)
            if panel.spot is not None:
                ring = {"marker": "o", "markersize": 8, "markerfacecolor": "none", "markeredgewidth": 1.6}
                label = legend_name(panel.spot_label)
                axes.plot(*panel.spot, color=pick(COLORS, 2), linestyle="none", label=label, zorder=6, **ring)
            if panel.title:
                axes.set_title(panel.title, loc="left", fontsize=TITLE_PT, color=INK)
            _widen(axes, panel.min_span)
        figure.align_ylabels()
    return figure


def _widen(axes: Any, min_span: float) -> None:
    """Let the y axis span at least so much, with what it shows in its middle."""
    low, high = axes.get_ylim()
    if high - low < min_span:
        middle = 0.5 * (low + high)
        axes.set_ylim(middle - 0.5 * min_span, middle + 0.5 * min_span)


def _draw_marks(axes: Any, panel: Panel) -> None:
    look = {"marker": "^", "markersize": 5, "color": INK, "linestyle": "none", "clip_on": False, "zorder": 5}
    edge = axes.get_xaxis_transform()
    axes.plot(panel.marks, [0.0] * len(panel.marks), transform=edge, label=panel.mark, **look)
