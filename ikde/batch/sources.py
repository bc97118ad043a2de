"""Where targets come from: each source makes its targets on demand, so that memory stays flat."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Protocol

from ikde.formats.poses import Orientation, join_poses
from ikde.kernels.arrays import Floats, Ints
from ikde.model.region import Region
from ikde.model.target import KINDS, Target, Targets

Goals = Targets | list[Target | Region]
"""Targets of a run; a list where it has goals with freedom."""


def take_goals(goals: Goals, places: Ints) -> Goals:
    """Those at some places [K], in this order."""
    return goals.take(places) if isinstance(goals, Targets) else [goals[place] for place in places.tolist()]


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

    def read(self, first: int, last: int) -> Goals:
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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GoalSource:
    """Goals held in memory, some of them with freedom."""

    goals: Sequence[Target | Region]
    names: tuple[str, ...] | None = None

    @property
    def count(self) -> int:
        """Number of goals."""
        return len(self.goals)

    def read(self, first: int, last: int) -> Goals:
        """Goals first .. last - 1."""
        return list(self.goals[first:last])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FreedomSource:
    """The targets of another source, each with the same freedom."""

    source: TargetSource
    loosen: Callable[[Target], Region]

    @property
    def count(self) -> int:
        """Number of targets."""
        return self.source.count

    @property
    def names(self) -> tuple[str, ...] | None:
        """Those of the targets."""
        return self.source.names

    def read(self, first: int, last: int) -> Goals:
        """Goals first .. last - 1."""
        targets = self.source.read(first, last)
        return [self.loosen(target) for target in Targets.of(targets)]  # type: ignore[arg-type]
