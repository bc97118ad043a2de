"""What files say of goals: a target with freedom, or several, and where a base may stand."""

from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Discriminator, Field, Tag, field_validator
from pydantic_core import PydanticCustomError

from ikde.formats.entries import Entry, Interval, Number, OrientationEntry, UnitsEntry, Vector
from ikde.formats.names import Name
from ikde.model.base_region import MAX_CORNERS, MAX_HOLES
from ikde.model.region import MAX_ALTERNATIVES


def _kind_of_ranges(value: Any) -> str:
    if not isinstance(value, list):
        return "number"
    return "ranges" if any(isinstance(item, list) for item in value) else "three"


ThreeIntervals = Annotated[list[Interval], Field(min_length=3, max_length=3)]
Ranges = Annotated[
    Annotated[Number, Tag("number")] | Annotated[Vector, Tag("three")] | Annotated[ThreeIntervals, Tag("ranges")],
    Discriminator(_kind_of_ranges),
]
"""So much either way along each axis, three of that, or least and largest of each."""
Point = Annotated[list[Number], Field(min_length=2, max_length=2)]
Corners = Annotated[list[Point], Field(max_length=MAX_CORNERS)]


def _leave_out_null(schema: dict[str, Any]) -> None:
    """Take null out of the kinds of optional keys: they may be left out, not empty."""
    for entry in schema.get("properties", {}).values():
        kinds = [kind for kind in entry.get("anyOf", ()) if kind.get("type") != "null"]
        if kinds and entry.get("default", kinds) is None:
            entry.pop("default")
            entry.pop("anyOf")
            entry.update(kinds[0] if len(kinds) == 1 else {"anyOf": kinds})


def refuse_nothing(value: Any) -> Any:
    """A value as it is; an empty key is an error."""
    if value is None:
        raise PydanticCustomError("nothing", "expected a value, got nothing; leave the key out")
    return value


class FilledEntry(Entry):
    """An entry whose keys have values: an empty `base:` is a mistake, not nothing."""

    model_config = ConfigDict(json_schema_extra=_leave_out_null)

    @field_validator("*", mode="before")
    @classmethod
    def _refuse_nothing(cls, value: Any) -> Any:
        return refuse_nothing(value)


class TurnEntry(FilledEntry):
    """Turns of a full pose about an axis through the tool's origin."""

    axis: Vector = [0.0, 0.0, 1.0]
    """In the goal's frame, any length; by default the tool's axis z."""
    angles: Interval | None = None
    """Least and largest; by default any."""


class SightEntry(FilledEntry):
    """A point that the tool's z axis points at."""

    point: Vector
    """In the world."""
    distance: Interval
    """Least and largest, from the tool's origin."""
    axis: Vector | None = None
    """Direction of sight that is tried first, any length; by default straight down."""
    angle: Number | None = None
    """How far from that it may be; by default any."""


class SlackEntry(FilledEntry):
    """How far off a target the tool may be: a box of places, and at most one of `rotation`, `turn` and `cone`."""

    box: Ranges | None = None
    """How far off its position the tool's origin may be, along the axes of `frame`."""
    frame: Literal["goal", "world"] = "goal"
    """Whose axes the box has; a goal without a full orientation has the world's."""
    rotation: Ranges | None = None
    """How far off a full orientation may be: components of the rotation vector, about the goal's axes."""
    turn: TurnEntry | None = None
    cone: Number | None = None
    """Angle between the tool's z axis and the goal's; the rotation about it is free."""


class GoalEntry(SlackEntry, OrientationEntry):
    """A target in the world, and how far off it the tool may be; or `look_at` alone."""

    position: Vector | None = None
    """Where the tool should be."""
    look_at: SightEntry | None = None


class BaseEntry(FilledEntry):
    """Where the origin of a planar base may stand."""

    corners: Corners
    """Of the polygon in the world's x, y, in order."""
    holes: Annotated[list[Corners], Field(max_length=MAX_HOLES)] = []
    """Polygons inside that it stays out of."""


class BaseRegionFile(BaseEntry):
    """A file of its own about that."""

    units: UnitsEntry = UnitsEntry()
    """Of this file."""


Alternatives = Annotated[list[GoalEntry], Field(min_length=1, max_length=MAX_ALTERNATIVES)]


class FreedomEntry(SlackEntry):
    """What each target of a run may be off by, and where a planar base may stand."""

    base: BaseEntry | None = None
    """By default anywhere in its ranges."""


class NamedGoalEntry(GoalEntry):
    """A goal of a run, or alternatives under `any_of`."""

    any_of: Alternatives | None = None
    """Alternatives, in place of one."""
    take: Literal["first", "best"] = "first"
    """Of alternatives: the first that is reached, or of all that are reached the one with the least motion."""
    base: BaseEntry | None = None
    """Where a planar base may stand; by default anywhere in its ranges."""
    name: Name | None = None
    """What to call it in the results."""


class GoalFile(FilledEntry):
    """The whole file: `goal` or `any_of`."""

    units: UnitsEntry = UnitsEntry()
    """Of this file."""
    goal: GoalEntry | None = None
    any_of: Alternatives | None = None
    """Alternatives."""
    take: Literal["first", "best"] = "first"
    """Of alternatives: the first that is reached, or of all that are reached the one with the least motion."""
    base: BaseEntry | None = None
    """Where a planar base may stand; by default anywhere in its ranges."""
