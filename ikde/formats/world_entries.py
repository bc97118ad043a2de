"""What a world file says of obstacles."""

from typing import Annotated, Literal

from pydantic import Field

from ikde.formats.entries import MAX_ATTACHED, Entry, Number, Quaternion, UnitsEntry, Vector
from ikde.formats.names import Name, Text
from ikde.model.robot import WORLD
from ikde.model.world import MAX_OBSTACLES
from ikde.spheres.primitives import MAX_SPHERES

MAX_PARTS, MAX_FRAMES = 10_000, 10_000
MAX_LISTED = 20_000  # points that stand in a file itself


class RadiusEntry(Entry):
    """A sphere."""

    radius: Number
    """Of the sphere."""


class RoundEntry(Entry):
    """A solid about its own z axis, its middle at the origin."""

    radius: Number
    """Of the round part; of a cone, of its base."""
    height: Number
    """Along z; of a capsule, between the centres of its ends."""


class HalfSpaceEntry(Entry):
    """All that lies below a plane through the origin."""

    normal: Vector = [0.0, 0.0, 1.0]
    """What points out of it, any length."""


class HullEntry(Entry):
    """The convex hull of points."""

    points: Annotated[list[Vector], Field(max_length=MAX_LISTED)]
    """At least four, not in one plane."""


class MeshEntry(Entry):
    """The convex hulls of a mesh: one of each closed part, and one of all that is open."""

    path: Text
    """A .stl, .obj or .dae file, in this file's folder or below."""
    scale: Vector = [1.0, 1.0, 1.0]
    """Along x, y, z; negative numbers mirror."""
    length: Literal["m", "mm"] | None = None
    """Unit of the mesh's numbers; by default that of this file. A DAE says its own."""


class CloudEntry(Entry):
    """Points, each a ball: those of a file, or a list."""

    path: Text | None = None
    """A .npz, .npy, .csv, .ply or .pcd file, in this file's folder or below."""
    points: Annotated[list[Vector], Field(max_length=MAX_LISTED)] | None = None
    """Instead of a file."""
    radius: Number
    """Of each ball."""
    array: Text | None = None
    """Which array of an NPZ file [K, 3]; by default its only one."""
    length: Literal["m", "mm"] | None = None
    """Unit of the file's numbers; by default that of this one."""
    drop_invalid: Annotated[bool, Field(strict=True)] = False
    """Leave out points with NaN or infinity, as cameras give them, instead of refusing the file."""


class ColumnsEntry(Entry):
    """A height field: an upright box over each cell of a grid."""

    heights: Annotated[list[list[Number]], Field(max_length=MAX_PARTS)]
    """heights[i][j] at x = i cell, y = j cell."""
    cell: Number
    """Edge of a cell."""
    base: Number = 0.0
    """Where the boxes begin; cells that are not higher have none."""


class PlaceEntry(Entry):
    """Where it stands: a position, and at most one orientation."""

    position: Vector = [0.0, 0.0, 0.0]
    """Of its origin."""
    rpy: Vector | None = None
    """Roll, pitch, yaw about the fixed axes x, y, z, as in URDF."""
    quat_wxyz: Quaternion | None = None
    """Quaternion, w first, of length 1."""
    rotation: Annotated[list[Vector], Field(min_length=3, max_length=3)] | None = None
    """Rotation matrix, row by row."""


class FramePlaceEntry(PlaceEntry):
    """A frame of the file's own."""

    frame: Name = WORLD
    """What it is placed in: the world, another of these frames, or a frame of the robot that no joint moves."""


class SolidEntry(PlaceEntry):
    """One solid: exactly one of its keys says which."""

    sphere: RadiusEntry | None = None
    box: Vector | None = None
    """Whole edges along its own x, y, z."""
    cylinder: RoundEntry | None = None
    capsule: RoundEntry | None = None
    cone: RoundEntry | None = None
    half_space: HalfSpaceEntry | None = None
    hull: HullEntry | None = None
    mesh: MeshEntry | None = None
    cloud: CloudEntry | None = None
    columns: ColumnsEntry | None = None


class ObstacleEntry(SolidEntry):
    """One solid, or several as `parts`, under one name."""

    parts: Annotated[list[SolidEntry], Field(max_length=MAX_PARTS)] | None = None
    """Solids that stand together, each placed in the obstacle's frame."""
    frame: Name = WORLD
    """What it is placed in: the world, one of `frames`, or a frame of the robot that no joint moves."""
    margin: Number = 0.0
    """Added to the distance that is asked for."""
    ignore: list[Name] = []
    """Components of the robot that may touch it."""
    group: Name | None = None
    """What it is switched on and off with."""


class AttachedEntry(SolidEntry):
    """What the robot holds: one solid or several as `parts`, placed in a frame that a joint moves."""

    parts: Annotated[list[SolidEntry], Field(max_length=MAX_PARTS)] | None = None
    """Solids that belong together, each placed in the object's frame."""
    frame: Name
    """The frame of the robot that holds it, or one of `frames` that is placed in such a frame."""
    may_touch: list[Name] = []
    """Components of the robot, obstacles and other attached objects that it may touch."""
    spheres: Annotated[list[Quaternion], Field(min_length=1, max_length=MAX_SPHERES)] | None = None
    """Centre in the object's frame and radius: x, y, z, r; in place of those that ikde makes."""
    protrusion: Number | None = None
    """How far spheres may stand out of it; of `spheres` that are given, how far they do."""
    picked_from: FramePlaceEntry | None = None
    """Where it stood before; by default the world's origin."""
    margin: Number = 0.0
    """Added to the distance that it keeps from obstacles."""
    ignore: list[Name] = []
    """Components of the robot that may touch it, also as an obstacle."""
    group: Name | None = None
    """What it is switched with as an obstacle."""


class WorldFile(Entry):
    """The whole file."""

    units: UnitsEntry = UnitsEntry()
    """Of this file."""
    frames: Annotated[dict[Name, FramePlaceEntry], Field(max_length=MAX_FRAMES)] = {}
    """Frames to place obstacles in, by name."""
    obstacles: Annotated[dict[Name, ObstacleEntry], Field(max_length=MAX_OBSTACLES)]
    """What stands there, by name."""
    switched_off: list[Name] = []
    """Groups that do not count."""
    attached: Annotated[dict[Name, AttachedEntry], Field(max_length=MAX_ATTACHED)] = {}
    """What the robot holds, by name."""


SOLIDS = tuple(key for key in SolidEntry.model_fields if key not in PlaceEntry.model_fields)
