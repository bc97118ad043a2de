"""From the `targets` of a run file to a source, and to what of it belongs into the recipe."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ikde.batch.generators import ReachableSource, make_ball, make_box, make_grid
from ikde.batch.recipe import array_digest, as_plain, digest
from ikde.batch.sources import FreedomSource, GoalSource, ListSource, TargetSource
from ikde.batch.spec import BallEntry, BatchSpec, BoxEntry, GridEntry, ReachableEntry
from ikde.errors import InputError
from ikde.formats.entries import FileEntry, InlineTarget, OrientationEntry, UnitsEntry, only_key
from ikde.formats.error_path import prefix_errors
from ikde.formats.goal_entries import NamedGoalEntry
from ikde.formats.goals import make_freedom, make_named_goal
from ikde.formats.poses import read_orientation, read_position
from ikde.formats.table_targets import TableSource, read_targets
from ikde.model.base_motion import need_base
from ikde.model.collision_model import CollisionModel
from ikde.model.region import Region
from ikde.model.target import Target, Targets
from ikde.solver.problem import Problem

Recipe = dict[str, Any]


def make_source(spec: BatchSpec, problem: Problem, folder: Path) -> tuple[TargetSource, Recipe]:
    """The source of a run's targets, and what its answers depend on; `reachable` draws from the problem's ranges.

    Raises:
        InputError: with the path of the key inside the run file.
        FileError: for what is wrong inside a table.
    """
    source, recipe = _make_targets(spec, problem, folder)
    if spec.freedom is None:
        return source, recipe
    with prefix_errors("freedom"):
        if isinstance(source, GoalSource):
            raise InputError("`goals` say by themselves what freedom they have")
        loosen = make_freedom(spec.freedom, spec.units)
        for target in _list_kinds(source):
            _check_base(loosen(target), problem)
    written = spec.freedom.model_dump(exclude_unset=True)
    freedom = {"freedom": {**written, "units": spec.units.model_dump()}}
    return FreedomSource(source=source, loosen=loosen), {**recipe, **freedom}


def _list_kinds(source: TargetSource) -> list[Target]:
    """A target of each kind: all but a list's are of one."""
    targets = Targets.of(source.read(0, source.count if isinstance(source, ListSource) else 1))  # type: ignore[arg-type]
    return [targets[row] for row in np.unique(targets.kind, return_index=True)[1].tolist()]


def _check_base(goal: Target | Region, problem: Problem) -> None:
    """Raise `InputError` for a base that may stand somewhere, of a robot that has none."""
    if isinstance(goal, Region) and goal.base is not None:
        need_base(problem.robot)


def _make_targets(spec: BatchSpec, problem: Problem, folder: Path) -> tuple[TargetSource, Recipe]:
    with prefix_errors("targets"):
        key = only_key(spec.targets)
        entry, units = getattr(spec.targets, key), spec.units
        with prefix_errors(key):
            if key == "goals":
                source = _make_goals(entry, units, problem)
                written = [goal.model_dump(exclude_unset=True) for goal in entry]
                return source, {key: written, "units": units.model_dump()}
            if isinstance(entry, FileEntry):
                table = read_targets(folder / entry.path, entry.columns, entry.units or units)
                return table, {key: _describe_table(table)}
            if isinstance(entry, ReachableEntry):
                source = _make_reachable(entry, problem, spec.seed)
                return source, {key: _describe_reachable(source)}
            written = spec.targets.model_dump(by_alias=True, exclude_unset=True)
            return _make_listed(entry, units, spec.seed), {**written, "units": units.model_dump()}


def _make_listed(
    entry: list[InlineTarget] | GridEntry | BoxEntry | BallEntry, units: UnitsEntry, seed: int
) -> TargetSource:
    if isinstance(entry, list):
        return _make_inline(entry, units)
    with prefix_errors("orientation"):
        orientation = read_orientation(entry.orientation or OrientationEntry(), units)
    if isinstance(entry, BallEntry):
        center = read_position("center", entry.center, units)
        read_position("radius", np.abs(entry.center) + entry.radius, units)
        return make_ball(center, entry.radius * units.length_m, entry.filled, entry.count, seed, orientation)
    start, to = read_position("from", entry.start, units), read_position("to", entry.to, units)
    if isinstance(entry, GridEntry):
        nx, ny, nz = entry.counts
        return make_grid(start, to, (nx, ny, nz), orientation)
    return make_box(start, to, entry.count, seed, orientation)


def _make_inline(entries: list[InlineTarget], units: UnitsEntry) -> ListSource:
    targets = []
    for index, entry in enumerate(entries):
        with prefix_errors(index):
            position = read_position("position", entry.position, units)
            targets.append(Target(position, **read_orientation(entry, units)))
    return ListSource(targets=Targets.of(targets), names=_list_names(entries))


def _make_goals(entries: list[NamedGoalEntry], units: UnitsEntry, problem: Problem) -> GoalSource:
    goals = []
    for index, entry in enumerate(entries):
        with prefix_errors(index):
            goals.append(make_named_goal(entry, units))
            _check_base(goals[-1], problem)
    return GoalSource(goals=goals, names=_list_names(entries))


def _list_names(entries: Sequence[InlineTarget] | Sequence[NamedGoalEntry]) -> tuple[str, ...] | None:
    """Of all, if some have one."""
    if not any(entry.name for entry in entries):
        return None
    return tuple(entry.name or f"target {index}" for index, entry in enumerate(entries))


def _make_reachable(entry: ReachableEntry, problem: Problem, seed: int) -> ReachableSource:
    with prefix_errors("detector"):
        collision = CollisionModel.of(problem.robot, entry.detector)
    lower, upper = problem.drawn
    source = ReachableSource(
        collision=collision, lower=lower, upper=upper, goal=entry.goal, count=entry.count, seed=seed
    )
    source.read(0, 1)  # a robot that is never free is found before anything runs
    return source


def _describe_table(table: TableSource) -> Recipe:
    numbers = [table.positions, *([] if table.orientations is None else [table.orientations])]
    return {
        "count": table.count,
        "orientation": table.kind,
        "numbers": array_digest(*numbers),
        "names": digest(table.names),
    }


def _describe_reachable(source: ReachableSource) -> Recipe:
    ranges = dict(zip(source.collision.robot.joint_names, zip(source.lower, source.upper, strict=True), strict=True))
    described = {"count": source.count, "goal": source.goal, "detector": source.collision.detector, "ranges": ranges}
    return as_plain(described)
