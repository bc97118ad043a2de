"""A drawn motion as small views from afar, side by side: spheres as circles of their radius, far ones first.

Seen from far away a sphere is a circle of its radius, so a few hundred of them are drawn in no time.
"""

from typing import Any

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.plot.animation import list_edged
from ikde.plot.images import show_as_text
from ikde.plot.style import find_eye
from ikde.scene.drawn_motion import DrawnMotion
from ikde.scene.drawn_pose import COLORS, Role
from ikde.scene.drawn_world import DrawnSolid
from ikde.scene.outlines import find_outline

MAX_NAMED = 2  # colliding components in a title
COLUMNS = 4
ELEVATION_DEG, AZIMUTH_DEG = 22.0, -55.0
PATH, GROUND, WRONG = "0.55", "0.75", "#b00000"
MARGIN_M = 0.05
GRID_M = 0.5
MAX_POINTS = 400  # of a cloud


def plot_moments(motion: DrawnMotion) -> Any:
    """A view of each frame, all from the same place and at one scale."""
    from matplotlib.figure import Figure

    count = len(motion.samples)
    view = _list_directions()
    box = _find_window(motion, view)
    width, height = 2.4, 2.4 * min(1.5, max(0.55, float(box[1, 1] - box[0, 1]) / float(box[1, 0] - box[0, 0]))) + 0.28
    columns, rows = min(count, COLUMNS), -(-count // COLUMNS)
    figure = Figure(figsize=(width * columns, height * rows), layout="constrained")
    for frame in range(count):
        axes = figure.add_subplot(rows, columns, frame + 1)
        _draw_ground(axes, motion, view)
        _draw_path(axes, motion, frame, view)
        _draw_robot(axes, motion, frame, view)
        _draw_nearest(axes, motion, frame, view)
        names = motion.list_colliding(frame)
        said = _format_collision(names) or _format_clearance(float(motion.clearances_m[frame]))
        title = f"t = {motion.times_s[frame]:.2f} s{said}"
        axes.set_title(title, fontsize=8, color=WRONG if names else COLORS[Role.COLLIDING])
        axes.set(xlim=box[:, 0], ylim=box[:, 1], aspect="equal")
        axes.set_axis_off()
    return show_as_text(figure)


def _format_collision(names: list[str]) -> str:
    """What collides, in few words: there is little room above a view."""
    if not names:
        return ""
    return f": {', '.join(names) if len(names) <= MAX_NAMED else f'{len(names)} parts'} collide"


def _format_clearance(clearance_m: float) -> str:
    """Nothing where nothing was compared."""
    return f", {1e3 * clearance_m:.3g} mm clear" if np.isfinite(clearance_m) else ""


def _list_directions() -> Floats:
    """Rows [3, 3]: right, up and towards the eye, in the world."""
    eye, azimuth = find_eye(ELEVATION_DEG, AZIMUTH_DEG), np.radians(AZIMUTH_DEG)
    right = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
    return np.array([right, np.cross(eye, right), eye])


def _find_window(motion: DrawnMotion, view: Floats) -> Floats:
    """Lower and upper corner [2, 2] of what all views show."""
    frames = [motion.list_obstacles(frame) for frame in range(len(motion.samples) if motion.moved else 1)]
    solids = [solid for obstacles in frames for obstacle in obstacles for solid in obstacle.solids]
    ends = [P @ view[:2].T for solid in solids for P in solid.polygons_m]
    points = np.concatenate([motion.path_m @ view[:2].T, motion.robot.compute_box(view[:2]), *ends])
    return np.array([points.min(axis=0) - MARGIN_M, points.max(axis=0) + MARGIN_M])


def _draw_ground(axes: Any, motion: DrawnMotion, view: Floats) -> None:
    """A grid on the floor below path and robot."""
    around = np.concatenate([motion.path_m[:, :2], motion.robot.links_m[:, 0, :2]])
    low, high = (GRID_M * np.floor(around.min(axis=0) / GRID_M), GRID_M * np.ceil(around.max(axis=0) / GRID_M))
    lines = [[(x, low[1], 0.0), (x, high[1], 0.0)] for x in np.arange(low[0], high[0] + 1e-9, GRID_M)]
    lines += [[(low[0], y, 0.0), (high[0], y, 0.0)] for y in np.arange(low[1], high[1] + 1e-9, GRID_M)]
    for line in lines:
        axes.plot(*(np.array(line) @ view[:2].T).T, color=GROUND, linewidth=0.4, zorder=0)


def _draw_path(axes: Any, motion: DrawnMotion, frame: int, view: Floats) -> None:
    """The whole path, what was followed of it, and where the tool should be."""
    path, sample = motion.path_m @ view[:2].T, motion.samples[frame]
    axes.plot(*path.T, color=PATH, linewidth=0.8, zorder=1)
    axes.plot(*path[: sample + 1].T, color=COLORS[Role.TARGET], linewidth=1.4, zorder=900)
    axes.plot(*path[sample], marker="o", markersize=3, color=COLORS[Role.TARGET], zorder=901)


def _draw_robot(axes: Any, motion: DrawnMotion, frame: int, view: Floats) -> None:
    """Spheres and obstacles, far ones first, and links over them."""
    from matplotlib.patches import Circle

    robot, centres = motion.robot, motion.robot.centres_m[frame] @ view.T
    roles = robot.roles[frame][robot.parts]
    ranks = np.argsort(np.argsort(centres[:, 2], kind="stable"), kind="stable")
    for sphere, rank in enumerate(ranks.tolist()):
        look = {"facecolor": COLORS[roles[sphere]], "edgecolor": "white", "linewidth": 0.35, "alpha": 0.62}
        axes.add_patch(Circle(centres[sphere, :2], float(robot.radii_m[sphere]), zorder=2 + rank, **look))
    depths = np.sort(centres[:, 2])
    for obstacle in motion.list_obstacles(frame):
        color = COLORS[Role.TOUCHED if obstacle.name in motion.touched[frame] else Role.OBSTACLE]
        for solid in obstacle.solids:
            _draw_solid(axes, solid, view, color, depths)
    links = robot.links_m[frame] @ view[:2].T
    axes.plot(*links.T, "o-", color=COLORS[Role.LINK], linewidth=1.0, markersize=1.6, zorder=800)


def _draw_solid(axes: Any, solid: DrawnSolid, view: Floats, color: str, depths: Floats) -> None:
    """A convex solid by its outline and the edges that are seen, between spheres [S] before it and behind it."""
    from matplotlib.patches import Polygon

    if not solid.polygons_m:
        few = solid.points_m[:: max(1, -(-len(solid.points_m) // MAX_POINTS))] @ view.T
        axes.scatter(few[:, 0], few[:, 1], s=0.6, color=color, linewidths=0, zorder=1.9)
        return
    corners = np.concatenate(solid.polygons_m) @ view.T
    middle = float(corners[:, 2].mean())
    order = 1.5 if solid.is_endless else 1.95 + float(np.searchsorted(depths, middle))
    fill, edge = (0.08, 0.15) if solid.is_endless else (0.2, 0.7)
    seen = [face for face in (P @ view.T for P in list_edged(solid)) if face[:, 2].mean() > middle]
    for P, alpha in ((find_outline(corners[:, :2]), fill), *((face[:, :2], 0.05) for face in seen)):
        axes.add_patch(Polygon(P, facecolor=color, edgecolor="none", alpha=alpha, zorder=order))
        axes.add_patch(Polygon(P, fill=False, edgecolor=color, linewidth=0.45, alpha=edge, zorder=order))


def _draw_nearest(axes: Any, motion: DrawnMotion, frame: int, view: Floats) -> None:
    """A ring where the motion has the least room of a world, at that moment."""
    found = motion.nearest
    if found is None or found.sample != motion.samples[frame]:
        return
    points = found.points_m @ view[:2].T
    axes.plot(*points.T, color=COLORS[Role.CLOSEST], linewidth=1.4, zorder=902)
    ring = {"markerfacecolor": "none", "markeredgewidth": 1.4, "markersize": 6.5}
    axes.plot(*points[1], marker="o", color=COLORS[Role.CLOSEST], zorder=903, **ring)
