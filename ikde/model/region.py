"""Goals with freedom: all poses of the tool that would do, in place of one."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal, Self, get_args

import numpy as np
from numpy.typing import ArrayLike

from ikde.errors import InputError, quoted
from ikde.kernels.arrays import Floats
from ikde.model.arguments import TargetLike, TargetsLike, Where, read_target, read_targets
from ikde.model.base_region import BaseRegion, BaseRegionLike, read_base_region
from ikde.model.numbers import is_number, read_numbers
from ikde.model.target import MAX_MAGNITUDE, Target, Targets
from ikde.model.value import ReadOnlyValue

Rule = Literal["exact", "rotation", "turn", "cone", "look_at"]
BoxFrame = Literal["goal", "world"]
Take = Literal["first", "best"]

MAX_ALTERNATIVES = 1000
WHOLE = 2.0 * np.pi
AXES = "xyz"
ZERO_SIZE = "a region of zero size: this is one target; ask for that, or give it some freedom"
EXACT = np.empty(0)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class RegionPart(ReadOnlyValue):
    """One alternative of a region: a box of places about a target, and which orientations will do."""

    target: Target
    """The goal, whose frame all is counted in. Of `look_at`: the point, and the direction of sight."""
    rule: Rule
    """Which orientations: as the target says, a box of rotation vectors, turns about an axis, a cone; or what
    looks at a point."""
    numbers: Floats
    """Of the rule: none; [3, 2] rad; axis and least and largest angle [5]; angle [1]; distances in m and angle [3]."""
    box_m: Floats
    """[3, 2] least and largest offset of the tool's origin along each axis, m."""
    R_world_box: Floats
    """[3, 3] these axes."""

    def __repr__(self) -> str:
        """In a line, m and rad."""
        point = ", ".join(f"{x:.6g}" for x in self.target.p_world_tool)
        if self.rule == "look_at":
            low, high, angle = self.numbers.tolist()
            about = "" if angle >= np.pi else f", along its direction to {angle:.6g} rad"
            return f"looks at {point} m from {low:.6g} to {high:.6g} m{about}"
        ranges = [f"{name} {_tell(*row)} m" for name, row in zip(AXES, self.box_m.tolist(), strict=True) if any(row)]
        return f"{', '.join([self._tell_rule(), *ranges])} about {point} m"

    def _tell_rule(self) -> str:
        numbers = self.numbers.tolist()
        if self.rule == "turn":
            axis = " ".join(f"{x:.6g}" for x in numbers[:3])
            return f"turn {_tell(*numbers[3:])} rad about {axis}"
        if self.rule == "cone":
            return f"cone of {numbers[0]:.6g} rad"
        if self.rule == "rotation":
            return f"pose, {', '.join(f'r{a} {_tell(*r)} rad' for a, r in zip(AXES, numbers, strict=True) if any(r))}"
        return str(self.target.kind)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Region(ReadOnlyValue):
    """Poses of the tool any of which will do: made by `Region.box`, `turn`, `cone`, `look_at` and `any_of`.

    Lengths in m, angles in rad. Each takes a goal (`Target`, or what `solve` takes for one). `position_m` lets the
    tool's origin be off it: a number (so much either way along each axis), three, or least and largest [3, 2]. `frame`
    says along which axes: the goal's own, of a full pose, or `"world"`, as always without one.
    """

    parts: tuple[RegionPart, ...]
    """The alternatives, in their order; mostly one."""
    take: Take = "first"
    """Of several: the one that is reached first, or of all that are reached the one with the least motion."""
    base: BaseRegion | None = None
    """Where a planar base may stand; None: anywhere in its ranges."""

    @classmethod
    def box(
        cls, target: TargetLike, position_m: ArrayLike = 0.0, rotation_rad: ArrayLike = 0.0, frame: BoxFrame = "goal"
    ) -> Self:
        """A tolerance box about a goal.

        `rotation_rad`, given as `position_m` is, holds the components of the rotation vector from the goal's
        orientation to the tool's, about the goal's own axes; only a full pose has them. Up to pi each.

        Raises:
            InputError: for a range that is inside out, NaN, a region of zero size, or rotations of what is no pose.
        """
        goal, ranges = read_target(target), _read_ranges(rotation_rad, "rotation_rad", np.pi)
        if ranges.any() and goal.kind != "pose":
            raise InputError("only a full pose has rotations to be off by; an axis may have a cone", ("rotation_rad",))
        rule, numbers = ("rotation", ranges) if ranges.any() else ("exact", EXACT)
        return cls._make(goal, rule, numbers, position_m, frame)

    @classmethod
    def turn(
        cls,
        target: TargetLike,
        axis: ArrayLike = (0.0, 0.0, 1.0),
        angle_rad: ArrayLike = (-np.pi, np.pi),
        position_m: ArrayLike = 0.0,
        frame: BoxFrame = "goal",
    ) -> Self:
        """A pose that may be turned about an axis [3] of the goal's own frame, by an angle from least to largest.

        The default is a free turn about the tool's axis z.

        Raises:
            InputError: for what is no full pose, an axis of length 0, angles that are inside out.
        """
        goal = read_target(target)
        if goal.kind != "pose":
            raise InputError("a turn is about an axis of a full pose; give one", ("target",))
        direction = Target((0.0, 0.0, 0.0), axis_world_tool=axis).axis_world_tool
        low, high = _read_range(angle_rad, "angle_rad")
        if max(-low, high) > WHOLE:
            raise InputError(
                f"expected angles within {WHOLE:g} rad, a whole turn, got {low:g}, {high:g}", ("angle_rad",)
            )
        if high - low >= WHOLE:
            low, high = -np.pi, np.pi
        return cls._make(goal, "turn", np.array([*direction, low, high]), position_m, frame)

    @classmethod
    def cone(cls, target: TargetLike, angle_rad: float, position_m: ArrayLike = 0.0, frame: BoxFrame = "goal") -> Self:
        """The tool's z axis within an angle of the goal's; the rotation about it is free. A full pose, or an axis.

        Raises:
            InputError: for an angle that is negative or over pi (180 degrees), or a goal without a direction.
        """
        goal = read_target(target)
        if goal.kind == "position":
            raise InputError("a cone needs a direction: a target with axis_world_tool, or a full pose", ("target",))
        return cls._make(goal, "cone", np.array([_read_angle(angle_rad)]), position_m, frame)

    @classmethod
    def look_at(
        cls,
        p_world_point: ArrayLike,
        distance_m: ArrayLike,
        axis_world_tool: ArrayLike | None = None,
        angle_rad: float | None = None,
    ) -> Self:
        """The tool's z axis points at a point [3] in m, from a distance: least and largest [2] in m.

        `axis_world_tool` [3] is the direction of sight to begin with, default straight down; the others are within
        `angle_rad` of it, by default any.

        Raises:
            InputError: for distances that are negative or inside out, or an angle over pi.
        """
        direction = (0.0, 0.0, -1.0) if axis_world_tool is None else axis_world_tool
        goal = Target(_read_point(p_world_point), axis_world_tool=direction)
        low, high = _read_range(distance_m, "distance_m")
        if low < 0.0 or high > MAX_MAGNITUDE:
            raise InputError(
                f"expected distances from 0 to {MAX_MAGNITUDE:g} m, got {low:g}, {high:g}", ("distance_m",)
            )
        angle = np.pi if angle_rad is None else _read_angle(angle_rad)
        return cls._make(goal, "look_at", np.array([low, high, angle]), 0.0, "world")

    @classmethod
    def any_of(cls, goals: Iterable[GoalLike], take: Take = "first") -> Self:
        """Alternatives: targets or regions, whose own alternatives count one by one.

        `take`: `"first"`, the one that is reached first, in order where several are tried alike; `"best"`, of all that
        are reached the one with the least motion from `near`, else from home.

        Raises:
            InputError: for none, for more than 1,000, for what is no goal, and an unknown word.
        """
        if take not in get_args(Take):
            raise InputError(f"expected one of {', '.join(get_args(Take))}, got {quoted(take)}", ("take",))
        if isinstance(goals, Region | Target | str) or not isinstance(goals, Iterable):
            raise InputError(f"expected a sequence of targets and regions, got {quoted(goals)}", ("goals",))
        regions = [read_region(goal, ("goals", row)) for row, goal in enumerate(goals)]
        for row, region in enumerate(regions):
            if region.base is not None:
                raise InputError("alternatives share a base region: give it to all of them", ("goals", row))
        parts = [part for region in regions for part in region.parts]
        if not 1 <= len(parts) <= MAX_ALTERNATIVES:
            raise InputError(f"expected 1 to {MAX_ALTERNATIVES:,} alternatives, got {len(parts):,}", ("goals",))
        return cls(parts=tuple(parts), take=take)

    @classmethod
    def of(cls, target: TargetLike) -> Self:
        """Exactly a target: what has no freedom but where the base stands (`with_base`)."""
        goal, box = read_target(target), np.zeros((3, 2))
        part = RegionPart(target=goal, rule="exact", numbers=EXACT, box_m=box, R_world_box=np.eye(3))
        return cls(parts=(part,))

    def with_base(self, base: BaseRegionLike) -> Self:
        """The same with a planar base that stands in a `BaseRegion`, or in a polygon of these corners [K, 2], m.

        Raises:
            InputError: for what makes no base region.
        """
        return replace(self, base=read_base_region(base, ("base",)))

    def __repr__(self) -> str:
        """In a line."""
        first, base = repr(self.parts[0]), "" if self.base is None else f", base in {len(self.base.corners)} corners"
        if len(self.parts) == 1:
            return f"<Region: {first}{base}>"
        return f"<Region: {self.take} of {len(self.parts)} alternatives, the first {first}{base}>"

    @classmethod
    def _make(cls, goal: Target, rule: Rule, numbers: Floats, position_m: ArrayLike, frame: BoxFrame) -> Self:
        if frame not in get_args(BoxFrame):
            raise InputError(f"expected one of {', '.join(get_args(BoxFrame))}, got {quoted(frame)}", ("frame",))
        box = _read_ranges(position_m, "position_m", MAX_MAGNITUDE)
        R = goal.R_world_tool if goal.kind == "pose" and frame == "goal" else np.eye(3)
        part = RegionPart(target=goal, rule=rule, numbers=numbers, box_m=box, R_world_box=R)
        if not has_freedom(part):
            raise InputError(ZERO_SIZE)
        return cls(parts=(part,))


GoalLike = TargetLike | Region
"""A target, what is taken for one, or a region."""
GoalsLike = TargetsLike | Region | Iterable[GoalLike]
"""Many of them."""


def read_region(goal: GoalLike, where: Where = ("target",)) -> Region:
    """A region as it is, and a target as one without freedom; raises `InputError` for what is neither."""
    return goal if isinstance(goal, Region) else Region.of(read_target(goal, where))


def read_goals(goals: GoalsLike, where: Where = ("targets",)) -> Targets | list[Target | Region]:
    """Many targets, or a list of goals of which some have freedom; one goal is one row.

    Raises:
        InputError: for what is none, with its row.
    """
    if isinstance(goals, Region):
        return [goals]
    is_list = not isinstance(goals, Targets | np.ndarray | str | bytes | Mapping) and not hasattr(goals, "__array__")
    listed: list[Any] = list(goals) if isinstance(goals, Iterable) and is_list else []
    if not any(isinstance(goal, Region) for goal in listed):
        return read_targets(listed if isinstance(goals, Iterator) else goals, where)  # type: ignore[arg-type]
    return [g if isinstance(g, Region) else read_target(g, (*where, row)) for row, g in enumerate(listed)]


def has_freedom(part: RegionPart) -> bool:
    """Whether it holds more than one target."""
    numbers = part.numbers.tolist()
    if part.rule == "look_at":
        return numbers[1] > numbers[0] or numbers[2] > 0.0
    if (part.box_m[:, 1] > part.box_m[:, 0]).any():
        return True
    if part.rule == "rotation":
        return any(high > low for low, high in numbers)
    if part.rule == "turn":
        return numbers[4] > numbers[3]
    return part.rule == "cone" and (numbers[0] > 0.0 or part.target.kind == "pose")


def _tell(low: float, high: float) -> str:
    return f"+-{high:.6g}" if low == -high else f"{low:.6g} to {high:.6g}"


def _read_point(value: ArrayLike) -> Floats:
    point = read_numbers(value, ("p_world_point",))
    if point.shape != (3,):
        raise InputError(f"expected a point [3] in m, got shape {point.shape}", ("p_world_point",))
    return point


def _read_angle(value: float) -> float:
    if not is_number(value) or not 0.0 <= value <= np.pi:
        raise InputError(f"expected an angle from 0 to pi (180 degrees), got {quoted(value)}", ("angle_rad",))
    return float(value)


def _read_range(value: ArrayLike, name: str) -> tuple[float, float]:
    """Least and largest."""
    pair = read_numbers(value, (name,))
    if pair.shape != (2,) or not np.isfinite(pair).all():
        raise InputError(f"expected least and largest, two finite numbers, got {quoted(value)}", (name,))
    low, high = pair.tolist()
    if low > high:
        raise InputError(f"inside out: the least, {low:g}, is above the largest, {high:g}", (name,))
    return low, high


def _read_ranges(value: ArrayLike, name: str, most: float) -> Floats:
    """Least and largest of three axes [3, 2] from a number, three, or all six."""
    given = read_numbers(value, (name,))
    if given.shape not in ((), (3,), (3, 2)):
        raise InputError(f"expected a number, three, or least and largest [3, 2], got shape {given.shape}", (name,))
    if not np.all(np.abs(given) <= most):  # so for NaN
        unit = "rad" if name.endswith("_rad") else "m"
        raise InputError(f"expected finite numbers up to {most:g} {unit}, got {quoted(given.tolist())}", (name,))
    if given.ndim < 2:
        if (given < 0.0).any():
            raise InputError(f"inside out: expected at least 0 either way, got {quoted(given.tolist())}", (name,))
        high = np.broadcast_to(given, (3,))
        return np.stack([-high, high], axis=1) + 0.0
    for axis, (low, high) in zip(AXES, given.tolist(), strict=True):
        if low > high:
            raise InputError(f"inside out along {axis}: the least, {low:g}, is above the largest, {high:g}", (name,))
    return given
