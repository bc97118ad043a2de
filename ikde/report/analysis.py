"""How well a robot moves, as text and as plain data."""

from math import isfinite
from typing import Any

from ikde.kernels.arrays import Floats
from ikde.model.robot import Robot
from ikde.report.geometry import joints_json
from ikde.report.numbers import Units, significant
from ikde.report.render import make_table, plain, render
from ikde.solver.analysis import Analysis, ByPart, LimitMargin
from ikde.solver.measures import Measures


def analysis_json(analysis: Analysis, convention: str | None = None) -> dict[str, Any]:
    """An analysis as plain data, m, rad and s; null for what is infinite or not defined."""
    robot = analysis.robot
    return {
        "robot": robot.name,
        "tool": robot.tool,
        **joints_json(robot, analysis.q, convention),
        "outside_limits": list(analysis.outside_limits),
        "by": analysis.by,
        "columns": list(analysis.names),
        "speed_limits": analysis.speeds.tolist(),
        "length_m": analysis.length_m,
        "scaled": _parts_json(analysis.scaled),
        "raw": _parts_json(analysis.raw),
        "jacobian_scaled": analysis.jacobian.tolist(),
        "additions": [
            {"name": own.name, "pose": own.pose, "translation": own.translation, "rotation": own.rotation}
            for own in analysis.additions
        ],
        "limit_margin": analysis.limit_margin,
        "limits": [_limit_json(margin) for margin in analysis.limits],
    }


def _parts_json(parts: ByPart) -> dict[str, Any]:
    return {part: {rows: _measures_json(own) for rows, own in kinds.items()} for part, kinds in parts.items()}


def _measures_json(own: Measures) -> dict[str, Any]:
    return {
        "manipulability": float(own.manipulability),
        "determinant": float(own.determinant),
        "condition": _finite(own.condition),
        "smallest_singular_value": float(own.smallest),
        "singular_values": own.singular_values.tolist(),
    }


def _limit_json(margin: LimitMargin) -> dict[str, Any]:
    ends = {"below": _finite(margin.below), "above": _finite(margin.above)}
    return {"joint": margin.joint, **ends, "share": margin.share}


def _finite(value: float | Floats) -> float | None:
    return float(value) if isfinite(value) else None


def format_analysis(analysis: Analysis, units: Units, *, color: bool = False, width: int = 100) -> str:
    """An analysis for the terminal: measures by part, what each column adds, and the room to the joint limits."""
    robot = analysis.robot
    head = f"robot {plain(robot.name)}, tool {plain(robot.tool)}, moved by its {_describe(analysis)}"
    scale = f"at the speed limits of all, a radian counted as {units.format_length(analysis.length_m)}"
    outside = f"[yellow]outside the limits[/]: {plain(', '.join(analysis.outside_limits))}"
    tables = [
        _measure_table(analysis.scaled, scale),
        _value_table(analysis.scaled),
        _measure_table(analysis.raw, "by a m or a rad of each, as they are"),
        _addition_table(analysis),
        _limit_table(robot, analysis, units),
    ]
    return render(head, *([outside] if analysis.outside_limits else []), *tables, color=color, width=width)


def _describe(analysis: Analysis) -> str:
    """What moves it; without a base these are the joints in each case."""
    words = {"joints": "joints", "twist": "base's twist and joints", "actuators": "wheels and joints"}
    return words[analysis.by if "base" in analysis.scaled else "joints"]


def _measure_table(parts: ByPart, title: str) -> Any:
    table = make_table("moves", "what", ">manipulability", ">det(J J^T)", ">condition", ">from singular", title=title)
    for part, kinds in parts.items():
        for rows, own in kinds.items():
            figures = own.manipulability, own.determinant, own.condition, own.smallest
            table.add_row(part, rows, *(_figure(float(value)) for value in figures))
    return table


def _value_table(parts: ByPart) -> Any:
    title = "singular values, the semi-axes of the ellipsoid of velocities"
    table = make_table("moves", "what", *(f">{k}" for k in range(1, 7)), title=title)
    for part, kinds in parts.items():
        for rows, own in kinds.items():
            table.add_row(part, rows, *map(_figure, own.singular_values.tolist()))
    return table


def _figure(value: float) -> str:
    return significant(value) if isfinite(value) else "inf"


def _addition_table(analysis: Analysis) -> Any:
    title = "what each adds: the share of manipulability that is lost without it"
    table = make_table("column", ">pose", ">translation", ">rotation", title=title)
    for own in analysis.additions:
        table.add_row(plain(own.name), *map(_share, (own.pose, own.translation, own.rotation)))
    return table


def _share(value: float | None) -> str:
    return "singular" if value is None else f"{100.0 * value:.1f} %"


def _limit_table(robot: Robot, analysis: Analysis, units: Units) -> Any:
    table = make_table("joint", ">from lower", ">from upper", "unit", ">of its range", title="room to the joint limits")
    for joint, margin in zip(robot.joints, analysis.limits, strict=True):
        ends = [
            f"{units.joint_value(joint, end):.4g}" if isfinite(end) else "none" for end in (margin.below, margin.above)
        ]
        share = f"{100.0 * margin.share:.1f} %" if isfinite(margin.below) else ""
        table.add_row(plain(joint.name), *ends, units.joint_unit(joint), share)
    return table
