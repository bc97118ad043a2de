"""From the `targets` of a run file to a source, and to what of it belongs into the recipe."""

from pathlib import Path
from typing import Any

import numpy as np

from ikde.batch.generators import ReachableSource, make_ball, make_box, make_grid
from ikde.batch.recipe import array_digest, as_plain, digest
from ikde.batch.sources import ListSource, TargetSource
from ikde.batch.spec import BallEntry, BatchSpec, BoxEntry, GridEntry, ReachableEntry
from ikde.formats.entries import FileEntry, InlineTarget, OrientationEntry, UnitsEntry, only_key
from ikde.formats.error_path import prefix_errors
from ikde.formats.poses import read_orientation, read_position
from ikde.formats.table_targets import TableSource, read_targets
from ikde.model.collision_model import CollisionModel
from ikde.model.target import Target, Targets
from ikde.solver.problem import Problem

Recipe = dict[str, Any]


def make_source(spec: BatchSpec, problem: Problem, folder: Path) -> tuple[TargetSource, Recipe]:
    """The source of a run's targets, and what its answers depend on; `reachable` draws from the problem's ranges.

    Raises:
        InputError: with the path of the key inside the run file.
        FileError: for what is wrong inside a table.
    """
    with prefix_errors("targets"):
        key = only_key(spec.targets)
        entry, units = getattr(spec.targets, key), spec.units
        with prefix_errors(key):
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
    named = any(entry.name for entry in entries)
    names = tuple(entry.name or f"target {index}" for index, entry in enumerate(entries)) if named else None
    return ListSource(targets=Targets.of(targets), names=names)


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
