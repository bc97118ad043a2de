"""The track file as it is written: every key with its type, its default and what it means."""

from typing import Annotated, Any, Literal, get_args

from pydantic import ConfigDict, Discriminator, Field, Tag

from ikde.formats.entries import (
    MAX_ATTACHED,
    AnyTarget,
    DetectorChoice,
    Entry,
    FileEntry,
    HeldChoice,
    Interval,
    MarginChoice,
    Number,
    OrientationEntry,
    UnitsEntry,
    Vector,
)
from ikde.formats.names import Name, Text
from ikde.model.robot import Drive

TrackMethod = Literal["continuation", "optimized", "typical"]
TRACK_METHODS: tuple[TrackMethod, ...] = get_args(TrackMethod)

Positive = Annotated[Number, Field(gt=0.0)]
NotNegative = Annotated[Number, Field(ge=0.0)]
Share = Annotated[float, Field(strict=True, ge=0.0, le=1.0)]


def _text_or_number(value: Any) -> str:
    return "text" if isinstance(value, str) else "number"


Formula = Annotated[Annotated[Text, Tag("text")] | Annotated[Number, Tag("number")], Discriminator(_text_or_number)]
"""A number, or arithmetic over the sample k, the count N and pi."""
ThreeFormulas = Annotated[list[Formula], Field(min_length=3, max_length=3)]
FourFormulas = Annotated[list[Formula], Field(min_length=4, max_length=4)]


class ExpressionsEntry(Entry):
    """Formulas for the tool's position at sample k = 0 .. N."""

    x: Formula
    """World x."""
    y: Formula
    """World y."""
    z: Formula
    """World z."""


class LineEntry(Entry):
    """A straight line; to where the tool is already, it stands still."""

    to: Vector
    """Where it ends."""


class ArcEntry(Entry):
    """A circle's arc about an axis."""

    center: Vector
    """A point of the axis."""
    normal: Vector
    """The axis' direction, any length; the rotation about it is right-handed."""
    angle: Number
    """The angle, right-handed about the axis; negative ones and more than a full turn are allowed."""


class ArcThroughEntry(Entry):
    """The arc of a circle through three points: where the tool is, `via` and `to`."""

    via: Vector
    """A point on the way."""
    to: Vector
    """Where it ends."""


class SplineEntry(Entry):
    """A natural cubic spline from where the tool is."""

    through: Annotated[list[Vector], Field(min_length=1, max_length=1000)]
    """Points on the way, the last one its end."""


class SegmentEntry(Entry):
    """A piece of a curve: exactly one shape, and how long it takes."""

    duration_s: Positive
    """Seconds: a whole number of samples."""
    pace: Literal["even", "smooth"] = "even"
    """`even`: samples are evenly spaced along the way; `smooth`: from rest to rest with minimum jerk."""
    line: LineEntry | None = None
    """A straight line."""
    arc: ArcEntry | None = None
    """A circle's arc about an axis."""
    arc_through: ArcThroughEntry | None = None
    """A circle's arc through two further points."""
    spline: SplineEntry | None = None
    """A smooth curve through points."""


class CurveEntry(Entry):
    """Lines, arcs and splines, each from where the one before it ends."""

    start: Vector = Field(alias="from")
    """Where the first one begins."""
    segments: Annotated[list[SegmentEntry], Field(min_length=1, max_length=10_000)]
    """The pieces, in order."""


class PathEntry(Entry):
    """Where the tool goes: exactly one key."""

    model_config = ConfigDict(json_schema_extra={"minProperties": 1, "maxProperties": 1})
    expressions: ExpressionsEntry | None = None
    """Formulas over k and N."""
    curve: CurveEntry | None = None
    """Lines, arcs and splines."""
    waypoints: Annotated[list[AnyTarget], Field(min_length=2)] | None = None
    """A list of poses, or [x, y, z] each, written here: straight lines and shortest rotations between them."""
    file: FileEntry | None = None
    """A table of waypoints: CSV, Parquet or NPZ."""


class KeyframeEntry(OrientationEntry):
    """An orientation at a moment of the path."""

    at: Share
    """When: share of the path's time, 0 to 1."""


class PathOrientationEntry(Entry):
    """The orientation of the tool: exactly one key."""

    model_config = ConfigDict(json_schema_extra={"minProperties": 1, "maxProperties": 1})
    axis: ThreeFormulas | None = None
    """Direction of the tool's z axis, any length; the rotation about it is free. Numbers or formulas."""
    rpy: ThreeFormulas | None = None
    """Roll, pitch, yaw about the fixed axes of the world. Numbers or formulas."""
    quat_wxyz: FourFormulas | None = None
    """Quaternion, w first, any length. Numbers or formulas."""
    keyframes: Annotated[list[KeyframeEntry], Field(min_length=1, max_length=10_000)] | None = None
    """Orientations at moments: constant angular velocity on the shortest way between them."""


def _free_or_given(value: Any) -> str:
    return "free" if isinstance(value, str) else "given"


Orientation = Annotated[
    Annotated[Literal["free"], Tag("free")] | Annotated[PathOrientationEntry, Tag("given")],
    Discriminator(_free_or_given),
]


class LimitsEntry(Entry):
    """What the motion must keep; what is left out stays as it is by default."""

    ranges: bool = Field(default=True, strict=True)
    """Whether joints must stay in their ranges."""
    speed: dict[Name, NotNegative | None] = {}
    """Joint, or `prismatic` or `revolute` for all others of that kind: units a second; 0: frozen, null: no limit.
    """
    acceleration: dict[Name, Positive | None] = {}
    """Likewise, units a second squared (default: no limits)."""
    wheel_speed: Positive | None = None
    """Of a differential drive's wheels, if the robot has any: angle a second (default: as the base's speeds imply)."""
    max_distance: Positive | None = None
    """Of the tool from the frame `center`, at every sample (default: any distance)."""
    center: Name | None = None
    """The frame that `max_distance` is measured from: the platform's centre."""
    position_error: Positive | None = None
    """Accepted error of the tool's position along each axis, at every sample."""
    orientation_error: Positive | None = None
    """Accepted error of its orientation, at every sample."""


class MotionEntry(Entry):
    """How an obstacle moves: straight and at constant speed from pose to pose."""

    times_s: Annotated[list[Number], Field(min_length=2, max_length=100_000)]
    """When it is at each pose, s: ascending, from the path's start to its end."""
    poses: Annotated[list[AnyTarget], Field(min_length=2, max_length=100_000)]
    """Where it is then, in the world: `position`, and perhaps one of `rpy`, `quat_wxyz`; or [x, y, z]."""


class TrackSpec(Entry):
    """A track: a path for the tool, and how the robot is to follow it."""

    name: Name | None = None
    """What to call the track (default: the file's name)."""
    robot: Text
    """A robot that ships with ikde, or its file, relative to the track file."""
    tool: Name | None = None
    """Which of its tools, or a frame (default: as the robot's file says); joints that do not move it are held."""
    units: UnitsEntry = UnitsEntry()
    """Units of everything written here; seconds are seconds."""
    dt_s: Positive
    """Time from a sample to the next, s."""
    samples: Annotated[int, Field(strict=True, ge=1, le=10**6)] | None = None
    """N, samples after the start (default: one fewer than waypoints, or what the segments' durations make)."""
    path: PathEntry
    """Where the tool goes."""
    orientation: Orientation | None = None
    """`free`, or the orientation of the tool (default: what the waypoints say, else free)."""
    drive: Drive | None = None
    """How the base moves: on arcs of constant v and omega, or freely (default: on arcs; freely if there is no base)."""
    method: TrackMethod = "continuation"
    """ikde's own, or one of the paper's two."""
    limits: LimitsEntry = LimitsEntry()
    """What the motion must keep."""
    detector: DetectorChoice | None = None
    """What counts as self-collision: a name, `none`, or a detector of your own (default: the robot's)."""
    world: Text | None = None
    """What is in the way: a world file, a cuRobo scene or a MoveIt planning scene, relative to the track file."""
    margin: MarginChoice | None = None
    """Distance to keep from the world; `10,gripper=0`: that of a component in its place."""
    attached: Annotated[dict[Name, HeldChoice], Field(max_length=MAX_ATTACHED)] = {}
    """Obstacles of the world that the robot picks up at `start`, else at home: object: frame."""
    moving: dict[Name, MotionEntry] = {}
    """Obstacles of the world that move meanwhile."""
    ranges: dict[Name, Interval] = {}
    """Joint ranges instead of the robot's: joint: [lower, upper]."""
    start: dict[Name, Number] | None = None
    """Configuration to start in; joints left out stand at home (default: chosen)."""
    seed: Annotated[int, Field(strict=True, ge=0, le=2**64 - 1)] = 0
    """Same seed, same motion."""
