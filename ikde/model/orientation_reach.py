"""A proved bound on the orientation of the tool: whatever is farther off is out of reach, wherever the tool is.

A direction that is fixed in the tool keeps its angle to the axis of the last revolute joint. Seen from the axis
before, that angle lies in an interval, given by the angle between the two axes; and so on to the first joint, whose
axis does not move. Joint ranges are ignored, except that a revolute joint with an empty range is part of its link.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ikde.kernels.arrays import AXIS, POSE, Floats
from ikde.model.chain import Chain
from ikde.model.reach import SKEW, Vector, as_vector
from ikde.model.rotation import measure_skew
from ikde.model.target import Target, Targets

ROUNDING_RAD = 1e-14  # of each joint


class Cone(NamedTuple):
    """Directions of the tool and of the world, [3] each: the angle between them stays from `low` to `high`, rad."""

    tool: Vector
    world: Vector
    low: float
    high: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class OrientationReach:
    """All orientations of the tool lie in these cones; there are none for a tool that can have any orientation."""

    of_axis: tuple[Cone, ...]
    """Of the tool's z axis."""
    of_pose: tuple[Cone, ...]
    slack_rad: float
    """What rounding, and matrices that are no exact rotations, may add up to."""

    def excess_rad(self, target: Target) -> float:
        """At least how far off the tool's orientation stays, rad."""
        cones = self._find_cones(target)
        if not cones:
            return 0.0
        rows = target.R_world_tool.tolist()
        excess = max(_leave_one(cone, rows) for cone in cones)
        if excess <= self.slack_rad:
            return 0.0
        return max(0.0, excess - self.slack_rad - SKEW * float(measure_skew(target.R_world_tool[None])[0]))

    def find_worst(self, target: Target) -> Cone:
        """The cone that a target asks the tool to leave by most; there must be one."""
        rows = target.R_world_tool.tolist()
        return max(self._find_cones(target), key=lambda cone: _leave_one(cone, rows))

    def _find_cones(self, target: Target) -> tuple[Cone, ...]:
        return {"position": (), "axis": self.of_axis, "pose": self.of_pose}[target.kind]

    def excess_of_many_rad(self, targets: Targets) -> Floats:
        """At least how far off the tool's orientation stays from each target [T], rad."""
        excess = np.zeros(len(targets))
        for kind, cones in ((AXIS, self.of_axis), (POSE, self.of_pose)):
            rows = np.flatnonzero(targets.kind == kind) if cones else ()
            if not len(rows):
                continue
            R = targets.R_world_tool[rows]
            wanted = [[_dot(row, cone.tool) for row in np.moveaxis(R, 0, -1)] for cone in cones]
            off = np.max([_leave(cone, w) for cone, w in zip(cones, wanted, strict=True)], axis=0)
            excess[rows] = np.maximum(0.0, off - self.slack_rad - SKEW * measure_skew(R))
        return excess


def bound_orientation(chain: Chain) -> OrientationReach:
    """The bound, ready to be asked about targets."""
    axes, own, R_last_tool = _find_axes(chain)
    slack = SKEW * chain.skew + ROUNDING_RAD * chain.skews
    every = _enclose(axes, own, R_last_tool)
    cones = [cone for cone in every if cone.low > slack or cone.high < np.pi - slack]
    return OrientationReach(of_axis=tuple(cones[: every[0] in cones]), of_pose=tuple(cones), slack_rad=slack)


def _find_axes(chain: Chain) -> tuple[list[Floats], list[Floats], Floats]:
    """Axes [3] of the joints that rotate the tool, from the world on, each as the joint before moves it and as
    the joint itself does; and the rotation [3, 3] from what the last of them moves to the tool."""
    axes, own, R = [], [], np.eye(3)
    for link in chain.links:
        R = R @ link.R_before_link
        if link.is_revolute:
            axes.append(R @ link.axis)
            own.append(link.axis)
            R = np.eye(3)
    return axes, own, R @ chain.R_link_tool


def _enclose(axes: Sequence[Floats], own: Sequence[Floats], R_last_tool: Floats) -> list[Cone]:
    """The cones of the tool's z, x, y and the axis of its last joint, around the first joint's axis.

    A direction of a tool that nothing rotates stays where it is.
    """
    directions = [*np.eye(3)[[2, 0, 1]], *([R_last_tool.T @ own[-1]] if own else [])]
    between = [_angle(before, axis) for axis, before in zip(axes[:0:-1], own[-2::-1], strict=True)]
    cones = []
    for direction in directions:
        here = R_last_tool @ direction
        low = high = _angle(own[-1], here) if own else 0.0
        for apart in between:
            low, high = max(0.0, low - apart, apart - high), min(np.pi, high + apart, 2.0 * np.pi - apart - low)
        cones.append(Cone(as_vector(direction), as_vector(axes[0] if axes else here), low, high))
    return cones


def _angle(a: Floats, b: Floats) -> float:
    """Between vectors [3] of length 1, in [0, pi] rad."""
    (ax, ay, az), (bx, by, bz) = a.tolist(), b.tolist()
    across = math.hypot(ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx)
    return math.atan2(across, ax * bx + ay * by + az * bz)


def _leave_one(cone: Cone, rows: Sequence[Sequence[float]]) -> float:
    """How far out of a cone a rotation of the tool, given by its rows, takes it, rad; below 0 inside."""
    return float(_leave(cone, [_dot(row, cone.tool) for row in rows], math.sqrt, max))


def _leave(cone: Cone, wanted: Sequence[Any], root: Any = np.sqrt, most: Any = np.maximum) -> Any:
    """How far out of a cone directions [3, ...] in the world are [...], rad; below 0 inside."""
    ax, ay, az = cone.world
    x, y, z = wanted
    cx, cy, cz = ay * z - az * y, az * x - ax * z, ax * y - ay * x
    # numpy's for floats, too: the last bits of `math.atan2` are others.
    angle = np.arctan2(root(cx * cx + cy * cy + cz * cz), ax * x + ay * y + az * z)
    return most(cone.low - angle, angle - cone.high)


def _dot(a: Sequence[Any], b: Sequence[float]) -> Any:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
