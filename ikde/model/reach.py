"""A proved bound on where the tool can be: what lies outside is out of reach, whatever the joints do.

Walk from the world to the tool. Joints with parallel axes form a run: along their common axis offsets and prismatic
joints add up exactly, across it they can at best be stretched into one line. So the tool lies in a ball around a convex
set that is simple: what the leading prismatic joints span, widened by the cylinder of the first run. Its distance is
approached from below: a plane that parts a point from the whole set proves how far out the point is at least.

The steps are written once, for a float or a column of them: numpy takes ten times as long for one position.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.chain import Chain, Link, is_revolute, path_to_tool
from ikde.model.robot import Robot

PARALLEL = 1e-9  # between axes of one run; by how far they are not is added to what the run can reach
SWEEPS = 60  # of the search for the nearest point; two are enough where prismatic joints are at right angles
CONVERGED, ROUNDING = 1e-13, 2e-15  # of all lengths
TINY_M = 1e-300
SKEW = 3.0  # rad: how far a matrix may rotate directions, times what it lacks of a rotation

Vector = tuple[float, float, float]
Column = Any
"""A float, or as many as there are positions [T]."""


class _Prismatic(NamedTuple):
    """A direction of length 1, and how far along it something can be at least and at most, m."""

    direction: Vector
    low: float
    high: float


class _Arithmetic(NamedTuple):
    """What is called otherwise for a column than for a float; the bits are the same."""

    least: Any
    most: Any
    root: Any


_FLOAT, _COLUMN = _Arithmetic(min, max, math.sqrt), _Arithmetic(np.minimum, np.maximum, np.sqrt)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Reach:
    """All that the tool can reach lies in here: around `centre`, the sums of prismatic joints, a disc and a ball; m."""

    centre: Vector
    prismatic: tuple[_Prismatic, ...]
    axis: Vector
    """Of the disc."""
    disc: float
    """Radius, as that of the ball."""
    ball: float
    length: float
    """All that can add up in a coordinate: rounding grows with it."""

    def excess_m(self, p_world_tool: Floats) -> float:
        """At least how far out a position [3] is, m."""
        state = self._begin(*p_world_tool.tolist())
        length = self.length + math.sqrt(_square(state[:3]))
        slack, excess = self.ball + ROUNDING * length, 0.0
        for _ in range(SWEEPS):
            distance, bound = self._sweep(state, _FLOAT)
            excess = max(0.0, bound - slack)
            if distance <= slack or distance - bound <= CONVERGED * length:
                break
        return excess

    def excess_of_many_m(self, p_world_tool: Floats) -> Floats:
        """At least how far out positions [T, 3] are [T], m: each as if it were the only one."""
        state = self._begin(*(np.ascontiguousarray(column) for column in p_world_tool.T))
        length = self.length + np.sqrt(_square(state[:3]))
        slack, excess, rows = self.ball + ROUNDING * length, np.zeros(len(length)), np.arange(len(length))
        for _ in range(SWEEPS):
            distance, bound = self._sweep(state, _COLUMN)
            excess[rows] = np.maximum(0.0, bound - slack)
            is_open = (distance > slack) & (distance - bound > CONVERGED * length)
            if not is_open.any():
                break
            state = [column[is_open] for column in state]
            rows, length, slack = rows[is_open], length[is_open], slack[is_open]
        return excess

    def _begin(self, x: Column, y: Column, z: Column) -> list[Column]:
        """The offset from the centre, what is left of it, the share of the disc, and of each prismatic joint."""
        x, y, z = x - self.centre[0], y - self.centre[1], z - self.centre[2]
        nothing = 0.0 * x
        return [x, y, z, x, y, z, nothing, nothing, nothing, *[nothing] * len(self.prismatic)]

    def _sweep(self, state: list[Column], how: _Arithmetic) -> tuple[Column, Column]:
        """Better shares of joints and disc, put into `state`; the distance that is left, and what is proved of it."""
        least, most, root = how
        ox, oy, oz, x, y, z, fx, fy, fz, *taken = state
        for k, ((dx, dy, dz), low, high) in enumerate(self.prismatic):
            before = taken[k]
            taken[k] = share = least(most(before + (x * dx + y * dy + z * dz), low), high)
            step = share - before
            x, y, z = x - step * dx, y - step * dy, z - step * dz
        if self.disc > 0.0:
            x, y, z = x + fx, y + fy, z + fz
            fx, fy, fz = self._across(x, y, z)
            share = least(1.0, self.disc / most(root(fx * fx + fy * fy + fz * fz), TINY_M))
            fx, fy, fz = fx * share, fy * share, fz * share
            x, y, z = x - fx, y - fy, z - fz
        state[:] = [ox, oy, oz, x, y, z, fx, fy, fz, *taken]
        distance = root(x * x + y * y + z * z)
        length = most(distance, TINY_M)
        nx, ny, nz = x / length, y / length, z / length
        # How far beyond all that can be summed up the offset lies along this direction.
        bound = ox * nx + oy * ny + oz * nz
        for (dx, dy, dz), low, high in self.prismatic:
            along = nx * dx + ny * dy + nz * dz
            bound = bound - most(along * low, along * high)
        return distance, bound - self.disc * root(_square(self._across(nx, ny, nz))) if self.disc > 0.0 else bound

    def _across(self, x: Column, y: Column, z: Column) -> tuple[Column, Column, Column]:
        """What of a vector lies in the plane of the disc."""
        ax, ay, az = self.axis
        along = x * ax + y * ay + z * az
        return x - along * ax, y - along * ay, z - along * az


def _square(vector: Sequence[Column]) -> Column:
    x, y, z = vector
    return x * x + y * y + z * z


@dataclass(slots=True)
class _Run:
    """Revolute joints with parallel axes, and prismatic ones between them: summed along it, stretched across it; m."""

    axis: Floats
    low: float = 0.0
    high: float = 0.0
    across: float = 0.0
    total: float = 0.0
    tilt: float = 0.0
    """Sum of the angles between the axes, rad."""

    def add(self, offset: Floats) -> None:
        self.add_prismatic(offset, 1.0, 1.0)

    def add_prismatic(self, direction: Floats, lower: float, upper: float) -> None:
        parallel = float(direction @ self.axis)
        ends = parallel * lower, parallel * upper
        self.low, self.high = self.low + min(ends), self.high + max(ends)
        largest = max(abs(lower), abs(upper))
        self.across += largest * _norm(direction - parallel * self.axis)
        self.total += largest * _norm(direction)

    @property
    def length(self) -> float:
        return math.hypot(max(abs(self.low), abs(self.high)), self.across)


def bound_reach(chain: Chain) -> Reach:
    """The bound, ready to be asked about positions. Sound for any tree; sharp for the usual ones.

    Ranges of revolute joints are ignored, except that one with an empty range is part of its link.
    """
    links = chain.links
    first = next((i for i, link in enumerate(links) if link.is_revolute), len(links))
    R, centre, prismatic = np.eye(3), np.zeros(3), []
    for link in links[:first]:
        centre = centre + R @ link.p_before_link
        R = R @ link.R_before_link
        prismatic.append(_Prismatic(as_vector(R @ link.axis), link.lower, link.upper))
    askew = SKEW * chain.skew * sum(max(abs(joint.low), abs(joint.high)) for joint in prismatic)
    if first == len(links):
        centre, no_disc = as_vector(centre + R @ chain.p_link_tool), {"axis": (0.0, 0.0, 0.0), "disc": 0.0}
        return Reach(centre=centre, prismatic=tuple(prismatic), **no_disc, ball=askew, length=chain.length_m)
    centre = centre + R @ links[first].p_before_link
    axis = as_vector(R @ links[first].R_before_link @ links[first].axis)
    runs = _runs(links[first:], chain.p_link_tool)
    askew += (2.0 * sum(run.tilt for run in runs) + SKEW * chain.skew) * sum(run.total for run in runs)
    prismatic.append(_Prismatic(axis, runs[0].low, runs[0].high))
    return Reach(
        centre=as_vector(centre),
        prismatic=tuple(prismatic),
        axis=axis,
        disc=runs[0].across,
        ball=sum(run.length for run in runs[1:]) + askew,
        length=chain.length_m,
    )


def arm_length_m(robot: Robot) -> float:
    """Length of the chain from the first revolute joint to the tool, stretched, in m; prismatic joints at zero."""
    path, p_body_tool, _ = path_to_tool(robot)
    first = next((i for i, body in enumerate(path) if is_revolute(robot, body)), len(path))
    offsets = [body.T_parent_body[:3, 3] for body in path[first + 1 :]]
    return sum(map(_norm, [*offsets, p_body_tool]))


def _runs(links: Sequence[Link], p_link_tool: Floats) -> list[_Run]:
    """Runs of the joints from the first revolute one on; axes are compared at q = 0, where parallel means parallel."""
    R_run_link = np.eye(3)
    runs = [_Run(axis=links[0].axis)]
    for position, link in enumerate(links):
        if position > 0:
            R_run_link = R_run_link @ link.R_before_link
            axis = R_run_link @ link.axis
            apart = _sine(axis, runs[-1].axis)
            if not link.is_revolute:
                runs[-1].add_prismatic(axis, link.lower, link.upper)
            elif apart <= PARALLEL:
                runs[-1].tilt += apart
            else:
                runs.append(_Run(axis=link.axis))
                R_run_link = np.eye(3)
        following = links[position + 1].p_before_link if position + 1 < len(links) else p_link_tool
        runs[-1].add(R_run_link @ following)
    return runs


def as_vector(vector: Floats) -> Vector:
    """An array [3] as floats, which count faster one by one."""
    x, y, z = vector.tolist()
    return x, y, z


def _norm(vector: Floats) -> float:
    return math.sqrt(_square(vector.tolist()))


def _sine(a: Floats, b: Floats) -> float:
    """Of the angle between vectors [3] of length 1."""
    (ax, ay, az), (bx, by, bz) = a.tolist(), b.tolist()
    return math.sqrt(_square((ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx)))
