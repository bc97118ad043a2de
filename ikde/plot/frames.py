"""A robot as its frames: key points joined by links, each with its axes, x red, y green, z blue."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.robot import Robot
from ikde.plot.images import show_as_text
from ikde.plot.pose import AXES
from ikde.solver.plain import compute_frames

AXIS_LENGTH_M = 0.12
DOTS = ":", "-", "--"  # of the x, y and z axes
LABEL_OFFSET_M = np.array([0.03, 0.03, 0.02])


def plot_frames(robot: Robot, q: Floats, names: Sequence[str], *, title: str) -> Any:
    """Draw the frames `names` at `q` [N], in their order along the arm.

    Returns:
        A matplotlib `Figure`; axes in metres, world frame.
    """
    from matplotlib.figure import Figure

    Ts_world = compute_frames(robot, q)
    frames = [Ts_world[name] for name in names]
    points = np.array([T[:3, 3] for T in frames])
    figure = Figure(figsize=(5.0, 6.4), layout="constrained")
    axes: Any = figure.add_subplot(projection="3d")
    axes.plot(*points.T, "o-", color="0.25", linewidth=2.2, markersize=4)
    for T in frames:
        _draw_axes(axes, T)
    for label, point in _labels(names, points):
        axes.text(*(point + LABEL_OFFSET_M), label, fontsize=10)
    _frame_box(axes, points)
    axes.set(xlabel="x [m]", ylabel="y [m]", zlabel="z [m]", title=title)
    axes.locator_params(axis="x", nbins=3)
    axes.locator_params(axis="y", nbins=3)
    axes.view_init(elev=14, azim=-62)
    return show_as_text(figure)


def _draw_axes(axes: Any, T_world_frame: Floats) -> None:
    origin = T_world_frame[:3, 3]
    for k, (color, dots) in enumerate(zip(AXES, DOTS, strict=True)):
        tip = origin + AXIS_LENGTH_M * T_world_frame[:3, k]
        axes.plot(*np.array([origin, tip]).T, color=color, linestyle=dots, linewidth=2.0)


def _labels(names: Sequence[str], points: Floats) -> list[tuple[str, Floats]]:
    """One label a place: frames that share their origin share it."""
    labels: list[tuple[str, Floats]] = []
    for name, point in zip(names, points, strict=True):
        if labels and np.allclose(labels[-1][1], point, atol=1e-3):
            labels[-1] = (f"{labels[-1][0]}, {name}", point)
        else:
            labels.append((name, point))
    return labels


def _frame_box(axes: Any, points: Floats) -> None:
    """One scale for all axes."""
    low, high = points.min(axis=0) - 0.15, points.max(axis=0) + 0.15
    middle, half = 0.5 * (low + high)[:2], 0.25 * float((high - low)[2])
    half = max(half, 0.5 * float((high - low)[:2].max()))
    axes.set(xlim=(middle[0] - half, middle[0] + half), ylim=(middle[1] - half, middle[1] + half))
    axes.set_zlim(low[2], high[2])
    axes.set_box_aspect((2 * half, 2 * half, float((high - low)[2])))
