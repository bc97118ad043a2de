"""That no pose of a region can be had: by bounds on the tool with the region's extent added, or by the tool's body.

A bound says how far a place is out of reach, and that changes by no more than the place moves: where the middle of a
cell is farther out than the cell is large, all of the cell is. Orientations likewise, by their angle.
"""

from collections import Counter
from typing import NamedTuple

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.bounds import find_bounds
from ikde.model.region import Region, RegionPart, has_freedom
from ikde.model.target import KINDS, TargetKind, Targets
from ikde.solver.digits import at_least
from ikde.solver.problem import Problem
from ikde.solver.region_draws import is_free_about_z
from ikde.solver.result import NO_SOLUTION, StopReason
from ikde.solver.tool_body import find_tool_body, measure_shortage

CELLS = 4  # along the longest edge of a box
NAMED = 3


class Cells(NamedTuple):
    """Targets that stand for all of a part: each of its poses is within the two distances of one of them."""

    targets: Targets
    radius_m: float
    angle_rad: float


class Proof(NamedTuple):
    """Why a region has no solution."""

    stop_reason: StopReason
    reason: str
    blocking: dict[tuple[str, str], int]


def prove_region(problem: Problem, region: Region) -> tuple[set[int], Proof | None]:
    """The alternatives that have no solution; and the proof, if none of them has."""
    cells = [cover(part) for part in region.parts]
    excesses = [_measure_excess(problem, each) for each in cells]
    excluded = {place for place, (far, off) in enumerate(excesses) if far > 0.0 or off > 0.0}
    if len(excluded) == len(cells):
        what = "every alternative" if len(region.parts) > 1 else "the target"
        what = "every pose of the region" if any(map(has_freedom, region.parts)) else what
        return excluded, Proof(StopReason.OUT_OF_REACH, _tell_excess(excesses, what), {})
    if not problem.collision.obstacles or find_tool_body(problem.collision.own) is None:
        return excluded, None
    shortages = {k: _measure_shortage(problem, each) for k, each in enumerate(cells) if k not in excluded}
    blocked = {k: short for k, short in shortages.items() if (short > 0.0).any(axis=(1, 2)).all()}
    excluded |= blocked.keys()
    return excluded, _tell_tool_body(problem, [*blocked.values()]) if len(excluded) == len(cells) else None


def cover(part: RegionPart) -> Cells:
    """Targets that stand for all of a part."""
    kind, angle = _find_extent(part)
    if part.rule == "look_at":
        return _cover_sight(part, angle)
    low, high = part.box_m.T
    width = high - low
    counts = np.maximum(1, np.ceil(CELLS * width / max(float(width.max()), 1e-300))).astype(int)
    steps = [low[k] + (np.arange(n) + 0.5) * width[k] / n for k, n in enumerate(counts.tolist())]
    middles = np.stack(np.meshgrid(*steps, indexing="ij"), axis=-1).reshape(-1, 3)
    places = part.target.p_world_tool + middles @ part.R_world_box.T
    return Cells(_stand(kind, part, places), 0.5 * float(np.linalg.norm(width / counts)), angle)


def _find_extent(part: RegionPart) -> tuple[TargetKind, float]:
    """What kind of target stands for a part, and by which angle its orientations may differ from that."""
    if part.rule == "rotation":
        return "pose", float(np.linalg.norm(np.abs(part.numbers).max(axis=1)))
    if part.rule == "turn":
        return ("axis", 0.0) if is_free_about_z(part) else ("pose", float(np.abs(part.numbers[3:]).max()))
    if part.rule in ("cone", "look_at"):
        return "axis", float(part.numbers[-1])
    return part.target.kind, 0.0


def _cover_sight(part: RegionPart, angle: float) -> Cells:
    low, high, _ = part.numbers.tolist()
    point, axis = part.target.p_world_tool, part.target.axis_world_tool
    radius = 0.5 * (high - low) + high * 2.0 * float(np.sin(0.5 * angle))
    if radius >= high:
        return Cells(_stand("axis", part, point[None]), high, angle)
    return Cells(_stand("axis", part, (point - 0.5 * (low + high) * axis)[None]), radius, angle)


def _stand(kind: TargetKind, part: RegionPart, places: Floats) -> Targets:
    R = np.broadcast_to(part.target.R_world_tool, (len(places), 3, 3))
    kinds = np.full(len(places), KINDS.index(kind))
    return Targets.packed(kinds, np.concatenate([R, places[:, :, None]], axis=2))


def _measure_excess(problem: Problem, cells: Cells) -> tuple[float, float]:
    """By how much all of a part is missed at least, m and rad; 0 where that is within the tolerance, or unknown."""
    settings = problem.settings
    far, off = find_bounds(problem.robot, problem.lower, problem.upper).excess_of_many(cells.targets)
    far_m, off_rad = float(far.min()) - cells.radius_m, float(off.min()) - cells.angle_rad
    return (
        far_m if far_m > settings.position_tolerance_m else 0.0,
        off_rad if off_rad > settings.orientation_tolerance_rad else 0.0,
    )


def _measure_shortage(problem: Problem, cells: Cells) -> Floats:
    """By how much the tool's body is too near at least in each cell [T, C, O], m."""
    body = find_tool_body(problem.collision.own)
    assert body is not None
    room = cells.radius_m + cells.angle_rad * float(np.linalg.norm(body.centres, axis=1).max())
    return measure_shortage(problem, cells.targets) - room


def _tell_excess(excesses: list[tuple[float, float]], what: str) -> str:
    far_m, off_rad = (min(values) for values in zip(*excesses, strict=True))
    if far_m > 0.0:
        return f"out of reach: {what} is at least {at_least(far_m)} m too far, whatever the joints do"
    if off_rad > 0.0:
        return f"out of reach: {what} is at least {at_least(off_rad)} rad off in orientation, whatever the joints do"
    parts = [f"{at_least(far)} m too far" if far > 0.0 else f"{at_least(off)} rad off" for far, off in excesses]
    more = f" and {len(parts) - NAMED} more" if len(parts) > NAMED else ""
    return f"out of reach: each alternative is, whatever the joints do: {', '.join(parts[:NAMED])}{more}"


def _tell_tool_body(problem: Problem, shortages: list[Floats]) -> Proof:
    """Which obstacles are in the way of what is fixed to the tool, wherever in the region it is."""
    obstacles = problem.collision.obstacles
    most = Counter(int(cell.argmax()) for short in shortages for cell in short.max(axis=1))
    names = [obstacles[place].name for place, _ in most.most_common()]
    more = f" and {len(names) - NAMED} more" if len(names) > NAMED else ""
    where = "every pose of the region puts what is fixed to the tool too near"
    reason = f"{NO_SOLUTION}: whatever the joints do, {where}: {', '.join(names[:NAMED])}{more}"
    return Proof(StopReason.WORLD, reason, {(problem.robot.name, name): 1 for name in names})
