"""Entries that all kinds of files share, robot files among them: numbers, units, orientations, tables, detectors."""

from collections.abc import Sequence
from typing import Annotated, Any, Literal, get_args

from pydantic import BaseModel, BeforeValidator, ConfigDict, Discriminator, Field, Tag

from ikde.errors import InputError
from ikde.formats.names import Name, Text
from ikde.formats.units import ANGLES_RAD, LENGTHS_M
from ikde.model.validate import NON_ADJACENT

OrientationKind = Literal["axis", "rpy", "quat_wxyz"]
ORIENTATIONS: tuple[OrientationKind, ...] = get_args(OrientationKind)
Number = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=-1e9, le=1e9)]  # beyond, digits are lost
Count = Annotated[int, Field(strict=True, ge=1, le=10**9)]
Interval = Annotated[list[Number], Field(min_length=2, max_length=2)]
Vector = Annotated[list[Number], Field(min_length=3, max_length=3)]
Quaternion = Annotated[list[Number], Field(min_length=4, max_length=4)]
ThreeTexts = Annotated[list[Text], Field(min_length=3, max_length=3)]
FourTexts = Annotated[list[Text], Field(min_length=4, max_length=4)]


def _text_or_entry(value: Any) -> str:
    return "text" if isinstance(value, str) else "entry"


AsText, AsEntry, TextOrEntry = Tag("text"), Tag("entry"), Discriminator(_text_or_entry)  # errors of one branch only
ThreeColumns = Annotated[Annotated[Text, AsText] | Annotated[ThreeTexts, AsEntry], TextOrEntry]
FourColumns = Annotated[Annotated[Text, AsText] | Annotated[FourTexts, AsEntry], TextOrEntry]
MarginChoice = Annotated[Annotated[Text, AsText] | Annotated[Number, Field(ge=0.0), AsEntry], TextOrEntry]


class Entry(BaseModel):
    """Part of a file: unknown keys are errors, and the text under a key is what an editor shows."""

    model_config = ConfigDict(extra="forbid", frozen=True, use_attribute_docstrings=True, populate_by_name=True)


class NamedEntry(Entry):
    """Something that results call by a name of the user's."""

    name: Name
    """What to call it in the results."""


class UnitsEntry(Entry):
    """Units of the lengths and angles that are written here."""

    length: Literal["m", "mm"] = "m"
    """Unit of lengths."""
    angle: Literal["rad", "deg"] = "rad"
    """Unit of angles."""

    @property
    def length_m(self) -> float:
        """One unit of length in m."""
        return LENGTHS_M[self.length]

    @property
    def angle_rad(self) -> float:
        """One unit of angle in rad."""
        return ANGLES_RAD[self.angle]


class OrientationEntry(Entry):
    """The orientation of the tool; at most one key."""

    axis: Vector | None = None
    """Direction of the tool's z axis, any length; the rotation about it is free."""
    rpy: Vector | None = None
    """Roll, pitch, yaw about the fixed axes x, y, z of the world, as in URDF."""
    quat_wxyz: Quaternion | None = None
    """Quaternion, w first, any length."""


class InlineTarget(OrientationEntry):
    """One target in the world frame."""

    position: Vector
    """Where the tool should be."""
    name: Name | None = None
    """What to call it in the results."""


def _as_target(value: Any) -> Any:
    return {"position": value} if isinstance(value, list) else value


AnyTarget = Annotated[InlineTarget, BeforeValidator(_as_target, json_schema_input_type=InlineTarget | Vector)]
"""A target, or its position alone: `[x, y, z]`."""


class ColumnsEntry(Entry):
    """Which columns of the file hold what. An array of an NPZ file may hold all numbers of a key: `position: p`."""

    position: ThreeColumns
    """Columns of x, y, z."""
    axis: ThreeColumns | None = None
    """Columns of the direction of the tool's z axis."""
    rpy: ThreeColumns | None = None
    """Columns of roll, pitch, yaw."""
    quat_wxyz: FourColumns | None = None
    """Columns of the quaternion, w first."""
    name: Text | None = None
    """Column of the targets' names."""


def chosen_orientation(entry: OrientationEntry | ColumnsEntry) -> OrientationKind | None:
    """The one key that gives an orientation, or None; raises `InputError` for two."""
    given: list[OrientationKind] = [kind for kind in ORIENTATIONS if getattr(entry, kind) is not None]
    if len(given) > 1:
        raise InputError(f"{' and '.join(given)} both ask for an orientation; give one", (given[1],))
    return given[0] if given else None


class FileEntry(Entry):
    """Targets from a table, a row each."""

    path: Text
    """A .csv, .parquet or .npz file, relative to the run file."""
    columns: ColumnsEntry
    """Which columns hold what."""
    units: UnitsEntry | None = None
    """Units of the table (default: those of the run file)."""


MAX_ATTACHED = 100  # objects that a robot holds


class HeldEntry(Entry):
    """An obstacle that the robot picks up where it stands."""

    frame: Name
    """The frame of the robot that holds it, such as its tool."""
    may_touch: list[Name] = []
    """Components of the robot, obstacles and other attached objects that it may touch."""


HeldChoice = Annotated[Annotated[Name, AsText] | Annotated[HeldEntry, AsEntry], TextOrEntry]
"""A frame, or that and what may be touched."""


class DetectorPartsEntry(Entry):
    """What a detector compares, and how near is a collision."""

    spheres: Name
    """The robot's sphere approximation."""
    pairs: Name = NON_ADJACENT
    """The robot's list of component pairs to compare."""
    safe_distance: Number = 0.0
    """Clearance at which collision begins."""


class DetectorEntry(DetectorPartsEntry, NamedEntry):
    """A detector of your own, from the robot's approximations and pair lists."""


DetectorChoice = Annotated[Annotated[Name, AsText] | Annotated[DetectorEntry, AsEntry], TextOrEntry]


def only_key(entry: Entry, keys: Sequence[str] = ()) -> str:
    """The one of `keys` (of all keys, by default) that is given; raises `InputError` for none or several."""
    known = keys or tuple(type(entry).model_fields)
    given = [key for key in known if getattr(entry, key) is not None]
    if len(given) != 1:
        message = f"expected one of {', '.join(known)}, got {' and '.join(given) or 'none'}"
        raise InputError(message, tuple(given[1:2]))
    return given[0]
