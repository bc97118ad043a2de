"""Frames and clearances as text and as JSON."""

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from ikde.formats.units import LENGTHS_M
from ikde.kernels.arrays import Floats
from ikde.model.convention import to_convention
from ikde.model.robot import Robot
from ikde.report.numbers import Units, format_fixed
from ikde.report.render import make_table, plain, render
from ikde.solver.check import CheckResult

SHOWN = 30  # obstacles in a table for the terminal
COLLIDES = "[red]collides[/]"
BESIDE = 95  # columns in which a frame's axes stand beside its origin


def joints_json(robot: Robot, q: Floats, convention: str | None) -> dict[str, Any]:
    """A configuration by joint in the convention asked for, with its name."""
    shown = to_convention(robot, q, convention).tolist()
    return {"convention": convention or robot.convention, "q": dict(zip(robot.joint_names, shown, strict=True))}


def forward_json(
    robot: Robot, q: Floats, Ts_world: Mapping[str, Floats], outside: tuple[str, ...], convention: str | None = None
) -> dict[str, Any]:
    """Frames by name: `p_world` [3] in m and `R_world` [3][3]; q in the convention asked for."""
    return {
        "robot": robot.name,
        **joints_json(robot, q, convention),
        "outside_limits": list(outside),
        "frames": {name: {"p_world": T[:3, 3].tolist(), "R_world": T[:3, :3].tolist()} for name, T in Ts_world.items()},
    }


def format_forward(
    robot: Robot,
    Ts_world: Mapping[str, Floats],
    outside: tuple[str, ...],
    units: Units,
    *,
    color: bool = False,
    width: int = 100,
) -> str:
    """Frames for the terminal: origin, and the directions of their x and z axes: beside it, or below."""
    unit = units.length
    names, axes = [f">{axis} [{unit}]" for axis in "xyz"], ["x axis", "z axis"]
    if width >= BESIDE:
        tables = [make_table("frame", *names, *axes)]
    else:
        tables = [make_table("frame", *names), make_table("frame", *axes)]
    for name, T in Ts_world.items():
        digits = 1 if unit == "mm" else 4
        origin = [format_fixed(value / LENGTHS_M[unit], digits) for value in T[:3, 3]]
        directions = [_direction(T[:3, k], 3 if width >= BESIDE else 2) for k in (0, 2)]
        for table, cells in zip(
            tables, [[*origin, *directions]] if len(tables) == 1 else [origin, directions], strict=True
        ):
            table.add_row(plain(name), *cells)
    return render(f"robot {plain(robot.name)}", *tables, *_outside_line(outside), color=color, width=width)


def _direction(axis: Floats, digits: int) -> str:
    return " ".join(format_fixed(value, digits).rjust(digits + 3) for value in axis)


def _outside_line(outside: tuple[str, ...]) -> list[str]:
    return [f"[yellow]outside the limits[/]: {plain(', '.join(outside))}"] if outside else []


def check_json(robot: Robot, result: CheckResult, convention: str | None = None) -> dict[str, Any]:
    """A check as plain data; pairs worst first, lengths in m, q in the convention asked for; None: not checked."""
    return {
        "robot": robot.name,
        "detector": result.detector,
        "safe_distance_m": result.safe_distance_m,
        "collision": result.collision,
        "clearance_m": result.clearance_m,
        "closest_pair": list(result.closest_pair) if result.closest_pair else None,
        "pairs": [asdict(pair) for pair in result.pairs],
        "obstacles": [asdict(pair) for pair in result.obstacles],
        **joints_json(robot, result.q, convention),
        "outside_limits": list(result.outside_limits),
    }


def format_check(robot: Robot, result: CheckResult, units: Units, *, color: bool = False, width: int = 100) -> str:
    """A check for the terminal: the verdict with the robot, and every pair, worst first."""
    if result.clearance_m is None:
        verdict = (
            f"[bold yellow]self-collision not checked[/]: robot {plain(robot.name)}, detector {plain(result.detector)}"
        )
        return render(verdict, *_outside_line(result.outside_limits), color=color, width=width)
    head = f"{_tell_verdict(result)}: robot {plain(robot.name)}, clearance {units.format_length(result.clearance_m)}"
    head += f" between {plain(' and '.join(result.closest_pair))}" if result.obstacles and result.closest_pair else ""
    head += f", detector {plain(result.detector)}"
    if result.safe_distance_m:
        head += f", safe distance {units.format_length(result.safe_distance_m)}"
    tables = [make_table("pair", f">clearance [{units.length}]", "")]
    for pair in result.pairs:
        gap = _format_gap(pair.clearance_m, units)
        tables[0].add_row(plain(f"{pair.a} - {pair.b}"), gap, COLLIDES if pair.collides else "")
    if result.obstacles:
        tables.append(
            make_table("component - obstacle", f">clearance [{units.length}]", f">margin [{units.length}]", "")
        )
    for other in result.obstacles[:SHOWN]:
        gaps = [_format_gap(gap, units) for gap in (other.clearance_m, other.margin_m)]
        name = f"{other.component} - {other.obstacle}"
        tables[1].add_row(plain(name), *gaps, COLLIDES if other.collides else "")
    more = len(result.obstacles) - SHOWN
    rest = [f"and {more:,} more obstacles with more room; --json lists them all"] if more > 0 else []
    return render(head, *_outside_line(result.outside_limits), *tables, *rest, color=color, width=width)


def _tell_verdict(result: CheckResult) -> str:
    """What collides with what, or that nothing does."""
    own, others = any(pair.collides for pair in result.pairs), any(pair.collides for pair in result.obstacles)
    if own or others:
        words = [*(["self-collision"] if own else []), *(["collision with the world"] if others else [])]
        return f"[bold red]{' and '.join(words)}[/]"
    world = " and of the world" if result.obstacles else ""
    return f"[bold green]free of self-collision{world}[/]"


def _format_gap(gap_m: float, units: Units) -> str:
    return f"{gap_m / LENGTHS_M[units.length]:.{2 if units.length == 'mm' else 5}f}"
