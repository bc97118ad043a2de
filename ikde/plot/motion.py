"""Figures of a motion: its path in space; over time what is left before its limits, errors, joints and base."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.plot.charts import Line, Panel, plot_panels
from ikde.plot.images import INK
from ikde.plot.style import COLORS, Axis, drawing_space, set_box
from ikde.track.summary import TrackSummary

MM, DEG = 1e3, 180.0 / np.pi
NEGLIGIBLE_M, NEGLIGIBLE_RAD = 1e-9, 1e-9  # an error that stays below is no curve: it is rounding
MAX_STAIRS = 200  # more cannot be seen
MIN_PLACE_MM, MIN_ROTATION_DEG, MIN_RATE = 1.0, 1.0, 0.1  # what an axis spans at least; rates in mm/s and deg/s
MAX_NAME_LENGTH = 26  # letters of a joint's name for which there is room above half a figure
ARM_IN = 1.55  # height of a joint's chart
TIME = Axis(label="t", unit="s")

Shown = tuple[str, float]
"""Unit of an axis, and what it spans at least."""


def plot_path(motion: TrackSummary) -> Any:
    """The path asked for, where the tool went, and where the base drove if it can, in the world, m."""
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
        box = np.concatenate(points)
        low, high = box.min(axis=0), box.max(axis=0)
        middle, half = 0.5 * (low + high), 0.55 * np.maximum(high - low, 0.15 * float((high - low).max()) + 1e-3)
        set_box(axes, middle - half, middle + half, zoom=0.88)
    return figure


def plot_margins(motion: TrackSummary) -> Any:
    """What is left before a limit, of the worst pair or joint: clearance, range, and share of the speed limit used."""
    times, robot = motion.trajectory.times_s, motion.robot
    panels = _list_clearance_panels(motion)
    width = robot.upper - robot.lower
    counted = (width > 0.0) & np.isfinite(width) & ~np.isin(robot.joint_names, motion.trajectory.base_joints[:2])
    if counted.any():
        q = motion.trajectory.q[:, counted]
        left = np.minimum(q - robot.lower[counted], robot.upper[counted] - q) / width[counted]
        line = Line(label="", x=times, y=100.0 * left.min(axis=1))
        panels.append(Panel(y=Axis(label="range left", unit="%"), lines=[line], bounds=[0.0]))
    limit = motion.limits.speed
    if limit is not None and len(motion.grade.driven) and (bound := (limit > 0.0) & np.isfinite(limit)).any():
        share = (np.abs(motion.grade.driven[:, bound]) / limit[bound]).max(axis=1)
        steps, used = _in_steps(motion, 100.0 * share[:, None])
        line = Line(label="", x=steps, y=used[:, 0])
        panels.append(Panel(y=Axis(label="speed", unit="% of limit"), lines=[line], bounds=[100.0]))
    return plot_panels(panels, x=TIME) if panels else None


def plot_errors(motion: TrackSummary) -> Any:
    """How far the tool is from its path: along each axis at the samples, its orientation, and half-way between them.

    Errors at the samples that stay negligible are left out; None if nothing else is there.
    """
    graded, times, limits = motion.grade, motion.trajectory.times_s, motion.limits
    panels = []
    if graded.largest_axis_error_m >= NEGLIGIBLE_M:
        sizes = MM * np.maximum(np.abs(graded.error_m), NEGLIGIBLE_M)
        lines = [Line(label=axis, x=times, y=sizes[:, k]) for k, axis in enumerate("xyz")]
        y, bounds = Axis(label="error", unit="mm", log=True), [MM * limits.position_error_m]
        panels.append(Panel(y=y, lines=lines, bounds=bounds, bound="tolerance"))
    if motion.trajectory.path.orientation != "free" and graded.largest_orientation_error_rad >= NEGLIGIBLE_RAD:
        turn = DEG * np.maximum(graded.orientation_error_rad, NEGLIGIBLE_RAD)
        y, bounds = Axis(label="turned by", unit="deg", log=True), [DEG * limits.orientation_error_rad]
        panels.append(Panel(y=y, lines=[Line(label="", x=times, y=turn)], bounds=bounds, bound="tolerance"))
    if len(motion.trajectory.deviation_m):
        between = Line(label="", x=_middles(motion), y=MM * motion.trajectory.deviation_m)
        panels.append(Panel(y=Axis(label="off path", unit="mm", limits=(0.0, None)), lines=[between]))
    return plot_panels(panels, x=TIME) if panels else None


def plot_joints(motion: TrackSummary) -> Any:
    """Joint values of the arm with the ends of their ranges; None without an arm."""
    values = motion.trajectory.times_s, motion.trajectory.q
    return _plot_arm(motion, *values, _ranges(motion), ("deg", MIN_ROTATION_DEG), ("mm", MIN_PLACE_MM))


def plot_joint_speeds(motion: TrackSummary) -> Any:
    """Joint speeds of the arm with their limits; None without an arm."""
    values = _in_steps(motion, motion.grade.speeds)
    return _plot_arm(motion, *values, _speed_bounds(motion), ("deg/s", MIN_RATE), ("mm/s", MIN_RATE))


def plot_base(motion: TrackSummary) -> Any:
    """The base's place, its speeds and, if known, its wheels', with their limits; None without a base."""
    trajectory = motion.trajectory
    if not trajectory.base_joints:
        return None
    x, y, heading = (motion.robot.joint_names.index(name) for name in trajectory.base_joints)
    times, q = trajectory.times_s, trajectory.q
    place = [Line(label=name, x=times, y=q[:, joint]) for name, joint in (("x", x), ("y", y))]
    yaw = Line(label="", x=times, y=DEG * q[:, heading])
    ends = DEG * _ranges(motion)[heading]
    panels = [
        Panel(y=Axis(label="place", unit="m"), lines=place, min_span=MIN_PLACE_MM / MM),
        Panel(y=Axis(label="heading", unit="deg"), lines=[yaw], bounds=ends, min_span=MIN_ROTATION_DEG),
    ]
    return plot_panels([*panels, *_speed_panels(motion, x, heading)], x=TIME)


def _speed_panels(motion: TrackSummary, x: int, heading: int) -> list[Panel]:
    trajectory, bounds = motion.trajectory, _speed_bounds(motion)
    labels = ("",) if trajectory.drive == "differential" else ("v along x", "v along y")
    times, v = _in_steps(motion, trajectory.v.reshape(-1, len(labels)))
    _, omega = _in_steps(motion, trajectory.omega[:, None])
    lines = [Line(label=label, x=times, y=v[:, k]) for k, label in enumerate(labels)]
    yaw_rate = Line(label="", x=times, y=DEG * omega[:, 0])
    panels = [
        Panel(y=Axis(label="v", unit="m/s"), lines=lines, bounds=bounds[x]),
        Panel(y=Axis(label="ω", unit="deg/s"), lines=[yaw_rate], bounds=DEG * bounds[heading], min_span=MIN_RATE),
    ]
    if trajectory.wheel_speeds is not None:
        _, speeds = _in_steps(motion, trajectory.wheel_speeds)
        wheels = [Line(label=f"{side} wheel", x=times, y=speeds[:, k]) for k, side in enumerate(("left", "right"))]
        limit = _both(motion.wheel_limit_rad_s)
        panels.append(Panel(y=Axis(label="wheels", unit="rad/s"), lines=wheels, bounds=limit))
    return panels


def _list_clearance_panels(motion: TrackSummary) -> list[Panel]:
    """Clearance at the samples, and what it is certain not to fall below between them; none without a detector.

    In a world that to itself and that to the world, each with the moment of its least.
    """
    collision, gaps, proof = motion.collision, motion.grade.gaps_m, motion.certificate
    if not gaps.size:
        return []
    own, times = len(collision.pairs), motion.trajectory.times_s
    certified = None if proof is None else proof.segment_m if proof.own_m is None else proof.own_m
    title = "clearance" if not collision.obstacles else "to itself"
    wrong = times[(gaps[:, :own] <= collision.limit_m).any(axis=1)].tolist()
    bounds = {"bounds": [MM * collision.limit_m], "bound": "safe distance"}
    lines = _list_clearances(motion, gaps[:, :own].min(axis=1), certified)
    panels = [Panel(y=Axis(label=title, unit="mm"), lines=lines, marks=wrong, **bounds)]
    if motion.closest_obstacle is not None:
        panels.append(_plot_world(motion, *motion.closest_obstacle))
    return panels


def _plot_world(motion: TrackSummary, sample: int, place: int) -> Panel:
    """Clearance to the world, where the least room is marked, and the margin, if all keep the same."""
    collision, times, own = motion.collision, motion.trajectory.times_s, len(motion.collision.pairs)
    gaps = motion.grade.gaps_m[:, own:]
    compared = np.isfinite(gaps).all(axis=0)
    kept = np.unique(collision.extras_m[own:][compared] + collision.limit_m)
    least = (gaps[:, compared] + collision.extras_m[own:][compared]).min(axis=1)
    clearance_m = motion.grade.gaps_m[sample, place] + collision.extra_m(place)
    return Panel(
        y=Axis(label="to the world", unit="mm"),
        lines=_list_clearances(motion, least, motion.certificate.world_m if motion.certificate else None),
        bounds=[MM * kept[0]] if len(kept) == 1 else [],
        bound="margin",
        marks=times[[bool(names) for names in motion.touched]].tolist(),
        spot=(float(times[sample]), MM * float(clearance_m)),
        spot_label="least room of the world",
    )


def _list_clearances(motion: TrackSummary, sampled_m: Floats, certified_m: Floats | None) -> list[Line]:
    """At the samples, and certified between them, if anything is."""
    lines = [Line(label="at samples", x=motion.trajectory.times_s, y=MM * sampled_m)]
    if certified_m is not None:
        times, between = _in_steps(motion, np.where(np.isfinite(certified_m), certified_m, np.nan)[:, None])
        lines.append(Line(label="certified between them", x=times, y=MM * between[:, 0]))
    return lines


def _plot_arm(
    motion: TrackSummary, times: Floats, values: Floats, bounds: Sequence[Floats], angle: Shown, length: Shown
) -> Any:
    """One small chart a joint of the arm, two side by side if their names are short; None for a base alone."""
    panels = []
    for joint in motion.arm:
        is_prismatic = motion.robot.joints[joint].kind == "prismatic"
        scale, (unit, span) = (MM, length) if is_prismatic else (DEG, angle)
        line = Line(label="", x=times, y=scale * values[:, joint])
        ends = scale * bounds[joint]
        name = motion.robot.joint_names[joint]
        panels.append(Panel(y=Axis(label=unit), lines=[line], bounds=ends, title=name, min_span=span))
    if not panels:
        return None
    columns = 2 if len(panels) > 1 and all(len(panel.title) <= MAX_NAME_LENGTH for panel in panels) else 1
    return plot_panels(panels, x=TIME, columns=columns, height_in=ARM_IN)


def _ranges(motion: TrackSummary) -> list[Floats]:
    """Ends of each joint's range; of a rotation not those beyond a full turn: its curve would be pressed flat."""
    robot = motion.robot
    ends = np.column_stack([robot.lower, robot.upper])
    shown = np.abs(ends) <= np.where(robot.is_prismatic, np.finfo(float).max, 2.0 * np.pi)[:, None]
    return [row[kept] for row, kept in zip(ends, shown, strict=True)]


def _speed_bounds(motion: TrackSummary) -> list[Floats]:
    """Speed limits of each joint, both ways; none where there is none."""
    limits = motion.limits.speed
    return [_both(np.inf if limits is None else float(limits[k])) for k in range(len(motion.robot.joints))]


def _both(limit: float) -> Floats:
    return np.array([-limit, limit] if np.isfinite(limit) else [])


def _middles(motion: TrackSummary) -> Floats:
    """Moments half-way between samples [M], s."""
    times = motion.trajectory.times_s
    return 0.5 * (times[:-1] + times[1:])


def _in_steps(motion: TrackSummary, values: Floats) -> tuple[Floats, Floats]:
    """What holds from a sample to the next [M, n] as points of a staircase, or amid its steps if there are many."""
    times = motion.trajectory.times_s
    if len(values) > MAX_STAIRS:
        return _middles(motion), values
    return np.repeat(times, 2)[1:-1], np.repeat(values, 2, axis=0)
