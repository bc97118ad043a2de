"""Where the base stands in an attempt: one place of the region that it may stand in, and the room around that.

The first attempt has the box about the whole polygon; what is outside is refused by the grader. Each further one has
a square about a point of the polygon, inside it, or where there is little room the point itself: then the base's x and
y are frozen. Only points from which bounds leave the target in reach are taken.
"""

from dataclasses import replace
from functools import cached_property

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.base_motion import need_base
from ikde.model.base_region import BaseRegion
from ikde.model.bounds import find_bounds
from ikde.model.target import Target
from ikde.solver.problem import Problem
from ikde.solver.region_draws import draw_points
from ikde.solver.verify import Bools

POINTS = 1024  # of the polygon's box that are drawn
NARROW_M = 0.1  # half a square's edge: the base is frozen where there is less room
INSCRIBED = 0.7  # half the edge of a square in a circle of radius 1


class BasePlaces:
    """The places of one search."""

    def __init__(self, problem: Problem, region: BaseRegion, seed: int, stream: int) -> None:
        self._problem, self._region, self._random = problem, region, (seed, stream)
        self._joints = [*need_base(problem.robot)[:2]]
        self.whole = self._narrow(region.corners.min(axis=0), region.corners.max(axis=0))
        """The question with the base in the box about the polygon."""

    def narrow(self, number: int, target: Target) -> Problem | None:
        """The question of attempt `number`; None: from no place that was drawn the target is in reach."""
        if number == 0:
            return self.whole
        points, room = self._points
        rows = np.flatnonzero(self._is_in_reach(target, points, room))
        if not len(rows):
            return None
        row = rows[(number - 1) % len(rows)]
        half = room[row] if room[row] >= NARROW_M else 0.0
        return self._narrow(points[row] - half, points[row] + half)

    @cached_property
    def _points(self) -> tuple[Floats, Floats]:
        """Points [K, 2] of the polygon inside the base's ranges, and half the edge of a square about each [K], m."""
        low, high = self._ranges
        points = low + draw_points(np.arange(POINTS), 2, *self._random) * (high - low)
        points = points[self._region.contains(points)]
        return points, INSCRIBED * self._region.edge_distances_m(points)

    @property
    def _ranges(self) -> tuple[Floats, Floats]:
        return self.whole.lower[self._joints], self.whole.upper[self._joints]

    def _is_in_reach(self, target: Target, points: Floats, room: Floats) -> Bools:
        """From which points the target is not proved out of reach: the base moves the whole robot along."""
        lower, upper = self._problem.lower.copy(), self._problem.upper.copy()
        lower[self._joints] = upper[self._joints] = 0.0
        seen = target.p_world_tool - np.column_stack([points, np.zeros(len(points))])
        far = find_bounds(self._problem.robot, lower, upper).reach.excess_of_many_m(seen)
        return far <= 2.0 * room + self._problem.settings.position_tolerance_m

    def _narrow(self, low: Floats, high: Floats) -> Problem:
        """The question with the base's x and y between these [2]."""
        asked = self._problem
        lower, upper = asked.lower.copy(), asked.upper.copy()
        lower[self._joints] = np.minimum(np.maximum(lower[self._joints], low), upper[self._joints])
        upper[self._joints] = np.maximum(np.minimum(upper[self._joints], high), lower[self._joints])
        names = [asked.robot.joint_names[k] for k in self._joints if lower[k] == upper[k]]
        frozen = (*asked.frozen, *(name for name in names if name not in asked.frozen))
        near = None if asked.near is None else np.minimum(np.maximum(asked.near, lower), upper)
        return replace(asked, lower=lower, upper=upper, frozen=frozen, near=near)
