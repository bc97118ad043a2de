"""How fast the tool can move in each direction: ellipsoids of its velocity and angular velocity, with the robot."""

from typing import Any

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.plot.images import show_as_text
from ikde.plot.pose import plot_pose
from ikde.scene.drawn_pose import DrawnPose

MESH = 24  # lines around an ellipsoid
DRAWN_M = 0.35  # of the longest semi-axis in the drawing of the robot
COLORS = {"whole": "#1b6ca8", "arm": "#d1602c", "base": "#3a8f4f"}
POSE_PLACE = (0.0, 0.0, 0.6, 0.92)  # left, bottom, width, height of the figure
PLACES = {"velocity": (0.62, 0.5, 0.36, 0.42), "angular velocity": (0.62, 0.03, 0.36, 0.42)}
UNITS = {"velocity": "m/s", "angular velocity": "rad/s"}


def plot_ellipsoids(pose: DrawnPose, p_world_tool: Floats, jacobians: dict[str, Floats]) -> Any:
    """Draw a pose with the ellipsoids of its tool, and both kinds of them once more at scale.

    Args:
        pose: the robot.
        p_world_tool: [3] m, where the ellipsoids of velocity stand.
        jacobians: by part (`whole`, `arm`, `base`) [6, n], m/s and rad/s: each column at its speed limit.

    Returns:
        A matplotlib `Figure`; axes in metres, world frame, those at the side in m/s and rad/s along the world's axes.
    """
    figure = plot_pose(pose, size_in=(13.0, 8.0))
    axes = figure.axes[0]
    axes.set_position(POSE_PLACE)
    largest = max(np.linalg.norm(J[:3], 2) for J in jacobians.values() if J.size)
    scale = DRAWN_M / largest if largest > 0.0 else 0.0
    for part, J in jacobians.items():
        _draw_ellipsoid(axes, p_world_tool, scale * J[:3], part, alpha=0.5)
    axes.set_title(f"{pose.title} · velocity: {DRAWN_M:g} m for {largest:.3g} m/s", fontsize=10)
    for kind, rows in (("velocity", slice(0, 3)), ("angular velocity", slice(3, 6))):
        beside: Any = figure.add_axes(PLACES[kind], projection="3d")
        reach = max(np.linalg.norm(J[rows], 2) for J in jacobians.values() if J.size) or 1.0
        for part, J in jacobians.items():
            _draw_ellipsoid(beside, np.zeros(3), J[rows], part, alpha=0.8)
        beside.set(xlim=(-reach, reach), ylim=(-reach, reach), zlim=(-reach, reach))
        beside.set_box_aspect((1, 1, 1))
        beside.view_init(elev=axes.elev, azim=axes.azim)
        for axis in "xyz":
            beside.locator_params(axis=axis, nbins=4)
            beside.tick_params(axis=axis, labelsize=7)
        beside.set_title(f"{kind} [{UNITS[kind]}]", fontsize=10)
        beside.legend(fontsize=8, loc="upper left")
    return show_as_text(figure)


def _draw_ellipsoid(axes: Any, centre: Floats, J: Floats, label: str, *, alpha: float) -> None:
    """The image of the unit ball of all speeds: flat, or a line, where a direction is missing."""
    U, S, _ = np.linalg.svd(J if J.size else np.zeros((3, 1)))
    semi = np.zeros(3)
    semi[: len(S)] = S[:3]
    around, along = np.linspace(0.0, 2.0 * np.pi, MESH + 1), np.linspace(0.0, np.pi, MESH // 2 + 1)
    ball = np.stack(
        [
            np.outer(np.sin(along), np.cos(around)),
            np.outer(np.sin(along), np.sin(around)),
            np.outer(np.cos(along), np.ones_like(around)),
        ]
    )
    x, y, z = centre[:, None, None] + np.einsum("ij,jkl->ikl", U * semi, ball)
    style = {"color": COLORS[label], "linewidth": 0.6, "alpha": alpha, "zorder": 8}
    axes.plot_wireframe(x, y, z, rstride=2, cstride=2, label=label, **style)
