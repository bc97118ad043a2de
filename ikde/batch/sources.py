"""Where targets come from: each source makes its targets on demand, so that memory stays flat."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal, Protocol

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.rotation import rotation_from_quat_wxyz, rotation_from_rpy
from ikde.model.target import KINDS, POSE, Target, Targets

OrientationKind = Literal["axis", "rpy", "quat_wxyz"]
Orientation = Mapping[str, Floats]
"""Keyword of `Target` -> its value; empty for a position target."""


class TargetSource(Protocol):
    """So many targets, numbered from 0."""

    @property
    def count(self) -> int:
        """Number of targets."""
        ...

    @property
    def names(self) -> tuple[str, ...] | None:
        """One name a target, or None."""
        ...

    def read(self, first: int, last: int) -> Targets:
        """Targets first .. last - 1, the same however they are cut; raises `InputError` if they cannot be had."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ListSource:
    """Targets held in memory."""

    targets: Targets | Sequence[Target]
    names: tuple[str, ...] | None = None

    @property
    def count(self) -> int:
        """Number of targets."""
        return len(self.targets)

    def read(self, first: int, last: int) -> Targets:
        """Targets first .. last - 1."""
        return Targets.of(self.targets[first:last])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TableSource:
    """Targets held as one array of numbers, for files of a million rows."""

    positions: Floats
    """[T, 3] m"""
    kind: OrientationKind | None
    orientations: Floats | None
    """[T, 3 or 4]: an axis, roll, pitch, yaw in rad, or a quaternion; None for position targets."""
    names: tuple[str, ...] | None = None

    @property
    def count(self) -> int:
        """Number of targets."""
        return len(self.positions)

    def read(self, first: int, last: int) -> Targets:
        """Targets first .. last - 1."""
        positions = self.positions[first:last]
        if self.kind is None or self.orientations is None:
            return Targets(positions)
        orientations = make_orientation(self.kind, self.orientations[first:last])
        if "R_world_tool" in orientations:
            return join_poses(POSE, positions, orientations["R_world_tool"])
        return Targets(positions, **orientations)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PointSource:
    """Points made on demand, all with the same orientation: grids, boxes, spheres."""

    count: int
    make_points: Callable[[int, int], Floats]
    """(first, last) -> positions [last - first, 3] in m."""
    orientation: Orientation = field(default_factory=dict)
    names: None = None

    def read(self, first: int, last: int) -> Targets:
        """Targets first .. last - 1."""
        one, points = Target((0.0, 0.0, 0.0), **self.orientation), self.make_points(first, min(last, self.count))
        return join_poses(KINDS.index(one.kind), points, one.R_world_tool)


def make_orientation(kind: OrientationKind, values: Floats) -> dict[str, Floats]:
    """What `Target` and `Targets` take, from axes [..., 3], roll, pitch, yaw [..., 3] in rad, or quaternions [..., 4].

    Raises:
        InputError: for a quaternion of length 0.
    """
    if kind == "axis":
        return {"axis_world_tool": np.asarray(values)}
    rotate = rotation_from_rpy if kind == "rpy" else rotation_from_quat_wxyz
    return {"R_world_tool": rotate(np.asarray(values))}


def join_poses(kind: int, p_world_tool: Floats, R_world_tool: Floats) -> Targets:
    """Targets of one kind from positions [T, 3] and rotations [T, 3, 3] or [3, 3] that are known to be right."""
    T_world_tool = np.empty((len(p_world_tool), 3, 4))
    T_world_tool[:, :, :3] = R_world_tool
    T_world_tool[:, :, 3] = p_world_tool
    return Targets.packed(np.full(len(p_world_tool), kind, dtype=np.int64), T_world_tool)
