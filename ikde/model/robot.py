"""A robot as data: joints, a tree of frames, sphere approximations, pair lists and detectors. SI units."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from importlib import import_module
from os import PathLike
from typing import Literal, NamedTuple, get_args

import numpy as np
from numpy.typing import NDArray

from ikde.kernels.arrays import Floats
from ikde.model.value import ReadOnlyValue

WORLD = "world"
NO_DETECTOR = "none"
TOOL = "tool"  # what the tool's frame is called beside its own name
MAX_MAGNITUDE = 1e5  # m or rad, of all that a robot is made of: beyond it an angle has lost its last digits

FULL_TURN_RAD = 2.0 * np.pi - 1e-12  # but for rounding

JointKind = Literal["revolute", "prismatic", "continuous"]
Origin = Literal["published", "derived", "calibrated"]
Spacing = Literal["touching", "even"]
Drive = Literal["differential", "omnidirectional", "mecanum"]
DRIVES: tuple[Drive, ...] = get_args(Drive)


@dataclass(frozen=True, slots=True, kw_only=True)
class Joint:
    """One coordinate of q: its range, home value and how fast it may move, in m (prismatic) or rad (others) and s."""

    name: str
    kind: JointKind
    lower: float = -np.inf
    upper: float = np.inf
    """Limits: infinite of a continuous joint, which rotates without end, and finite of any other."""
    home: float
    max_speed: float | None = None
    """m/s or rad/s; None: the robot's file gives none. No solve depends on it, a track does (`MotionLimits.of`)."""
    max_acceleration: float | None = None
    """m/s^2 or rad/s^2, likewise."""
    max_effort: float | None = None
    """N or N m: kept for programs that move masses; nothing here depends on it."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Frame(ReadOnlyValue):
    """A frame of the tree: T_parent_frame(q) = [R_parent_frame, p_parent_frame] @ joint motion about `axis`."""

    name: str
    parent: str
    p_parent_frame: Floats
    """[3] m"""
    R_parent_frame: Floats
    """[3, 3]"""
    joint: str | None = None
    axis: Floats | None = None
    """[3] unit vector in this frame; the joint rotates about it or moves along it."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Inertia(ReadOnlyValue):
    """The mass that moves with a frame: kept for programs that move masses; nothing here depends on it."""

    mass_kg: float
    p_frame_com: Floats
    """[3] m: the centre of mass."""
    I_com_frame: Floats
    """[3, 3] kg m^2, symmetric: about the centre of mass, along the axes of the frame."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SphereRow:
    """`count` equal spheres on the line between two key points, as the paper writes an approximation.

    `touching` spheres stand 2R apart about the middle of the line [Qiao2021, eq. 13]; `even` ones share the line out,
    the first at its start, the last at its end. A single sphere stands in the middle.
    """

    component: str
    start: str
    end: str
    radius_m: float
    count: int = 1
    spacing: Spacing = "touching"


@dataclass(frozen=True, slots=True, kw_only=True)
class FreeSpheres:
    """Spheres of one component that stand anywhere in a frame: what covers a mesh stands in no rows."""

    component: str
    frame: str
    spheres: tuple[tuple[float, float, float, float], ...]
    """Centre in the frame and radius of each: x, y, z, r in m."""

    @property
    def start(self) -> str:
        """The frame, as a row's first key point; it is the last as well."""
        return self.frame

    @property
    def end(self) -> str:
        """The frame."""
        return self.frame

    @property
    def count(self) -> int:
        """How many there are."""
        return len(self.spheres)


Spheres = SphereRow | FreeSpheres
"""An entry of an approximation."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Detector:
    """What self-collision means: an approximation, the pairs that are compared, and the safe distance in m.

    It always compares something: at least one pair, with at least one sphere in each component (`check_detector`).
    """

    name: str
    spheres: str
    pairs: str
    safe_distance_m: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Wheels:
    """The driven wheels of a planar base (x, y, yaw): two side by side on one axis, or four mecanum wheels."""

    radius_m: float
    half_track_m: float
    """From the middle of the base, the origin of what its yaw joint moves, to the left or the right."""
    half_wheelbase_m: float | None = None
    """From there to the front or the rear axle, of mecanum wheels; None for two wheels."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Provenance:
    """Where a number comes from: printed, forced by printed numbers, or chosen inside what they leave free."""

    kind: Origin
    text: str


Pairs = tuple[tuple[str, str], ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class AdjacentPair:
    """Two components that the robot's file declares adjacent, although no joint joins them, and why."""

    a: str
    b: str
    reason: str


@dataclass(frozen=True, slots=True, kw_only=True)
class LeftOutPair:
    """Two components that a detector does not compare, and why."""

    a: str
    b: str
    reason: str
    """`one body`, `joined by joint NAME`, `adjacent: REASON` as in the robot's file, or `not in the pair list NAME`."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False, weakref_slot=True)
class Robot(ReadOnlyValue):
    """A robot that has been checked: parents come before children and every name resolves (`model.validate`)."""

    name: str
    title: str
    joints: tuple[Joint, ...]
    frames: tuple[Frame, ...]
    tool: str
    approximations: Mapping[str, tuple[Spheres, ...]]
    adjacent: tuple[AdjacentPair, ...]
    """Pairs that are adjacent although the tree does not show it."""
    pair_lists: Mapping[str, Pairs]
    """By name; `non_adjacent` is made by `model.validate`."""
    detectors: Mapping[str, Detector]
    default_detector: str
    convention: str
    """Name of the convention that q, limits and home are written in."""
    conventions: Mapping[str, Mapping[str, float]]
    """Other conventions: offsets in rad, q_other = q + offset."""
    provenance: Mapping[tuple[str | int, ...], Provenance]
    """Path of a number in the robot's file -> where it comes from."""
    wheels: Wheels | None = None
    """None for a robot without a base that drives on wheels, or whose wheel geometry is not given."""
    drive: Drive | None = None
    """How a base that drives in the plane moves unless a track says otherwise; None: as its wheels do, else
    `differential`."""
    inertias: Mapping[str, Inertia] = field(default_factory=dict)
    """By frame, of those whose mass is known."""
    neighbours: tuple[LeftOutPair, ...] = ()
    """Every pair that `non_adjacent` leaves out; made by `model.validate`."""
    compared: Pairs = ()
    """Pairs that `non_adjacent` has although they are of one body, or one joint joins their bodies."""
    tools: Mapping[str, str] = field(default_factory=dict)
    """Name -> frame, of a robot with several tools; `tool` is the frame of the one that targets are for."""
    free_joints: tuple[Joint, ...] = ()
    """All joints as in the robot's file, if some are held that do not move the tool (`with_tool`); else nothing."""
    file_ranges: tuple[tuple[float, float], ...] = ()
    """What `drawn` was by the robot's file, m or rad, where a run has put other limits in their place; else nothing."""

    def __repr__(self) -> str:
        """In a line: a robot written out has tens of thousands of characters."""
        return f"<Robot {self.name}: {len(self.joints)} joints, tool {self.tool}, detector {self.default_detector}>"

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names in the order of q."""
        return _find_columns(self).names

    @property
    def lower(self) -> Floats:
        """Lower limits [N], m or rad; -inf of a continuous joint."""
        return _find_columns(self).lower.copy()

    @property
    def upper(self) -> Floats:
        """Upper limits [N], m or rad; inf of a continuous joint."""
        return _find_columns(self).upper.copy()

    @property
    def home(self) -> Floats:
        """Home configuration [N], m or rad."""
        return _find_columns(self).home.copy()

    @property
    def drawn(self) -> tuple[Floats, Floats]:
        """Ranges [N] to draw configurations from: the limits, or one turn about home."""
        return self.finite_limits(self.home, 0.5)

    def finite_limits(self, centre: Floats, turns: float) -> tuple[Floats, Floats]:
        """Limits [N]; those of a continuous joint so many turns on either side of `centre` [N], rad."""
        lower, upper, is_continuous = self.lower, self.upper, _find_columns(self).is_continuous
        if is_continuous is not None:
            lower[is_continuous] = centre[is_continuous] - 2.0 * np.pi * turns
            upper[is_continuous] = centre[is_continuous] + 2.0 * np.pi * turns
        return lower, upper

    @property
    def written_ranges(self) -> tuple[Floats, Floats]:
        """Ranges [N] that written kernels hold for: `drawn`, and all between it and what it was by the robot's file.

        So a run that narrows limits needs no kernels of its own, and one that widens them has some, but for a joint
        that could rotate all around before: one turn is as good as many.
        """
        lower, upper = self.drawn
        if not self.file_ranges:
            return lower, upper
        first, last = np.array(self.file_ranges).T
        is_all = ~self.is_prismatic & (last - first >= FULL_TURN_RAD)
        return np.where(is_all, first, np.minimum(first, lower)), np.where(is_all, last, np.maximum(last, upper))

    @property
    def has_continuous(self) -> bool:
        """Whether a joint has no limits."""
        return _find_columns(self).is_continuous is not None

    @property
    def is_prismatic(self) -> NDArray[np.bool_]:
        """Which joints are prismatic [N]."""
        return _find_columns(self).is_prismatic.copy()

    def components(self, spheres: str) -> tuple[str, ...]:
        """Components of an approximation, in the order of its rows."""
        return tuple(dict.fromkeys(row.component for row in self.approximations[spheres]))

    @property
    def whole(self) -> "Robot":
        """The robot with the same tool and all joints free, as in its file."""
        return replace(self, joints=self.free_joints, free_joints=(), file_ranges=()) if self.free_joints else self

    def with_tool(self, name: str | None = None, held_at: Mapping[str, float] | None = None) -> "Robot":
        """The robot with another of its tools, whose targets no joint of another arm has to follow.

        Joints that do not move that tool are held: both of their limits are one value. They stay in q, and what they
        carry still collides.

        Args:
            name: of `tools`, or a frame; None: the same tool as now.
            held_at: where held joints stand, m or rad by name; others are at home.

        Raises:
            InputError: for a name that is none, with the nearest one; for a frame that no joint moves; for values of
                joints that move the tool, or outside their limits.
        """
        return import_module("ikde.model.tools").with_tool(self, name, held_at)

    def save(self, path: str | PathLike[str]) -> None:
        """Write the robot's file, from which `ikde.load_robot(path)` makes an equal one: YAML, m and rad.

        Limits, offsets and radii come back to the bit, rotations within 1e-15. Raises `FileError` if it cannot be
        written; then nothing is.
        """
        import_module("ikde.io.robot_writer").write_robot(self, path)  # files are above this floor


class _Columns(NamedTuple):
    """What joints say, joint by joint: 0.2 us where making an array takes 2."""

    names: tuple[str, ...]
    lower: Floats
    upper: Floats
    home: Floats
    is_prismatic: NDArray[np.bool_]
    is_continuous: NDArray[np.bool_] | None
    """None if none is."""


@lru_cache(maxsize=256)
def _find_columns(robot: Robot) -> _Columns:
    kinds = [joint.kind for joint in robot.joints]
    return _Columns(
        names=tuple(joint.name for joint in robot.joints),
        lower=np.array([joint.lower for joint in robot.joints]),
        upper=np.array([joint.upper for joint in robot.joints]),
        home=np.array([joint.home for joint in robot.joints]),
        is_prismatic=np.array([kind == "prismatic" for kind in kinds]),
        is_continuous=np.array([kind == "continuous" for kind in kinds]) if "continuous" in kinds else None,
    )
