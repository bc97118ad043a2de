"""Goals as files say them, to a `Target` or a `Region`: of goal files, and of runs."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ikde.errors import InputError
from ikde.formats.entries import UnitsEntry
from ikde.formats.error_path import prefix_errors
from ikde.formats.goal_entries import BaseEntry, FreedomEntry, GoalEntry, NamedGoalEntry, SlackEntry
from ikde.formats.poses import read_orientation, read_position
from ikde.model.base_region import BaseRegion
from ikde.model.region import Region, Take
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
TAKE = "only alternatives in `any_of` have one that is taken"


def make_goal(entry: GoalEntry, units: UnitsEntry) -> Target | Region:
    """A goal from what a file says of it; raises `InputError` with the key that is wrong."""
    if entry.look_at is not None:
        _find_rule(entry)
        return _make_sight(entry, units)
    if entry.position is None:
        _find_rule(entry)
        raise InputError("a goal has a `position`, or `look_at`")
    target = Target(read_position("position", entry.position, units), **read_orientation(entry, units))
    return _loosen(entry, target, units) if _has_slack(entry) else target


def make_alternatives(entries: Sequence[GoalEntry], take: Take, units: UnitsEntry) -> Region:
    """Several goals of which one will do; errors as `make_goal`, under `any_of`."""
    goals = []
    for place, entry in enumerate(entries):
        with prefix_errors("any_of", place):
            goals.append(make_goal(entry, units))
    return Region.any_of(goals, take)


def make_named_goal(entry: NamedGoalEntry, units: UnitsEntry) -> Target | Region:
    """A goal of a run, which may have alternatives; errors as `make_goal`."""
    if entry.any_of is None:
        if entry.take != "first":
            raise InputError(TAKE, ("take",))
        goal = make_goal(entry, units)
    else:
        if others := [key for key in GoalEntry.model_fields if key in entry.model_fields_set]:
            raise InputError(f"`any_of` says all of a goal; leave out {', '.join(others)}", (others[0],))
        goal = make_alternatives(entry.any_of, entry.take, units)
    return with_base(goal, entry.base, units)


def make_freedom(entry: FreedomEntry, units: UnitsEntry) -> Callable[[Target], Region]:
    """What makes a goal with freedom of any target; raises `InputError` with the key that is wrong, then or now."""
    base = _read_base(entry.base, units)
    if not _has_slack(entry) and base is None:
        raise InputError("expected what targets may be off by: box, rotation, turn, cone, or where a base may stand")
    rule = _find_rule(entry)

    def make(target: Target) -> Region:
        if not _has_slack(entry):
            goal = Region.of(target)
        else:
            try:
                goal = _loosen(entry, target, units)
            except InputError as error:  # what is asked of a target that has none of it
                where = (rule,) if rule and error.where == ("position",) else error.where
                raise InputError(error.message, where) from None
        return goal if base is None else goal.with_base(base)

    return make


def with_base(goal: Target | Region, entry: BaseEntry | None, units: UnitsEntry) -> Target | Region:
    """The goal with what a file says, under `base`, of where a base may stand."""
    base = _read_base(entry, units)
    if base is None:
        return goal
    return (Region.of(goal) if isinstance(goal, Target) else goal).with_base(base)


def make_base(entry: BaseEntry, units: UnitsEntry) -> BaseRegion:
    """Where a base may stand; raises `InputError` with the key that is wrong."""
    corners = np.array(entry.corners, dtype=float).reshape(-1, 2) * units.length_m
    holes = [np.array(hole, dtype=float).reshape(-1, 2) * units.length_m for hole in entry.holes]
    return BaseRegion(corners, holes)


def _read_base(entry: BaseEntry | None, units: UnitsEntry) -> BaseRegion | None:
    with prefix_errors("base"):
        return None if entry is None else make_base(entry, units)


def _find_rule(entry: SlackEntry) -> str | None:
    """Which orientations will do, if it says so; raises `InputError` for two."""
    given = [key for key in ONE_OF if getattr(entry, key) is not None]
    if len(given) > 1:
        raise InputError(f"expected one of {', '.join(ONE_OF)}, got {' and '.join(given)}", (given[1],))
    return given[0] if given else None


def _has_slack(entry: SlackEntry) -> bool:
    return _find_rule(entry) is not None or entry.box is not None


def _loosen(entry: SlackEntry, target: Target, units: UnitsEntry) -> Region:
    """A region about a target."""
    box = 0.0 if entry.box is None else np.array(entry.box) * units.length_m
    try:
        return _make_region(entry, target, box, units)
    except InputError as error:
        raise InputError(error.message, _rename(entry, error.where)) from None


def _make_region(entry: SlackEntry, target: Target, box: Any, units: UnitsEntry) -> Region:
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


def _rename(entry: SlackEntry, where: tuple[str | int, ...]) -> tuple[str | int, ...]:
    """The key of a file that an argument of `Region` came from."""
    if not where:
        return ()
    if entry.turn is not None and where[0] in ("angle_rad", "axis_world_tool"):
        return ("turn", "angles" if where[0] == "angle_rad" else "axis")
    return (KEYS.get(str(where[0]), where[0]),)
