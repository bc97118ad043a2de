"""What a goal file says: a target with freedom, or several, and where a base may stand."""

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag

from ikde.formats.entries import Entry, Interval, Number, OrientationEntry, UnitsEntry, Vector
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


class TurnEntry(Entry):
    """Turns of a full pose about an axis through the tool's origin."""

    axis: Vector = [0.0, 0.0, 1.0]
    """In the goal's frame, any length; by default the tool's axis z."""
    angles: Interval | None = None
    """Least and largest; by default any."""


class SightEntry(Entry):
    """A point that the tool's z axis points at."""

    point: Vector
    """In the world."""
    distance: Interval
    """Least and largest, from the tool's origin."""
    axis: Vector | None = None
    """Direction of sight that is tried first, any length; by default straight down."""
    angle: Number | None = None
    """How far from that it may be; by default any."""


class GoalEntry(OrientationEntry):
    """A target in the world, with at most one of `rotation`, `turn` and `cone`; or `look_at` alone."""

    position: Vector | None = None
    """Where the tool should be."""
    box: Ranges | None = None
    """How far off that the tool's origin may be, along the axes of `frame`."""
    frame: Literal["goal", "world"] = "goal"
    """Whose axes the box has; a goal without a full orientation has the world's."""
    rotation: Ranges | None = None
    """How far off a full orientation may be: components of the rotation vector, about the goal's axes."""
    turn: TurnEntry | None = None
    cone: Number | None = None
    """Angle between the tool's z axis and the goal's; the rotation about it is free."""
    look_at: SightEntry | None = None


class BaseEntry(Entry):
    """Where the origin of a planar base may stand."""

    corners: Corners
    """Of the polygon in the world's x, y, in order."""
    holes: Annotated[list[Corners], Field(max_length=MAX_HOLES)] = []
    """Polygons inside that it stays out of."""


class BaseRegionFile(BaseEntry):
    """A file of its own about that."""

    units: UnitsEntry = UnitsEntry()
    """Of this file."""


class GoalFile(Entry):
    """The whole file: `goal` or `any_of`."""

    units: UnitsEntry = UnitsEntry()
    """Of this file."""
    goal: GoalEntry | None = None
    any_of: Annotated[list[GoalEntry], Field(min_length=1, max_length=MAX_ALTERNATIVES)] | None = None
    """Alternatives."""
    take: Literal["first", "best"] = "first"
    """Of alternatives: the first that is reached, or of all that are reached the one with the least motion."""
    base: BaseEntry | None = None
    """Where a planar base may stand; by default anywhere in its ranges."""
