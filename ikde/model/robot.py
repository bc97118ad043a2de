"""A robot as data: joints, a tree of frames, sphere approximations, pair lists and detectors. SI units."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ikde.errors import InputError, nearest
from ikde.kernels.arrays import Floats
from ikde.model.names import check_printable
from ikde.model.numbers import is_number

WORLD = "world"
NO_DETECTOR = "none"
TOOL = "tool"  # what the tool's frame is called beside its own name
FARTHEST = 1e5  # m or rad, of all that a robot is made of: beyond it an angle has lost its last digits

JointKind = Literal["revolute", "prismatic"]
Spacing = Literal["touching", "even"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Joint:
    """One coordinate of q: its range and home value, in m (prismatic) or rad (revolute)."""

    name: str
    kind: JointKind
    lower: float
    upper: float
    home: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Frame:
    """A frame of the tree: T_parent_frame(q) = [R_parent_frame, p_parent_frame] @ joint motion about `axis`."""

    name: str
    parent: str
    p_parent_frame: Floats
    """[3] m"""
    R_parent_frame: Floats
    """[3, 3]"""
    joint: str | None = None
    axis: Floats | None = None
    """[3] unit vector in this frame; the joint turns about it or slides along it."""


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
    """The two driven wheels of a base that drives in the plane and turns, side by side on one axis."""

    radius_m: float
    half_track_m: float
    """From the middle of the base, the origin of what its turning joint moves, to either wheel."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Provenance:
    """Where a number comes from: printed, forced by printed numbers, or chosen inside what they leave free."""

    kind: Literal["published", "derived", "calibrated"]
    text: str


Pairs = tuple[tuple[str, str], ...]
NAMED = 3  # pairs in a message that is about many
MOST_PAIRS, MOST_SPHERE_PAIRS = 50_000, 2_000_000  # of components in a list, and of spheres that a detector compares


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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, weakref_slot=True)
class Robot:
    """A robot that has been checked: parents come before children and every name resolves (`model.validate`)."""

    name: str
    title: str
    joints: tuple[Joint, ...]
    frames: tuple[Frame, ...]
    tool: str
    approximations: Mapping[str, tuple[SphereRow, ...]]
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
    """None for a robot without a base that drives on two wheels, and for one whose wheels nobody told."""
    neighbours: tuple[LeftOutPair, ...] = ()
    """Every pair that `non_adjacent` leaves out; made by `model.validate`."""

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names in the order of q."""
        return tuple(joint.name for joint in self.joints)

    @property
    def lower(self) -> Floats:
        """Lower limits [N], m or rad."""
        return np.array([joint.lower for joint in self.joints])

    @property
    def upper(self) -> Floats:
        """Upper limits [N], m or rad."""
        return np.array([joint.upper for joint in self.joints])

    @property
    def home(self) -> Floats:
        """Home configuration [N], m or rad."""
        return np.array([joint.home for joint in self.joints])

    @property
    def slides(self) -> NDArray[np.bool_]:
        """Which joints are prismatic [N]."""
        return np.array([joint.kind == "prismatic" for joint in self.joints])

    def detector(self, choice: "str | Detector | None") -> Detector | None:
        """Resolve a detector: a name, a `Detector`, or None for the robot's default; `"none"` compares nothing."""
        if isinstance(choice, Detector):
            check_detector(self, choice, ("detector",))
            return choice
        name = self.default_detector if choice is None else choice
        if name == NO_DETECTOR:
            return None
        if name not in self.detectors:
            raise InputError(
                f"{self.name} has no detector {name!r}; it has {', '.join([*self.detectors, NO_DETECTOR])}"
            )
        return self.detectors[name]

    def pairs(self, detector: Detector | None) -> Pairs:
        """Pairs that a detector compares; none without a detector."""
        return self.pair_lists[detector.pairs] if detector else ()

    def left_out_pairs(self, detector: Detector | None) -> tuple[LeftOutPair, ...]:
        """All other pairs of components, and why a detector leaves them out; none without a detector."""
        if detector is None:
            return ()
        compared = {frozenset(pair) for pair in self.pairs(detector)}
        reasons = {frozenset((pair.a, pair.b)): pair.reason for pair in self.neighbours}
        unlisted = f"not in the pair list {detector.pairs}"
        return tuple(
            LeftOutPair(a=a, b=b, reason=reasons.get(frozenset((a, b)), unlisted))
            for a, b in combinations(self.components(detector.spheres), 2)
            if frozenset((a, b)) not in compared
        )

    def components(self, spheres: str) -> tuple[str, ...]:
        """Components of an approximation, in the order of its rows."""
        return tuple(dict.fromkeys(row.component for row in self.approximations[spheres]))


def check_detector(robot: Robot, detector: Detector, where: tuple[str | int, ...]) -> None:
    """Raise `InputError` unless the detector's names exist, and it compares pairs that its approximation describes."""
    for key, what, name, known in (
        ("spheres", "approximation", detector.spheres, robot.approximations),
        ("pairs", "pair list", detector.pairs, robot.pair_lists),
    ):
        if name not in known:
            raise InputError(f"no {what} is called {name!r}{nearest(name, known)}", (*where, key))
    check_printable(detector.name, (*where, "name"))
    if detector.name == NO_DETECTOR:
        raise InputError(f"{NO_DETECTOR!r} is taken: it stands for no detector at all", where)
    distance = detector.safe_distance_m
    if not (is_number(distance) and 0.0 <= distance <= FARTHEST):
        raise InputError(f"expected a distance of at least 0, up to {FARTHEST:g} m", (*where, "safe_distance"))
    described = robot.components(detector.spheres)
    if not described:
        raise InputError(f"this detector compares nothing: {detector.spheres!r} has no spheres", (*where, "spheres"))
    if not robot.pairs(detector):
        raise InputError(f"this detector compares nothing: {_explain_no_pairs(robot, detector)}", (*where, "pairs"))
    for component in {c for pair in robot.pair_lists[detector.pairs] for c in pair}:
        if component not in described:
            raise InputError(
                f"the approximation {detector.spheres!r} has no component {component!r}", (*where, "pairs")
            )
    _check_size(robot, detector, where)


def _check_size(robot: Robot, detector: Detector, where: tuple[str | int, ...]) -> None:
    """Comparing takes time with every pair, also where a file is only shown."""
    pairs = robot.pairs(detector)
    if len(pairs) > MOST_PAIRS:
        raise InputError(f"expected at most {MOST_PAIRS:,} pairs of components, got {len(pairs):,}", (*where, "pairs"))
    spheres: Counter[str] = Counter()
    for row in robot.approximations[detector.spheres]:
        spheres[row.component] += row.count
    compared = sum(spheres[a] * spheres[b] for a, b in pairs)
    if compared > MOST_SPHERE_PAIRS:
        message = f"expected at most {MOST_SPHERE_PAIRS:,} pairs of spheres to compare, got {compared:,}"
        raise InputError(message, (*where, "spheres"))


def _explain_no_pairs(robot: Robot, detector: Detector) -> str:
    left_out = robot.left_out_pairs(detector)
    if not left_out:
        return f"{robot.components(detector.spheres)[0]!r} is the only component"
    named = ", ".join(f"{pair.a} - {pair.b} ({pair.reason})" for pair in left_out[:NAMED])
    more = f" and {len(left_out) - NAMED} more" if len(left_out) > NAMED else ""
    return f"{'the only pair is' if len(left_out) == 1 else f'all {len(left_out)} pairs are'} left out: {named}{more}"
