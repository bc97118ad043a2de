"""Which pairs of components a detector compares, and why it leaves out the others, as text and as JSON."""

from dataclasses import asdict
from typing import Any

from ikde.formats.units import LENGTHS_M
from ikde.model.collision_model import CollisionModel
from ikde.model.pairs import explain_no_detector
from ikde.model.robot import NO_DETECTOR
from ikde.report.numbers import Units, format_fixed
from ikde.report.render import make_table, plain, render
from ikde.solver.check import compute_pairs
from ikde.solver.pair_verdicts import PairVerdict, judge_pairs
from ikde.solver.touching import CONFIGURATIONS, find_always_touching, find_standing


def pairs_json(collision: CollisionModel) -> dict[str, Any] | None:
    """What a detector compares, with the clearance at home in m, worst first, and what it leaves out; None for none."""
    if not collision.pairs:
        return None
    touching, verdicts = find_always_touching(collision), judge_pairs(collision)
    return {
        "detector": collision.name,
        "compared": [
            {"a": pair.a, "b": pair.b, "clearance_at_home_m": pair.clearance_m} | _touch_json(verdicts[pair.a, pair.b])
            for pair in compute_pairs(collision, collision.robot.home)
        ],
        "left_out": [asdict(pair) for pair in collision.left_out_pairs],
        "always_touching": [list(pair) for pair in touching.pairs] if touching else [],
        "to_add": list(touching.lines) if touching else [],
        "standing": [asdict(pair) for pair in find_standing(collision)],
    }


def describe_pairs(collision: CollisionModel) -> str:
    """How many pairs are compared and left out, what always touches, and how to see which they are."""
    seen = ["ikde robots show --pairs names them all, with the reasons"] if collision.pairs else []
    return "\n".join([_describe(collision), *_touching_lines(collision), *seen])


def format_pairs(collision: CollisionModel, units: Units, *, color: bool = False, width: int = 100) -> str:
    """What is checked, what always touches, and a table each of the pairs compared, worst first, and of those left out.

    Lines to copy stand alone, and are never wrapped.
    """
    if not collision.pairs:
        return _describe(collision)
    tables = [_compared_table(collision, units)]
    if collision.left_out_pairs:
        tables.append(_left_out_table(collision))
    lines = [_describe(collision), *_touching_lines(collision), *_standing_lines(collision, units)]
    return "\n".join([*lines, "", render(*tables, color=color, width=width)])


def _describe(collision: CollisionModel) -> str:
    if not collision.pairs:
        robot = collision.robot
        why = f" ({explain_no_detector(robot)})" if robot.default_detector == NO_DETECTOR else ""
        return f"no detector: self-collision is not checked{why}"
    compared, left_out = len(collision.pairs), len(collision.left_out_pairs)
    return f"collision: detector {collision.name} compares {compared} pair{'s' * (compared != 1)}, {left_out} left out"


def _touching_lines(collision: CollisionModel) -> list[str]:
    touching = find_always_touching(collision) if collision.pairs else None
    if touching is None:
        return []
    meant = f"if that is meant, {touching.remedy}{':' if touching.lines else ''}"
    return [str(touching), meant, *touching.lines]


def _standing_lines(collision: CollisionModel, units: Units) -> list[str]:
    """A line for each pair that no safe distance may reach."""
    return [
        f"{pair.a} - {pair.b} stand {units.format_length(pair.clearance_m)} apart in each of {CONFIGURATIONS:,} random "
        "configurations: with a safe distance as large, nothing is free"
        for pair in find_standing(collision)
    ]


def _compared_table(collision: CollisionModel, units: Units) -> Any:
    heads = ("pair", f">clearance at home [{units.length}]", "contact")
    table, verdicts = make_table(*heads, title="pairs compared"), judge_pairs(collision)
    for pair in compute_pairs(collision, collision.robot.home):
        gap = format_fixed(pair.clearance_m / LENGTHS_M[units.length], 2 if units.length == "mm" else 5)
        table.add_row(plain(f"{pair.a} - {pair.b}"), gap, describe_touch(verdicts[pair.a, pair.b]))
    return table


def describe_touch(verdict: PairVerdict) -> str:
    """In a word or two: `sometimes` was seen, the others are proved, or nothing else was seen."""
    if verdict.is_proved:
        return verdict.touches if verdict.touches == "sometimes" else f"{verdict.touches}, proved"
    return "always seen" if verdict.touches == "always" else "never seen"


def _touch_json(verdict: PairVerdict) -> dict[str, Any]:
    return {"touches": verdict.touches, "is_proved": verdict.is_proved}


def _left_out_table(collision: CollisionModel) -> Any:
    table = make_table("pair", "why", title="pairs left out")
    for pair in collision.left_out_pairs:
        table.add_row(plain(f"{pair.a} - {pair.b}"), plain(pair.reason))
    return table
