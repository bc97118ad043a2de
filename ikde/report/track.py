"""A motion as text for the terminal and as plain data."""

from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

import numpy as np

from ikde import __version__
from ikde.kernels.arrays import Floats
from ikde.report.numbers import angle, fixed, length, seconds, significant
from ikde.report.render import make_table, plain, render
from ikde.track.plan import TrackPlan
from ikde.track.summary import TrackSummary, Worst

MM, DEG = 1e3, 180.0 / np.pi
WIDTH = 120
MIN_SINGULAR = 1e-12  # what is smaller is the rounding of 0
FIXED = "fixed base"

Row = tuple[str, str, str]
"""What was measured, how much it is, and what it may be."""


def track_json(plan: TrackPlan, motion: TrackSummary) -> dict[str, Any]:
    """A motion's figures as plain data: m, rad, s; None where there is nothing to measure or nothing was checked."""
    trajectory, graded, certificate = motion.trajectory, motion.grade, motion.certificate
    stop, steps_s = trajectory.stop, trajectory.seconds
    turned, wheeled = trajectory.path.orientation != "free", trajectory.drive == "differential"
    return {
        "ikde": __version__,
        "name": plan.name,
        "file": plan.file,
        "robot": motion.robot.name,
        "drive": trajectory.drive,
        "method": trajectory.method,
        "seed": plan.seed,
        "asked_start": None if plan.start is None else name_joints(motion, plan.start),
        "limits": _limits_json(motion),
        "detector": motion.collision.name if motion.collision.pairs else None,
        **_world_json(motion, plan.world_file),
        "dt_s": trajectory.path.dt_s,
        "points": trajectory.path.samples,
        "reached_points": trajectory.reached_points,
        "met_points": motion.met_points,
        "reached": trajectory.reached,
        "stop": None if stop is None else {**asdict(stop), "reason": str(stop.reason)},
        "start": name_joints(motion, trajectory.q[0]) if motion.started else None,
        "largest_error_m": dict(zip("xyz", motion.largest_axis_errors_m.tolist(), strict=True)),
        "largest_total_error_m": graded.total_error_m,
        "largest_orientation_error_rad": graded.largest_orientation_error_rad if turned else None,
        "violations": asdict(graded.violations),
        "accepted": graded.accepted,
        "fastest": _worst_json(motion.fastest),
        "largest_acceleration": _worst_json(motion.largest_acceleration),
        "largest_wheel_speed_rad_s": largest_wheel_speed(motion),
        "wheel_limit_rad_s": _finite(motion.wheel_limit_rad_s),
        "smallest_range_left": _worst_json(motion.range_left),
        "largest_prismatic_step_m": motion.largest_step("prismatic"),
        "largest_revolute_step_rad": motion.largest_step("revolute"),
        "clearance_m": graded.clearance_m,
        "closest_pair": list(motion.closest_pair) if motion.closest_pair else None,
        "certified_clearance_m": None if certificate is None else certificate.clearance_m,
        "largest_deviation_m": float(trajectory.deviation_m.max(initial=0.0)),
        "largest_deviation_rad": float(trajectory.deviation_rad.max(initial=0.0)) if turned else None,
        "largest_distance_m": motion.largest_distance_m,
        "largest_sideways_m_s": float(np.abs(graded.sideways_m_s).max(initial=0.0)) if wheeled else None,
        "smallest_singular_value": _finite(float(motion.singular_values.min(initial=np.inf))),
        "search_seconds": trajectory.search_seconds,
        "median_seconds": _quantile(steps_s, 0.5),
        "p99_seconds": _quantile(steps_s, 0.99),
    }


def format_track(plan: TrackPlan, motion: TrackSummary, *, color: bool = False, width: int = WIDTH) -> str:
    """A motion for the terminal: the verdict, what was measured beside what was asked."""
    verdict = _verdict(plan, motion)
    if not motion.started:
        return render(verdict, color=color, width=width)
    table = make_table("measured by plain numpy", ">", "asked for")
    for row in list_figures(motion):
        table.add_row(*map(plain, row))
    return render(verdict, table, color=color, width=width)


def _verdict(plan: TrackPlan, motion: TrackSummary) -> str:
    trajectory, graded = motion.trajectory, motion.grade
    of = f"of {trajectory.path.samples} points of {plain(plan.name)} by {plain(motion.robot.name)}"
    if trajectory.stop is not None:
        return f"[bold red]stopped after {trajectory.reached_points} {of}[/]\n{plain(trajectory.stop.line)}"
    of = f"{motion.met_points} {of}"
    if not graded.accepted:
        counts = asdict(graded.violations).items()
        broken = ", ".join(f"{name.replace('_', ' ')} {count} times" for name, count in counts if count)
        return f"[bold red]followed {of}, against its limits[/]: {broken}"
    base = trajectory.drive if trajectory.base_joints else FIXED
    unchecked = "" if graded.violations.collision is not None else ", [yellow]self-collision not checked[/]"
    return f"[bold green]followed[/]: {of}, {trajectory.path.duration_s:g} s, {base}{unchecked}"


def list_figures(motion: TrackSummary) -> Iterator[Row]:
    """What was measured, row by row; nothing about what does not apply."""
    trajectory, limits = motion.trajectory, motion.limits
    graded = motion.grade
    yield "points reached", str(motion.met_points), f"{trajectory.path.samples}"
    errors = [length(error) for error in motion.largest_axis_errors_m]
    along = f"{errors[0]} each" if len(set(errors)) == 1 else " / ".join(errors)
    yield "largest error along x / y / z", along, length(limits.position_error_m)
    yield "largest error in total", length(graded.total_error_m), ""
    if trajectory.path.orientation != "free":
        largest = graded.largest_orientation_error_rad
        yield "largest orientation error", angle(largest), angle(limits.orientation_error_rad)
    yield from _list_limits(motion)
    yield from _list_clearance(motion)
    if len(trajectory.deviation_m):
        off = length(float(trajectory.deviation_m.max()))
        if trajectory.path.orientation != "free":
            off += f", {angle(float(trajectory.deviation_rad.max()))}"
        yield "largest distance from the path between samples", off, ""
    if trajectory.drive == "differential":
        yield "sideways slip of the base", f"{_tiny(float(np.abs(graded.sideways_m_s).max(initial=0.0)))} m/s", "0"
    if motion.started:
        yield "smallest singular value of the arm", singular(float(motion.singular_values.min())), ""
    if len(trajectory.seconds):
        spread = " / ".join(seconds(float(np.quantile(trajectory.seconds, share))) for share in (0.5, 0.99))
        yield "time of a single step, median / p99", spread, seconds(trajectory.path.dt_s)
        yield "time of the whole search", seconds(trajectory.search_seconds), ""


def _list_limits(motion: TrackSummary) -> Iterator[Row]:
    """Ranges, the tool's distance, speeds, accelerations, wheels."""
    left, violations = motion.range_left, motion.grade.violations
    if motion.limits.ranges and left is not None:
        name, value, end = left
        scale, unit = (MM, "mm") if _is_prismatic(motion, name) else (DEG, "deg")
        outside = f", {violations.range} outside" if violations.range else ""
        yield f"joint-limit margin, {name}{outside}", f"{fixed(scale * value, 1)} {unit}", f"to {scale * end:g} {unit}"
    distance, most = motion.largest_distance_m, motion.limits.max_distance_m
    if distance is not None and most is not None:
        beyond = f", {violations.distance} beyond" if violations.distance else ""
        what = f"largest distance of the tool from {motion.limits.center}{beyond}"
        yield what, f"{MM * distance:.2f} mm", f"{MM * most:g} mm"
    for what, worst, per in (("speed", motion.fastest, "/s"), ("acceleration", motion.largest_acceleration, "/s²")):
        if worst is not None:
            name, value, limit = worst
            unit = ("m" if _is_prismatic(motion, name) else "rad") + per
            drives = name in motion.trajectory.base_joints[:2] and motion.trajectory.drive == "differential"
            share = f", {100.0 * value / limit:.0f} %" if 0.0 < limit < np.inf else ""
            yield f"largest {what}, {'base' if drives else name}{share}", f"{value:.4g} {unit}", f"{limit:.4g} {unit}"
    wheels = largest_wheel_speed(motion)
    if wheels is not None:
        own = motion.limits.wheel_speed_rad_s
        implied = "" if own is not None else ", implied"
        limit = motion.wheel_limit_rad_s
        yield "largest wheel speed", f"{wheels:.4g} rad/s", f"{limit:.4g} rad/s{implied}" if np.isfinite(limit) else ""


def _list_clearance(motion: TrackSummary) -> Iterator[Row]:
    """At the samples and between them."""
    collision, pair, clearance_m = motion.collision, motion.closest_pair, motion.grade.clearance_m
    if pair is None or clearance_m is None:
        yield "self-collision", "not checked", ""
        return
    count = motion.grade.violations.collision
    hits = f", {count} collide" if count else ""
    place = motion.closest_place or 0
    safe = f"above {MM * (collision.limit_m + collision.extra_m(place)):.6g} mm"
    yield f"clearance at samples, {pair[0]} and {pair[1]}{hits}", f"{gap_mm(clearance_m)} mm", safe
    if motion.certificate is not None:
        # The samples keep the safe distance; between them what is certified is that nothing touches.
        yield "clearance between samples, certified", f"{gap_mm(motion.certificate.clearance_m)} mm", "no contact"
        if collision.obstacles:
            room = f"{gap_mm(float(motion.certificate.room_m.min()))} mm"
            yield "between samples beyond margins to the world, certified", room, "above 0"


def largest_wheel_speed(motion: TrackSummary) -> float | None:
    """Rad/s of the faster wheel; None without wheels or a motion."""
    wheels = motion.trajectory.wheel_speeds
    return float(np.abs(wheels).max()) if wheels is not None and len(wheels) else None


def name_joints(motion: TrackSummary, q: Floats) -> dict[str, float]:
    """A configuration [N] by joint, m and rad."""
    return dict(zip(motion.robot.joint_names, q.tolist(), strict=True))


def singular(value: float, digits: int = 3) -> str:
    """A singular value; 0 if nothing but rounding tells it from 0."""
    return significant(value, digits) if value >= MIN_SINGULAR else "0"


def gap_mm(gap_m: float, digits: int = 2) -> str:
    """A gap in mm, as many digits as tell it from 0."""
    gap = MM * gap_m
    return significant(gap) if 0.0 < abs(gap) < 10.0**-digits else f"{gap:.{digits}f}"


def _limits_json(motion: TrackSummary) -> dict[str, Any]:
    """What the motion had to keep; None where anything goes."""
    data = asdict(motion.limits)
    for key in ("speed", "acceleration"):
        if data[key] is not None:
            data[key] = {joint: _finite(value) for joint, value in name_joints(motion, data[key]).items()}
    return data


def _world_json(motion: TrackSummary, file: str | None) -> dict[str, Any]:
    """The world by its file and digest, and what was to be kept from it; nothing without one."""
    collision, proof = motion.collision, motion.certificate
    if not collision.obstacles:
        return {}
    room_m = None if proof is None else float(proof.room_m.min())
    margins = {"margin_m": collision.margin_m, "margins_m": dict(collision.margins_m)}
    known = {"file": file, "digest": collision.world.digest, "moving": sorted(motion.trajectory.moving)}
    return {"world": {**known, **margins, "certified_room_m": room_m}}


def _is_prismatic(motion: TrackSummary, name: str) -> bool:
    return motion.robot.joints[motion.robot.joint_names.index(name)].kind == "prismatic"


def _worst_json(worst: Worst | None) -> dict[str, Any] | None:
    if worst is None:
        return None
    name, value, limit = worst
    return {"joint": name, "value": _finite(value), "limit": _finite(limit)}


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def _quantile(values: Any, share: float) -> float | None:
    return float(np.quantile(values, share)) if len(values) else None


def _tiny(value: float) -> str:
    return f"{value:.1e}" if value else "0"
