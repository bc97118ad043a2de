"""The path in space: what was asked, where the tool went, and where the base drove, if it can."""

from typing import Any

import numpy as np

from ikde.plot.images import INK
from ikde.plot.style import COLORS, drawing_space
from ikde.track.summary import TrackSummary


def plot_path(motion: TrackSummary) -> Any:
    """Asked path, tool and a base that drives in the world, m."""
    trajectory = motion.trajectory
    asked, reached = trajectory.path.p_world_tool, trajectory.path.p_world_tool[: len(trajectory.q)]
    tool = reached + trajectory.error_m
    with drawing_space() as (figure, axes):
        axes.plot(*asked.T, color=INK, linewidth=0.9, linestyle=(0, (4, 2)), label="path")
        axes.plot(*tool.T, color=COLORS[0], linewidth=1.8, label="tool")
        points = [asked, tool]
        if trajectory.base_joints and len(tool):
            place = [motion.robot.joint_names.index(name) for name in trajectory.base_joints[:2]]
            floor = np.column_stack([trajectory.q[:, place], np.zeros(len(tool))])
            axes.plot(*floor.T, color=COLORS[1], linewidth=1.8, label="base, on the floor")
            axes.plot(*floor[0], marker="o", markersize=4, color=COLORS[1])
            points.append(floor)
        if len(tool):
            axes.plot(*tool[0], marker="o", markersize=4, color=COLORS[0])
        _set_box(axes, np.concatenate(points))
    return figure


def _set_box(axes: Any, points: Any) -> None:
    """One scale for all three axes, around all points."""
    low, high = points.min(axis=0), points.max(axis=0)
    middle, half = 0.5 * (low + high), 0.55 * np.maximum(high - low, 0.15 * float((high - low).max()) + 1e-3)
    axes.set(xlim=(middle[0] - half[0], middle[0] + half[0]), ylim=(middle[1] - half[1], middle[1] + half[1]))
    axes.set_zlim(middle[2] - half[2], middle[2] + half[2])
    axes.set_box_aspect(half, zoom=0.88)
