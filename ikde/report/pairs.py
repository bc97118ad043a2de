"""Which pairs of components a detector compares, and why it leaves out the others, as text and as JSON."""

from typing import Any

from ikde.io.units import LENGTHS_M
from ikde.model.pairs import explain_no_detector
from ikde.model.robot import Detector, Robot
from ikde.report.render import make_table, plain, render
from ikde.report.units import Units, format_fixed
from ikde.solver.check import compute_pairs
from ikde.solver.touching import find_always_touching


def pairs_json(robot: Robot, detector: Detector | None) -> dict[str, Any] | None:
    """What a detector compares, with the clearance at home in m, worst first, and what it leaves out; None for none."""
    if detector is None:
        return None
    touching = find_always_touching(robot, detector)
    return {
        "detector": detector.name,
        "compared": [
            {"a": pair.a, "b": pair.b, "clearance_at_home_m": pair.clearance_m}
            for pair in compute_pairs(robot, detector, robot.home)
        ],
        "left_out": [{"a": p.a, "b": p.b, "reason": p.reason} for p in robot.left_out_pairs(detector)],
        "always_touching": [list(pair) for pair in touching.pairs] if touching else [],
        "to_add": list(touching.lines) if touching else [],
    }


def format_pairs(
    robot: Robot, detector: Detector | None, units: Units, *, color: bool = False, width: int = 100
) -> str:
    """What is checked, what always touches, and a table each of the pairs compared, worst first, and of those left out.

    Lines to copy stand alone, and are never wrapped.
    """
    if detector is None:
        return _describe(robot, detector)
    tables = [_compared_table(robot, detector, units)]
    if robot.left_out_pairs(detector):
        tables.append(_left_out_table(robot, detector))
    lines = [_describe(robot, detector), *_touching_lines(robot, detector)]
    return "\n".join([*lines, "", render(*tables, color=color, width=width)])


def _describe(robot: Robot, detector: Detector | None) -> str:
    if detector is None:
        why = f" ({explain_no_detector(robot)})" if robot.detector(None) is None else ""
        return f"no detector: self-collision is not checked{why}"
    compared, left_out = len(robot.pairs(detector)), len(robot.left_out_pairs(detector))
    return f"collision: detector {detector.name} compares {compared} pair{'s' * (compared != 1)}, {left_out} left out"


def _touching_lines(robot: Robot, detector: Detector) -> list[str]:
    touching = find_always_touching(robot, detector)
    if touching is None:
        return []
    meant = f"if that is meant, {touching.remedy}{':' if touching.lines else ''}"
    return [str(touching), meant, *touching.lines]


def _compared_table(robot: Robot, detector: Detector, units: Units) -> Any:
    table = make_table("pair", f">clearance at home [{units.length}]", title="pairs compared")
    for pair in compute_pairs(robot, detector, robot.home):
        gap = format_fixed(pair.clearance_m / LENGTHS_M[units.length], 2 if units.length == "mm" else 5)
        table.add_row(plain(f"{pair.a} - {pair.b}"), gap)
    return table


def _left_out_table(robot: Robot, detector: Detector) -> Any:
    table = make_table("pair", "why", title="pairs left out")
    for pair in robot.left_out_pairs(detector):
        table.add_row(plain(f"{pair.a} - {pair.b}"), plain(pair.reason))
    return table
