"""A drawn world as a figure in space: solids as see-through faces, clouds as points, obstacles by number and name."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.plot.images import INK, show_as_text
from ikde.plot.style import COLORS, find_eye, pick, set_box
from ikde.scene.drawn_pose import COLORS as ROLE_COLORS
from ikde.scene.drawn_pose import Role
from ikde.scene.drawn_world import DrawnObstacle, DrawnSolid, DrawnWorld

MARGINS = (0.0, 0.03, 0.95, 0.9)  # left, bottom, width, height
ALPHA, EDGE_ALPHA, OFF_ALPHA = 0.35, 0.55, 0.06
MAX_LABELS = 24  # names in the legend
MAX_NAMES = 8  # of obstacles beside a robot
VIEW = (24.0, -58.0)  # elevation and azimuth in deg


def plot_world(world: DrawnWorld, *, size_in: tuple[float, float] = (9.0, 8.0)) -> Any:
    """Draw obstacles, each in a colour of its own, those that are off as outlines; a matplotlib `Figure` in metres."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=size_in, dpi=130)
    axes: Any = figure.add_axes(MARGINS, projection="3d", computed_zorder=False)
    axes.view_init(*VIEW)
    for place, obstacle in enumerate(world.obstacles):
        is_named = place < MAX_LABELS
        label = f"{place + 1} {obstacle.name}" if is_named else "_nolegend_"
        if is_named:
            _draw_text(axes, str(place + 1), obstacle)
        for solid in obstacle.solids:
            label = _draw_solid(axes, solid, pick(COLORS, place), label, obstacle)
    box_m = world.box_m
    half_m = 0.52 * max(float(np.ptp(box_m, axis=0).max()), 0.1)
    middle_m = box_m.mean(axis=0)
    set_box(axes, middle_m - half_m, middle_m + half_m)
    _draw_origin(axes, 0.3 * half_m)
    more = len(world.obstacles) - MAX_LABELS
    title = f"{world.title}  ·  and {more} more" if more > 0 else world.title
    axes.set(xlabel="x [m]", ylabel="y [m]", zlabel="z [m]", title=title)
    if world.obstacles:
        axes.legend(loc="upper left", fontsize=9, framealpha=0.9)
    return show_as_text(figure)


def draw_obstacles(axes: Any, obstacles: Sequence[DrawnObstacle]) -> None:
    """Draw what stands around a robot, grey, and what it touches in another colour, each with its name."""
    labelled: set[Role] = set()
    named = sorted(obstacles, key=lambda obstacle: not obstacle.is_touched)[:MAX_NAMES]
    for obstacle in sorted(obstacles, key=_is_endless):  # whose faces are pale, for the legend
        role = Role.TOUCHED if obstacle.is_touched else Role.OBSTACLE
        label = "_nolegend_" if role in labelled else str(role)
        labelled.add(role)
        for solid in obstacle.solids:
            label = _draw_solid(axes, solid, ROLE_COLORS[role], label, obstacle)
        if obstacle in named:
            _draw_text(axes, obstacle.name, obstacle, ROLE_COLORS[role] if obstacle.is_touched else INK)


def _draw_solid(axes: Any, solid: DrawnSolid, color: str, label: str, obstacle: DrawnObstacle) -> str:
    """Draw it and name it; what the next one of the obstacle is called in the legend."""
    from matplotlib.colors import to_rgba
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    alpha = ALPHA if obstacle.is_on else OFF_ALPHA
    if solid.polygons_m:
        depth = 0.0 if solid.is_endless else 1.0 + 0.01 * float(_middle(solid) @ find_eye(axes.elev, axes.azim))
        edge = EDGE_ALPHA if len(solid.polygons_m) < 100 and not solid.is_endless else 0.15
        look: dict[str, Any] = {
            "facecolor": to_rgba(color, 0.12 if solid.is_endless else alpha),
            "edgecolor": to_rgba(color, edge),
        }
        faces = Poly3DCollection(_pad(solid.polygons_m), linewidth=0.7, zorder=depth, label=label, **look)
        axes.add_collection3d(faces)
    else:
        axes.scatter(*solid.points_m.T, s=1.5, color=color, alpha=0.8, depthshade=False, zorder=2, label=label)
    return "_nolegend_"


def _is_endless(obstacle: DrawnObstacle) -> bool:
    return all(solid.is_endless for solid in obstacle.solids)


def _draw_text(axes: Any, text: str, obstacle: DrawnObstacle, color: str = "black") -> None:
    """Its name, or the number that the legend names, over the obstacle; over a corner of what has no end."""
    points = np.concatenate([np.concatenate([*s.polygons_m, s.points_m]) for s in obstacle.solids])
    place = points[0] if _is_endless(obstacle) else np.append(points[:, :2].mean(axis=0), points[:, 2].max())
    axes.text(*place, text, fontsize=9, color=color, zorder=20, ha="center", va="bottom")


def _pad(polygons_m: Sequence[Floats]) -> list[Floats]:
    """The same, of one number of corners each, the last one again: matplotlib scales by unset memory otherwise."""
    most = max(map(len, polygons_m))
    return [np.concatenate([P, np.repeat(P[-1:], most - len(P), axis=0)]) for P in polygons_m]


def _middle(solid: DrawnSolid) -> Floats:
    return np.concatenate(solid.polygons_m).mean(axis=0)


def _draw_origin(axes: Any, length_m: float) -> None:
    """The world's frame."""
    from ikde.scene.drawn_pose import AXIS_COLORS

    for k, color in enumerate(AXIS_COLORS):
        axes.plot(*np.array([np.zeros(3), length_m * np.eye(3)[k]]).T, color=color, linewidth=2.0, zorder=9)
