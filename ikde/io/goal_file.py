"""Goal files, and goals typed on the command line, to a `Target` or a `Region`."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import BaseModel, ValidationError

from ikde.errors import FileError, InputError, quoted
from ikde.formats.entries import UnitsEntry
from ikde.formats.error_path import prefix_errors
from ikde.formats.goal_entries import BaseEntry, BaseRegionFile, GoalEntry, GoalFile
from ikde.formats.poses import read_orientation, read_position
from ikde.io.schema import Given, as_file_error
from ikde.io.yaml_file import Document, read_yaml
from ikde.model.base_region import BaseRegion
from ikde.model.region import Region
from ikde.model.target import Target

KEYS = {  # arguments of `Region` by what a file calls them
    "position_m": "box",
    "rotation_rad": "rotation",
    "angle_rad": "cone",
    "target": "position",
    "axis_world_tool": "axis",
    "p_world_point": "point",
    "distance_m": "distance",
}
ONE_OF = ("rotation", "turn", "cone")


def load_goal(source: str | PathLike[str] | Mapping[str, Any]) -> Target | Region:
    """Load a goal and check all of it: a `Region`, or a `Target` if it has no freedom.

    Args:
        source: the path of a YAML file, or its keys as a mapping.

    Raises:
        FileError: for a file that cannot be read or is wrong, with its line and key.
        InputError: for a mapping that is wrong, with its key.
    """
    if not isinstance(source, str | PathLike | Mapping):
        raise InputError(f"expected the path of a goal file or a mapping, got {quoted(source)}")
    document = Given(dict(source)) if isinstance(source, Mapping) else read_yaml(Path(source))
    with _placed(document, GoalFile):
        return _make_goal(GoalFile.model_validate(document.data))


def load_base_region(path: Path) -> BaseRegion:
    """Where a base may stand, from a file of its own; errors as `load_goal`."""
    document = read_yaml(path)
    with _placed(document, BaseRegionFile):
        entry = BaseRegionFile.model_validate(document.data)
        return _make_base(entry, entry.units)


@contextmanager
def _placed(document: Document | Given, model: type[BaseModel]) -> Iterator[None]:
    """Errors of what is read, at their place in the file."""
    try:
        yield
    except ValidationError as error:
        raise as_file_error(document, error, model) from None
    except FileError:
        raise
    except InputError as error:
        raise document.error(error.message, error.where) from None


def _make_goal(file: GoalFile) -> Target | Region:
    if (file.goal is None) == (file.any_of is None):
        raise InputError("expected a `goal`, or several in `any_of`", ("goal",) if file.goal else ())
    if file.goal is not None:
        if file.take != "first":
            raise InputError("only alternatives in `any_of` have one that is taken", ("take",))
        with prefix_errors("goal"):
            goal = make_goal(file.goal, file.units)
    else:
        goals = []
        for place, entry in enumerate(file.any_of or ()):
            with prefix_errors("any_of"), prefix_errors(place):
                goals.append(make_goal(entry, file.units))
        goal = Region.any_of(goals, file.take)
    if file.base is None:
        return goal
    with prefix_errors("base"):
        base = _make_base(file.base, file.units)
    return (Region.of(goal) if isinstance(goal, Target) else goal).with_base(base)


def _make_base(entry: BaseEntry, units: UnitsEntry) -> BaseRegion:
    corners = np.array(entry.corners, dtype=float).reshape(-1, 2) * units.length_m
    holes = [np.array(hole, dtype=float).reshape(-1, 2) * units.length_m for hole in entry.holes]
    return BaseRegion(corners, holes)


def make_goal(entry: GoalEntry, units: UnitsEntry) -> Target | Region:
    """A goal from what a file says of it; raises `InputError` with the key that is wrong."""
    given = [key for key in ONE_OF if getattr(entry, key) is not None]
    if len(given) > 1:
        raise InputError(f"expected one of {', '.join(ONE_OF)}, got {' and '.join(given)}", (given[1],))
    if entry.look_at is not None:
        return _make_sight(entry, units)
    if entry.position is None:
        raise InputError("a goal has a `position`, or `look_at`")
    orientation = read_orientation(entry, units)
    target = Target(read_position("position", entry.position, units), **orientation)
    box = 0.0 if entry.box is None else np.array(entry.box) * units.length_m
    if not given and entry.box is None:
        return target
    try:
        return _make_region(entry, target, box, units)
    except InputError as error:
        raise InputError(error.message, _rename(entry, error.where)) from None


def _make_region(entry: GoalEntry, target: Target, box: Any, units: UnitsEntry) -> Region:
    if entry.turn is not None:
        angles = (-np.pi, np.pi) if entry.turn.angles is None else np.array(entry.turn.angles) * units.angle_rad
        return Region.turn(target, entry.turn.axis, angles, box, entry.frame)
    if entry.cone is not None:
        return Region.cone(target, entry.cone * units.angle_rad, box, entry.frame)
    rotation = 0.0 if entry.rotation is None else np.array(entry.rotation) * units.angle_rad
    return Region.box(target, box, rotation, entry.frame)


def _make_sight(entry: GoalEntry, units: UnitsEntry) -> Region:
    others = [key for key in GoalEntry.model_fields if key in entry.model_fields_set - {"look_at"}]
    if others:
        raise InputError(f"`look_at` says all of a goal; leave out {', '.join(others)}", (others[0],))
    sight = entry.look_at
    assert sight is not None
    point, distance = np.array(sight.point) * units.length_m, np.array(sight.distance) * units.length_m
    angle = None if sight.angle is None else sight.angle * units.angle_rad
    try:
        return Region.look_at(point, distance, sight.axis, angle)
    except InputError as error:
        keys = {**KEYS, "angle_rad": "angle"}
        raise InputError(error.message, ("look_at", *(keys.get(str(k), str(k)) for k in error.where[:1]))) from None


def _rename(entry: GoalEntry, where: tuple[str | int, ...]) -> tuple[str | int, ...]:
    """The key of a file that an argument of `Region` came from."""
    if not where:
        return ()
    if entry.turn is not None and where[0] in ("angle_rad", "axis_world_tool"):
        return ("turn", "angles" if where[0] == "angle_rad" else "axis")
    return (KEYS.get(str(where[0]), where[0]),)
