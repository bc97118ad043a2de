"""Where targets are: from above and from the side, at one scale."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ikde.kernels.arrays import Floats
from ikde.plot.images import INK
from ikde.plot.style import Axis, drawing_panels, legend_name

VIEW_IN = 2.9  # height
POINT_PT2 = 16.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Places:
    """Points that share a look; those of a hollow mark are crosses or rings."""

    label: str
    points_m: Floats
    """[n, 3], world."""
    color: str
    marker: str = "o"


def plot_places(places: Sequence[Places]) -> Any:
    """Points from above (x, y) and from the side (x, z), in m, with the world's origin."""
    views = (Axis(label="y, from above", unit="m"), 1), (Axis(label="z, from the side", unit="m"), 2)
    x = Axis(label="x", unit="m")
    with drawing_panels(x, [axis for axis, _ in views], columns=2, height_in=VIEW_IN, grid="both") as (figure, charts):
        for axes, (_, across) in zip(charts, views, strict=True):
            for group in places:
                look = {"color": group.color, "marker": group.marker, "s": POINT_PT2, "linewidths": 1.2}
                axes.scatter(*group.points_m[:, [0, across]].T, label=legend_name(group.label), **look)
            axes.plot([0.0], [0.0], "+", color=INK, markersize=9, label="world origin", linestyle="none")
            axes.set_aspect("equal", adjustable="datalim")
    return figure
