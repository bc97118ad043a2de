"""A drawn pose as a figure in space: spheres, links, frames by their axes, marks and labels."""

import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ikde.errors import FileError
from ikde.formats.atomic import write_named
from ikde.kernels.arrays import Floats
from ikde.plot.images import any_letters, show_as_text
from ikde.plot.style import find_eye, set_box
from ikde.plot.world import draw_obstacles
from ikde.scene.drawn_pose import AXIS_COLORS, COLORS, DrawnPose, DrawnRobot, Mark, Role
from ikde.scene.drawn_region import Outline

MESH = 24  # facets around a sphere
MARGINS = (0.0, 0.03, 0.95, 0.92)  # left, bottom, width, height; a layout engine would draw everything twice
MARGINS_IN_WORLD = (0.0, 0.16, 0.95, 0.8)
GRID_M = 0.5
LINK_PT, BASE_ALPHA = 6.0, 0.05
VIEWS = {
    "right": (16.0, -68.0),
    "left": (16.0, 68.0),
    "front": (12.0, 15.0),
    "side": (0.0, -90.0),
    "top": (90.0, -90.0),
}
"""Elevation in deg, and the azimuth from the base's heading."""
SOLID = "-", "-", "-"
DASHES = ":", "-", "--"  # of the x, y and z axes, so that they differ without colour
LABEL_OFFSET_M = np.array([0.03, 0.03, 0.02])
FRAMES_MARGIN_M = 0.15


def plot_pose(pose: DrawnPose, *, size_in: tuple[float, float] = (9.0, 8.0), view: str = "right") -> Any:
    """Draw a pose, seen from one of `VIEWS`: `right` is the robot's right, a little from the front and from above.

    What is fixed to the base is drawn as outlines, so that it hides nothing.

    Returns:
        A matplotlib `Figure`; axes in metres, world frame.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=size_in, dpi=130)
    axes: Any = figure.add_axes(MARGINS, projection="3d", computed_zorder=False)
    elevation_deg, azimuth_deg = VIEWS[view]
    axes.view_init(elev=elevation_deg, azim=float(np.degrees(pose.heading_rad)) + azimuth_deg)
    look = {"solid_capstyle": "round", "solid_joinstyle": "round", "alpha": 0.75}
    axes.plot(*pose.robot.links_m.T, color=COLORS[Role.LINK], linewidth=LINK_PT, zorder=5, label="links", **look)
    _draw_axes(axes, pose.Ts_world_frame, length_m=0.15, dashes=SOLID, width=2.5)
    _draw_spheres(axes, pose.robot)
    draw_obstacles(axes, pose.obstacles)
    for mark in pose.marks:
        _draw_mark(axes, mark)
    for outline in pose.region:
        _draw_goal(axes, outline)
    axes.set(xlabel="x [m]", ylabel="y [m]", zlabel="z [m]", title=pose.title)
    box_m = pose.compute_box()
    half_m = 0.51 * float(np.ptp(box_m, axis=0).max())
    box_m[0, 2] = min(box_m[0, 2], 0.0)
    _set_box(axes, box_m, half_m, 2.0 * half_m, 1.12 if pose.obstacles else 1.0)
    _draw_ground(axes)
    if axes.get_legend_handles_labels()[0]:
        place: dict[str, Any] = {"loc": "upper left"}
        if pose.obstacles:  # they fill the corner that is empty beside a robot alone
            axes.set_position(MARGINS_IN_WORLD)
            below = {"bbox_to_anchor": (0.5, 0.01), "bbox_transform": figure.transFigure}
            place = {"loc": "lower center", "ncols": 2, **below}
        axes.legend(fontsize=9, framealpha=0.9, **place)
    return show_as_text(figure)


def plot_frames(pose: DrawnPose) -> Any:
    """Draw a pose's frames with their labels, small; a matplotlib `Figure` in metres, world frame."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(5.0, 6.4), layout="constrained")
    axes: Any = figure.add_subplot(projection="3d")
    axes.plot(*pose.robot.links_m.T, "o-", color=COLORS[Role.LINK], linewidth=2.2, markersize=4)
    _draw_axes(axes, pose.Ts_world_frame, length_m=0.12, dashes=DASHES, width=2.0)
    for label, point in pose.labels:
        axes.text(*(point + LABEL_OFFSET_M), label, fontsize=10)
    box_m = pose.compute_box() + np.array([[-FRAMES_MARGIN_M], [FRAMES_MARGIN_M]])
    width_m, depth_m, height_m = np.ptp(box_m, axis=0)
    _set_box(axes, box_m, max(0.5 * width_m, 0.5 * depth_m, 0.25 * height_m), height_m)
    axes.set(xlabel="x [m]", ylabel="y [m]", zlabel="z [m]", title=pose.title)
    axes.locator_params(axis="x", nbins=3)
    axes.locator_params(axis="y", nbins=3)
    axes.view_init(elev=14, azim=-62)
    return show_as_text(figure)


def save_figure(figure: Any, path: Path) -> None:
    """Write a figure; raises `FileError` if the ending is unknown or the file cannot be written."""
    drawn = io.BytesIO()
    try:
        with any_letters():
            figure.savefig(drawn, format=path.suffix.removeprefix(".").lower() or "none")
    except ValueError as error:
        raise FileError(path, f"cannot be drawn: {error}") from None
    write_named(path, drawn.getbuffer())


def _draw_goal(axes: Any, outline: Outline) -> None:
    """Of a goal with freedom: what was reached before its alternatives, and where the base may stand on the floor."""
    color = COLORS[Role.BASE if outline.is_base else Role.REGION]
    look = {"linewidth": 0.8, "alpha": 0.6} if outline.is_faint else {"linewidth": 1.6}
    look |= {"linestyle": "--"} if outline.is_base else {}
    for number, line_m in enumerate(outline.lines_m):
        label = "_nolegend_" if number or not outline.text else outline.text
        axes.plot(*line_m.T, color=color, zorder=9, label=label, **look)


def _draw_axes(axes: Any, Ts_world_frame: Floats, *, length_m: float, dashes: Sequence[str], width: float) -> None:
    for T in Ts_world_frame:
        for k, (color, dash) in enumerate(zip(AXIS_COLORS, dashes, strict=True)):
            ends_m = np.array([T[:3, 3], T[:3, 3] + length_m * T[:3, k]])
            axes.plot(*ends_m.T, color=color, linestyle=dash, linewidth=width, zorder=6)


def _draw_ground(axes: Any) -> None:
    """A grid on the floor, z = 0, as far as the axes reach."""
    (left, right), (front, back) = axes.get_xlim(), axes.get_ylim()
    look = {"color": "0.8", "linewidth": 0.6, "zorder": 0}
    for x in _list_grid(left, right):
        axes.plot([x, x], [front, back], [0.0, 0.0], **look)
    for y in _list_grid(front, back):
        axes.plot([left, right], [y, y], [0.0, 0.0], **look)


def _list_grid(low: float, high: float) -> Floats:
    return GRID_M * np.arange(np.ceil(low / GRID_M), np.floor(high / GRID_M) + 1)


def _draw_spheres(axes: Any, robot: DrawnRobot) -> None:
    """From far to near, below lines and marks; each role once in the legend."""
    labelled: set[str] = set()
    eye = find_eye(axes.elev, axes.azim)
    for role, centre, radius in zip(robot.roles[robot.parts], robot.centres_m, robot.radii_m, strict=True):
        label = "_nolegend_" if role in labelled else f"{role} spheres"
        labelled.add(role)
        order = 1.0 + 0.01 * float(centre @ eye)
        draw = _draw_outline if role == Role.BASE else _draw_sphere
        draw(axes, centre, float(radius), COLORS[role], order).set_label(label)


def _draw_sphere(axes: Any, centre: Floats, radius: float, color: str, order: float) -> Any:
    u, v = np.meshgrid(np.linspace(0, 2 * np.pi, MESH), np.linspace(0, np.pi, MESH // 2))
    unit = np.array([np.cos(u) * np.sin(v), np.sin(u) * np.sin(v), np.cos(v)])
    look = {"color": color, "alpha": 0.4, "linewidth": 0, "antialiased": True, "shade": True}
    return axes.plot_surface(*(centre[:, None, None] + radius * unit), zorder=order, **look)


def _draw_outline(axes: Any, centre: Floats, radius: float, color: str, order: float) -> Any:
    """The circle that a sphere is to the eye."""
    from matplotlib.colors import to_rgba
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    azimuth, angles = np.radians(axes.azim), np.linspace(0.0, 2.0 * np.pi, 2 * MESH, endpoint=False)
    right = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
    up = np.cross(find_eye(axes.elev, axes.azim), right)
    circle = centre + radius * (np.cos(angles)[:, None] * right + np.sin(angles)[:, None] * up)
    look = {"facecolor": to_rgba(color, BASE_ALPHA), "edgecolor": to_rgba(color, 0.55), "linewidth": 0.8}
    return axes.add_collection3d(Poly3DCollection([circle], zorder=order, **look))


def _draw_mark(axes: Any, mark: Mark) -> None:
    look = {"color": COLORS[mark.role], "label": mark.text}
    if len(mark.points_m) == 1:
        axes.scatter(*mark.points_m.T, marker="*", s=160, depthshade=False, zorder=11, **look)
    else:
        axes.plot(*mark.points_m.T, "o-", linewidth=2.5, markersize=4, zorder=10, **look)


def _set_box(axes: Any, box_m: Floats, half_m: float, height_m: float, zoom: float = 1.0) -> None:
    """Show `half_m` to each side of the box's middle, and `height_m` from its floor."""
    (x, y, _), floor_m = box_m.mean(axis=0), box_m[0, 2]
    low = np.array([x - half_m, y - half_m, floor_m])
    set_box(axes, low, low + np.array([2.0 * half_m, 2.0 * half_m, height_m]), zoom=zoom)
