"""A solve's result as text and as JSON."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from ikde.errors import printable
from ikde.model.convention import convention_offsets, to_convention
from ikde.model.robot import Robot
from ikde.report.geometry import joints_json
from ikde.report.numbers import Units, count_of, format_fixed, seconds, significant
from ikde.report.render import make_table, plain, render
from ikde.solver.engine_table import label_engine
from ikde.solver.preferred import Preferred
from ikde.solver.result import SolveResult

BAR = 21  # columns of a joint's bar
TIMES = ("solve_seconds", "compile_seconds")


@dataclass(frozen=True, slots=True, kw_only=True)
class Spent:
    """What several solutions took together: they are chosen from many solves, of which each has little to say."""

    solve_seconds: float
    """Wall time of all that was solved, with loading and grading, without compiling."""
    compile_seconds: float


def solve_json(robot: Robot, result: SolveResult, convention: str | None = None) -> dict[str, Any]:
    """A result as plain data: m, rad, s; `q` by joint name in the convention asked for."""
    return {
        "reached": result.reached,
        "stop_reason": str(result.stop_reason),
        "reason": result.reason,
        "hint": result.hint,
        "robot": robot.name,
        **joints_json(robot, result.q, convention),
        "position_error_m": result.position_error_m,
        "orientation_error_rad": result.orientation_error_rad,
        "motion": result.motion,
        "clearance_m": result.clearance_m,
        "closest_pair": list(result.closest_pair) if result.closest_pair else None,
        "nearest_obstacle": asdict(near) if (near := result.grade.nearest_obstacle) else None,
        "collision": result.collision,
        "outside_limits": list(result.grade.outside_limits),
        "method": result.method,
        "family": result.family,
        "settings": asdict(result.settings),
        "detector": result.detector,
        "seed": result.seed,
        "attempts": result.attempts,
        "rejected": result.rejected,
        "blocking_pairs": [{"a": a, "b": b, "count": n} for (a, b), n in result.blocking_pairs.items()],
        "evaluations": result.evaluations,
        "solve_seconds": result.solve_seconds,
        "compile_seconds": result.compile_seconds,
        "verified": result.verified,
        **({} if result.preferred is None else {"preferred": asdict(result.preferred)}),
        **_goal_json(result),
    }


def _goal_json(result: SolveResult) -> dict[str, Any]:
    """Of a goal with freedom: the exact pose that was drawn, which alternative it belongs to, and how many were."""
    if result.region is None:
        return {}
    target = result.target
    pose = {
        "kind": target.kind,
        "position": target.p_world_tool.tolist(),
        "rotation": None if target.kind == "position" else target.R_world_tool.tolist(),
    }
    return {"goal": {"alternative": result.alternative, "poses": result.poses, "target": pose}}


def solutions_json(
    robot: Robot, results: Sequence[SolveResult], spent: Spent, convention: str | None = None
) -> dict[str, Any]:
    """Several solutions as plain data: the first, with what all took together, and all of them, without times."""
    rows = [solve_json(robot, result, convention) for result in results]
    return {**rows[0], **asdict(spent), "solutions": [{k: v for k, v in row.items() if k not in TIMES} for row in rows]}


def format_solutions(
    robot: Robot,
    results: Sequence[SolveResult],
    units: Units,
    spent: Spent,
    *,
    convention: str | None = None,
    color: bool = False,
    width: int = 100,
) -> str:
    """Several solutions for the terminal, one below the other, and what they took together."""
    look: dict[str, Any] = {"convention": convention, "color": color, "width": width}
    pages = [format_solve(robot, result, units, timed=False, **look) for result in results]
    numbered = [f"{_count_solution(robot, k, len(results))}\n{page}" for k, page in enumerate(pages, 1)]
    compiled = f", after {seconds(spent.compile_seconds)} of compiling" if spent.compile_seconds else ""
    together = f"together {seconds(spent.solve_seconds)}, with loading and grading{compiled}"
    return "\n\n".join([*numbered, together])


def _count_solution(robot: Robot, number: int, count: int) -> str:
    return f"solution {number} of {count}, robot {printable(robot.name)}"


def format_solve(
    robot: Robot,
    result: SolveResult,
    units: Units,
    *,
    convention: str | None = None,
    color: bool = False,
    width: int = 100,
    timed: bool = True,
) -> str:
    """A result for the terminal: the verdict, the joints within their ranges, the graded figures, the cost.

    `timed`: with the seconds that it took.
    """
    mark, style = ("reached", "bold green") if result.reached else ("not reached", "bold red")
    lines = [f"[{style}]{mark}[/] by {plain(robot.name)}: {plain(result.reason)}"]
    if result.hint:
        lines.append(f"[yellow]what would help[/]: {plain(result.hint)}")
    tables = _joint_table(robot, result, units, convention), _grade_table(result, units, timed)
    return render(*lines, *tables, color=color, width=width)


def _joint_table(robot: Robot, result: SolveResult, units: Units, convention: str | None) -> Any:
    name = f" ({convention} convention)" if convention not in (None, robot.convention) else ""
    table = make_table(f"joint{name}", ">value", "unit", ">lower", "?", ">upper")
    offsets = convention_offsets(robot, convention)
    shown = to_convention(robot, result.q, convention)
    for joint, value, own, offset in zip(robot.joints, shown, result.q, offsets, strict=True):
        limits = [units.format_limit(joint, limit, 4) for limit in (joint.lower, joint.upper)]
        lower, upper = ("", "") if offset else limits  # shifted limits, brought to (-pi, pi], are no interval
        number = format_fixed(units.joint_value(joint, value), 6)
        bar = "" if joint.kind == "continuous" else _bar(own, joint.lower, joint.upper)
        table.add_row(plain(joint.name), number, units.joint_unit(joint), lower, bar, upper)
    return table


def _bar(value: float, lower: float, upper: float) -> str:
    """Where a value stands in its range: `──────●──────────────`."""
    share = 0.5 if upper <= lower else float(np.clip((value - lower) / (upper - lower), 0.0, 1.0))
    at = round(share * (BAR - 1))
    return "─" * at + "●" + "─" * (BAR - 1 - at)


def _tell_self(result: SolveResult) -> str:
    obstacles = set(result.obstacles)
    return COLLISIONS[any(pair[1] not in obstacles for pair in result.grade.colliding_pairs)]


def _tell_world(result: SolveResult, units: Units) -> str:
    """What touches, or that nothing does, and what is nearest."""
    obstacles = set(result.obstacles)
    touching = [f"{a} - {b}" for a, b in result.grade.colliding_pairs if b in obstacles]
    if touching:
        return f"in collision: {', '.join(touching[:3])}{f' and {len(touching) - 3} more' * (len(touching) > 3)}"
    free, near = f"free of {count_of(len(obstacles), 'obstacle')}", result.grade.nearest_obstacle
    if near is None:
        return f"{free}; nothing that moves is compared with any"
    asked = f", {units.format_length(near.margin_m)} asked for" if near.margin_m > 0.0 else ""
    return f"{free}, nearest {near.component} - {near.obstacle}: {units.format_length(near.clearance_m)}{asked}"


GRADERS = {
    True: "by the kernels, and again by separate code in numpy",
    False: "by the kernels; separate code in numpy disagrees",
    None: "by the kernels alone",
}
COLLISIONS = {True: "yes", False: "no", None: "not checked"}


def _tell_goal(result: SolveResult, units: Units) -> str:
    """Which exact pose of a goal with freedom was drawn."""
    assert result.region is not None
    many, place = (
        len(result.region.parts),
        ", ".join(units.format_length(x) for x in result.target.p_world_tool.tolist()),
    )
    which = f"alternative {1 + (result.alternative or 0)} of {many}, " if many > 1 else ""
    return f"{which}{count_of(result.poses or 0, 'pose')} tried; errors are from the one at {place}"


def _tell_preferred(preferred: Preferred, units: Units) -> str:
    """What the answer was moved for, and how much it has of that: before and after."""
    words = {
        "manipulability": ("manipulability", significant),
        "clearance": ("room beyond what is asked for", units.format_length),
        "limits": ("room to the joint limits", lambda share: f"{100.0 * share:.3g} % of a range"),
        "motion": ("motion", significant),
    }
    name, show = words[preferred.what]
    optimum = ", a local optimum" if preferred.settled else ""
    if not preferred.steps:
        return f"{name} {show(preferred.after)}{optimum}"
    steps = count_of(preferred.steps, "step")
    return f"{name} {show(preferred.before)} -> {show(preferred.after)} in {steps}{optimum}"


def _grade_table(result: SolveResult, units: Units, timed: bool) -> Any:
    table = make_table("graded", GRADERS[result.verified])
    table.add_row("position error", units.format_error(result.position_error_m))
    asked = result.target.kind != "position"
    table.add_row("orientation error", units.format_angle(result.orientation_error_rad) if asked else "not asked for")
    if result.clearance_m is None or result.closest_pair is None:
        table.add_row("clearance", plain(f"not checked (detector {result.detector})"))
    else:
        between = f"between {' and '.join(result.closest_pair)}, detector {result.detector}"
        table.add_row("clearance", plain(f"{units.format_length(result.clearance_m)} {between}"))
    if result.region is not None:
        table.add_row("goal", plain(_tell_goal(result, units)))
    table.add_row("motion", f"{result.motion:.6g} from {'home' if result.near is None else 'near'}, weighted")
    if result.preferred is not None:
        table.add_row("preferred", _tell_preferred(result.preferred, units))
    if result.obstacles:
        table.add_row("self-collision", _tell_self(result))
        table.add_row("world", plain(_tell_world(result, units)))
    else:
        table.add_row("self-collision", COLLISIONS[result.collision])
    table.add_row("outside limits", plain(", ".join(result.grade.outside_limits) or "none"))
    rejected = f", {result.rejected} rejected for collision" if result.rejected else ""
    attempts = f"{count_of(result.attempts, 'attempt')}{rejected}"
    took = f"{seconds(result.solve_seconds)}, " if timed else ""
    table.add_row("cost", f"{took}{count_of(result.evaluations, 'evaluation')} in {attempts}")
    if result.compile_seconds and timed:
        table.add_row("compiled first", f"{result.compile_seconds:.1f} s")
    table.add_row("engine", label_engine(result.method).format(de=result.settings.evolution))
    if result.family:
        table.add_row("family", f"{result.family} (shoulder, elbow, wrist)")
    table.add_row("repeat with", f"the same command, seed {result.seed}: the same bits")
    return table
