"""The house style of charts: readable without colour, on light and on dark paper, on a phone and in print."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.plot.images import INK, show_as_text

# Okabe and Ito's colours in the order of their contrast with both papers; their black is INK, their yellow too pale.
COLORS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00")
DASHES = ("-", (0, (5, 1.6)), (0, (1.2, 1.4)), (0, (7, 1.5, 1.5, 1.5)), (0, (9, 3)), (0, (3, 1, 1, 1, 1, 1)))
MARKERS = ("o", "s", "^", "D", "v", "P")
HATCHES = ("", "////", "....", "\\\\\\\\", "xxxx", "----")
WIDTH_IN, HEIGHT_IN = 5.4, 3.2  # small, so that 10 pt are still legible on a phone
SPACE_IN = 4.2  # height of a drawing in space
LEGEND_CHARACTERS, LEGEND_LINE_IN = 62, 0.21  # a legend's line: what it holds at this width, and its height

_STYLE: dict[Any, Any] = {
    "font.family": ["DejaVu Sans"],
    "font.size": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": INK,
    "axes.labelcolor": INK,
    "axes.axisbelow": True,
    "text.color": INK,
    "grid.color": INK,
    "grid.alpha": 0.16,
    "grid.linewidth": 0.7,
    "hatch.linewidth": 0.7,
    "lines.linewidth": 1.8,
    "legend.frameon": False,
    "legend.fontsize": 9.5,
    "legend.labelcolor": INK,
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Axis:
    """What an axis measures: `clearance [mm]`."""

    label: str
    unit: str = ""
    log: bool = False
    whole: bool = False
    """Only whole numbers are marked."""
    limits: tuple[float | None, float | None] = (None, None)

    @property
    def title(self) -> str:
        """Label and unit."""
        return f"{self.label} [{self.unit}]" if self.unit else self.label


@contextmanager
def drawing(x: Axis, y: Axis, *, height_in: float = HEIGHT_IN, grid: str = "y") -> Iterator[tuple[Any, Any]]:
    """An empty chart to draw into, as `(figure, axes)`; its scales and its legend are set when the block ends."""
    with drawing_panels(x, [y], height_in=height_in, grid=grid) as (figure, panels):
        yield figure, panels[0]


@contextmanager
def drawing_panels(
    x: Axis, ys: Sequence[Axis], *, columns: int = 1, height_in: float = HEIGHT_IN, grid: str = "y"
) -> Iterator[tuple[Any, list[Any]]]:
    """Empty charts over one x, row by row, as `(figure, [axes, ...])`: one legend for all; `height_in` of a row."""
    import matplotlib
    from matplotlib.figure import Figure

    rows = -(-len(ys) // columns)
    with matplotlib.rc_context(_STYLE):
        figure = Figure(figsize=(WIDTH_IN, height_in * rows), layout="constrained")
        panels: list[Any] = [figure.add_subplot(rows, columns, number) for number in range(1, len(ys) + 1)]
        for axes in panels:
            axes.grid(axis=grid)
            axes.tick_params(colors=INK, length=3.5)
        yield figure, panels
        for number, (axes, y) in enumerate(zip(panels, ys, strict=True)):
            is_last = number + columns >= len(ys)
            axes.set(xlabel=x.title if is_last else "", ylabel=y.title)
            axes.tick_params(labelbottom=is_last)
            _set_scale(axes.xaxis, axes.set_xscale, axes.set_xlim, x)
            _set_scale(axes.yaxis, axes.set_yscale, axes.set_ylim, y)
        _set_legend(figure, panels)
        show_as_text(figure)


@contextmanager
def drawing_space() -> Iterator[tuple[Any, Any]]:
    """An empty space in metres to draw into, as `(figure, axes)`."""
    import matplotlib
    from matplotlib.figure import Figure

    with matplotlib.rc_context(_STYLE):
        figure = Figure(figsize=(WIDTH_IN, SPACE_IN), layout="constrained")
        axes: Any = figure.add_subplot(projection="3d")
        yield figure, axes
        axes.set(xlabel="x [m]", ylabel="y [m]", zlabel="z [m]")
        axes.view_init(elev=22, azim=-55)
        for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
            axis.set_pane_color((0.0, 0.0, 0.0, 0.0))
            axis.line.set_color(INK)
            axis.set_tick_params(color=INK, labelcolor=INK, labelsize=8)
            axis.get_major_locator().set_params(nbins=4)
        _set_legend(figure, [axes])
        show_as_text(figure)


def set_box(axes: Any, low: Floats, high: Floats, *, zoom: float = 1.0) -> None:
    """Show a box of space from corner `low` to `high` [3], at one scale for all three axes."""
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    axes.set_zlim(low[2], high[2])
    axes.set_box_aspect(high - low, zoom=zoom)


def find_eye(elevation_deg: float, azimuth_deg: float) -> Floats:
    """Direction [3] from what is drawn to the eye."""
    elevation, azimuth = np.radians([elevation_deg, azimuth_deg])
    return np.array([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)])


def legend_name(name: str) -> str:
    """A name for the legend; matplotlib would leave out those that begin with an underscore."""
    return f" {name}" if name.startswith("_") else name


def pick(choices: Sequence[Any], index: int) -> Any:
    """The look of series number `index`; after the last one they begin again."""
    return choices[index % len(choices)]


def format_tick(value: float) -> str:
    """`0.01`, `20`, `5,000`, `1e-06`."""
    return f"{value:,.10g}" if 1e-4 <= abs(value) < 1e6 else f"{value:g}"


def _set_scale(ticks: Any, set_scale: Any, set_limits: Any, axis: Axis) -> None:
    if axis.log and ticks.get_minpos() < float("inf"):  # a logarithm of nothing cannot be drawn
        set_scale("log")
        _set_log_ticks(ticks)
    elif axis.whole:
        ticks.get_major_locator().set_params(integer=True)
    if axis.limits != (None, None):
        set_limits(*axis.limits)


def _set_log_ticks(ticks: Any) -> None:
    """Plain numbers; between the powers of ten 2 and 5 as well, where there are few powers."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    low, high = ticks.get_view_interval()
    steps = (1.0,) if high / low > 300 else (1.0, 2.0, 5.0)
    ticks.set_major_locator(LogLocator(subs=steps))
    ticks.set_major_formatter(FuncFormatter(lambda value, _: format_tick(value)))
    ticks.set_minor_formatter(NullFormatter())


def _set_legend(figure: Any, panels: Sequence[Any]) -> None:
    """Above the charts, where it hides nothing, in as many columns as fit; the figure grows by its lines."""
    handles, labels = panels[0].get_legend_handles_labels()
    for axes in panels[1:]:
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
            if label not in labels:
                handles.append(handle)
                labels.append(label)
    if not labels:
        return
    columns = _legend_columns([len(label) + 6 for label in labels])
    rows = -(-len(labels) // columns)
    figure.set_figheight(figure.get_figheight() + LEGEND_LINE_IN * (rows - 1))
    figure.legend(handles, labels, loc="outside upper left", ncols=columns, handlelength=2.4, columnspacing=1.4)


def _legend_columns(widths: Sequence[int]) -> int:
    """One line if all fit, else columns as wide as the longest."""
    if sum(widths) <= LEGEND_CHARACTERS:
        return len(widths)
    return max(1, LEGEND_CHARACTERS // max(widths))
