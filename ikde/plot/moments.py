"""A drawn motion as small views from afar, side by side: spheres as circles of their radius, far ones first.

Seen from far away a sphere is a circle of its radius, so a few hundred of them are drawn in no time.
"""

from typing import Any

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.plot.images import show_as_text
from ikde.plot.style import find_eye
from ikde.scene.drawn_motion import DrawnMotion
from ikde.scene.drawn_pose import COLORS, Role

MAX_NAMED = 2  # colliding components in a title
COLUMNS = 4
ELEVATION_DEG, AZIMUTH_DEG = 22.0, -55.0
PATH, GROUND, WRONG = "0.55", "0.75", "#b00000"
MARGIN_M = 0.05
GRID_M = 0.5


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
    points = np.concatenate([motion.path_m @ view[:2].T, motion.robot.compute_box(view[:2])])
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
    from matplotlib.patches import Circle

    robot, centres = motion.robot, motion.robot.centres_m[frame] @ view.T
    roles = robot.roles[frame][robot.parts]
    for order, sphere in enumerate(np.argsort(centres[:, 2], kind="stable")):
        look = {"facecolor": COLORS[roles[sphere]], "edgecolor": "white", "linewidth": 0.35, "alpha": 0.62}
        axes.add_patch(Circle(centres[sphere, :2], float(robot.radii_m[sphere]), zorder=2 + order, **look))
    links = robot.links_m[frame] @ view[:2].T
    axes.plot(*links.T, "o-", color=COLORS[Role.LINK], linewidth=1.0, markersize=1.6, zorder=800)
