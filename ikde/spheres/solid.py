"""A body given by triangles: how far points are from its surface, and which are inside."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ikde.kernels.arrays import Floats, Ints

Bools = NDArray[np.bool_]
BLOCK = 100_000  # triangles and points at a time


@dataclass(frozen=True, slots=True, eq=False)
class Triangles:
    """Triangles with what distances need of them, in m."""

    corners: Floats
    """[T, 3, 3]: triangle, corner, coordinate."""
    edges: Floats
    """[T, 3, 3] from each corner to the next."""
    normals: Floats
    """[T, 3], as long as twice the triangle's area."""
    inward: Floats
    """[T, 3, 3] in the triangle's plane, at right angles to each edge."""

    @staticmethod
    def of(corners: Floats) -> "Triangles":
        """What distances need of triangles [T, 3, 3] in m."""
        edges = np.roll(corners, -1, axis=1) - corners
        normals = np.cross(edges[:, 0], edges[:, 1])
        return Triangles(corners, edges, normals, np.cross(normals[:, None], edges))

    def take(self, rows: Ints | Bools) -> "Triangles":
        """Some of them."""
        return Triangles(self.corners[rows], self.edges[rows], self.normals[rows], self.inward[rows])

    @property
    def areas(self) -> Floats:
        """[T] m2."""
        return 0.5 * np.sqrt((self.normals**2).sum(axis=1))

    def distances(self, points: Floats) -> Floats:
        """[P] m from points [P, 3] to the nearest of these triangles.

        The nearest point of a triangle is the foot of the perpendicular where that is inside, else a point of an edge.
        """
        corners, edges, inward = (a.transpose(1, 2, 0) for a in (self.corners, self.edges, self.inward))
        # coordinate by coordinate: twice as fast as vectors along the last axis
        size = _dot(self.normals, self.normals)
        plane = _sum(_away(points, corners[0]), self.normals.T) ** 2 / np.where(size > 0.0, size, 1.0)
        over, nearest = np.broadcast_to(size > 0.0, plane.shape), np.full(plane.shape, np.inf)
        for corner, edge, side in zip(corners, edges, inward, strict=True):
            away, length = _away(points, corner), _sum(edge, edge)
            over = over & (_sum(away, side) >= 0.0)
            along = np.clip(_sum(away, edge) / np.where(length > 0.0, length, 1.0), 0.0, 1.0)
            foot = [a - along * e for a, e in zip(away, edge, strict=True)]
            nearest = np.minimum(nearest, _sum(foot, foot))
        return np.sqrt(np.where(over, plane, nearest).min(axis=1))

    def winding(self, point: Floats) -> float:
        """How often they go round a point [3]: the sum of their signed solid angles / 4 pi."""
        return float(self.windings(point[None])[0])

    def windings(self, points: Floats) -> Floats:
        """[P] of each of points [P, 3], in blocks of `BLOCK` triangles and points."""
        step = max(1, BLOCK // max(1, len(self.corners)))
        blocks = [self._wind(points[start : start + step]) for start in range(0, len(points), step)]
        return np.concatenate(blocks) if blocks else np.empty(0)

    def _wind(self, points: Floats) -> Floats:
        a, b, c = (self.corners[:, k] - points[:, None] for k in range(3))
        la, lb, lc = (np.sqrt(_dot(x, x)) for x in (a, b, c))
        ab, bc, ca = _dot(a, b), _dot(b, c), _dot(c, a)
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = ([x[..., k] for k in range(3)] for x in (a, b, c))
        volume = ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
        return np.arctan2(volume, la * lb * lc + ab * lc + bc * la + ca * lb).sum(axis=1) / (2.0 * np.pi)


def _dot(a: Floats, b: Floats) -> Floats:
    """Of vectors along the last axis, in one order: the same bits on every machine."""
    return a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1] + a[..., 2] * b[..., 2]


def _sum(a: Sequence[Floats] | Floats, b: Sequence[Floats] | Floats) -> Floats:
    """The same of vectors along the first axis."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _away(points: Floats, corners: Floats) -> list[Floats]:
    """[P, T] of each coordinate, from corners [3, T] to points [P, 3]."""
    return [p[:, None] - c for p, c in zip(points.T, corners, strict=True)]


@dataclass(frozen=True, slots=True, eq=False)
class Solid:
    """A body: all that closed parts enclose, and sheets, which enclose nothing."""

    surface: Triangles
    """All of the body's surface, and of the parts what is not proved to lie inside another one."""
    parts: Triangles
    """Of the closed parts, their normals outwards."""

    def depth(self, point: Floats) -> float:
        """How deep a point [3] is inside in m, at least; negative outside, where it is the distance."""
        distance = float(self.surface.distances(point[None])[0])
        return distance if self.parts.winding(point) > 0.5 else -distance
