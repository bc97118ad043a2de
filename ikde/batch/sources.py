"""Where targets come from: each source makes its targets on demand, so that memory stays flat."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Protocol

from ikde.formats.poses import Orientation, join_poses
from ikde.kernels.arrays import Floats
from ikde.model.target import KINDS, Target, Targets


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
