"""A link's shapes and the spheres that cover them, seen from three sides."""

from typing import Any

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.plot.images import show_as_text
from ikde.plot.style import COLORS

MAX_TRIANGLES = 20_000
"""That are drawn of one link, the largest ones."""
SIDES = (("from the front", 1, 2, 0), ("from the side", 0, 2, 1), ("from above", 0, 1, 2))
"""What each view is called, the axes to the right and up, and the one towards the eye."""
FACING = (1.0, -1.0, 1.0)
"""Whether the eye is on the positive or negative side of that axis."""
SIZE_IN = (9.6, 3.5)
MARGIN = 0.04


def plot_cover(triangles: Floats, centres: Floats, radii: Floats) -> Any:
    """Draw a link's surface and its spheres from three sides, without perspective.

    Args:
        triangles: [T, 3, 3] of its shapes, in m, in the link.
        centres: [S, 3] of the spheres, m.
        radii: [S] m.

    Returns:
        A matplotlib `Figure` of three charts in mm.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=SIZE_IN, layout="constrained")
    shown = 1e3 * _choose_largest(triangles)
    low, high = _find_box(shown, 1e3 * centres, 1e3 * radii)
    for panel, ((title, right, up, towards), facing) in enumerate(zip(SIDES, FACING, strict=True)):
        axes: Any = figure.add_subplot(1, 3, panel + 1, aspect="equal")
        _draw_surface(axes, shown, (right, up, towards), facing)
        _draw_circles(axes, 1e3 * centres[:, [right, up]], 1e3 * radii)
        axes.set(xlim=(low[right], high[right]), ylim=(low[up], high[up]), title=title)
        axes.set(xlabel=f"{'xyz'[right]} [mm]", ylabel=f"{'xyz'[up]} [mm]")
        axes.locator_params(axis="x", nbins=_count_ticks(high[right] - low[right], high[up] - low[up]))
        axes.locator_params(axis="y", nbins=5)
    return show_as_text(figure)


def _count_ticks(width: float, height: float) -> int:
    """Fewer where a chart is narrow."""
    return max(1, min(5, round(5.0 * width / height)))


def _choose_largest(triangles: Floats) -> Floats:
    if len(triangles) <= MAX_TRIANGLES:
        return triangles
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return triangles[np.argsort((normals**2).sum(axis=1), kind="stable")[-MAX_TRIANGLES:]]


def _find_box(triangles: Floats, centres: Floats, radii: Floats) -> tuple[Floats, Floats]:
    points = np.concatenate([triangles.reshape(-1, 3), centres - radii[:, None], centres + radii[:, None]])
    low, high = (points.min(axis=0), points.max(axis=0)) if len(points) else (-np.ones(3), np.ones(3))
    margin = MARGIN * float((high - low).max()) + 1e-9
    return low - margin, high + margin


def _draw_surface(axes: Any, triangles: Floats, way: tuple[int, int, int], facing: float) -> None:
    """From far to near, brighter where it faces the eye."""
    from matplotlib.collections import PolyCollection

    right, up, towards = way
    order = np.argsort(facing * triangles[:, :, towards].mean(axis=1), kind="stable")
    own = triangles[order]
    normals = np.cross(own[:, 1] - own[:, 0], own[:, 2] - own[:, 0])
    length = np.sqrt((normals**2).sum(axis=1))
    shade = 0.45 + 0.4 * np.abs(normals[:, towards]) / np.where(length > 0.0, length, 1.0)
    colors = np.repeat(shade[:, None], 3, axis=1)
    look: Any = {"facecolors": colors, "edgecolors": colors, "linewidths": 0.2}
    axes.add_collection(PolyCollection(list(own[:, :, [right, up]]), **look))


def _draw_circles(axes: Any, centres: Floats, radii: Floats) -> None:
    """What spheres are to an eye far away."""
    from matplotlib.collections import EllipseCollection
    from matplotlib.colors import to_rgba

    if not len(radii):
        return
    look: Any = {
        "facecolors": [to_rgba(COLORS[0], min(0.12, 1.5 / len(radii)))],
        "edgecolors": [to_rgba(COLORS[0], 0.9)],
        "linewidths": 0.8,
    }
    sizes = 2.0 * radii
    place: Any = {"units": "xy", "offsets": centres, "transOffset": axes.transData}
    axes.add_collection(EllipseCollection(sizes, sizes, 0.0 * sizes, **place, **look))
