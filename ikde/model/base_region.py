"""Where a base may stand: a polygon with holes in the x, y of the world."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ikde.errors import InputError, quoted
from ikde.kernels.arrays import Floats
from ikde.model.arguments import Where
from ikde.model.numbers import read_numbers
from ikde.model.target import MAX_MAGNITUDE
from ikde.model.value import ReadOnlyValue

MAX_CORNERS, MAX_HOLES = 1000, 100
FLAT = 1e-12  # of the square of a polygon's size: so small an area is none


@dataclass(frozen=True, slots=True, init=False, eq=False, repr=False)
class BaseRegion(ReadOnlyValue):
    """A polygon that the origin of a planar base stays in, edges included, and holes that it stays out of.

    Args:
        corners: [K, 2] in m, in order, either way round; the last is joined to the first.
        holes: polygons inside, likewise.

    Raises:
        InputError: for fewer than 3 corners, NaN, no area, polygons that cross themselves or each other, and holes
            that are not inside.
    """

    corners: Floats
    holes: tuple[Floats, ...]

    def __init__(self, corners: ArrayLike, holes: Sequence[ArrayLike] = ()) -> None:
        outline = _read_polygon(corners, ("corners",))
        if len(holes) > MAX_HOLES:
            raise InputError(f"expected at most {MAX_HOLES} holes, got {len(holes)}", ("holes",))
        others = tuple(_read_polygon(hole, ("holes", place)) for place, hole in enumerate(holes))
        _check_holes(outline, others)
        object.__setattr__(self, "corners", outline)
        object.__setattr__(self, "holes", others)
        self.__post_init__()

    def __repr__(self) -> str:
        """In a line."""
        (x0, y0), (x1, y1) = self.corners.min(axis=0), self.corners.max(axis=0)
        holes = f", {len(self.holes)} hole{'s' * (len(self.holes) > 1)}" if self.holes else ""
        return f"<BaseRegion: {len(self.corners)} corners{holes}, x {x0:.6g} to {x1:.6g} m, y {y0:.6g} to {y1:.6g} m>"

    def contains(self, points: Floats) -> NDArray[np.bool_]:
        """Whether points [K, 2] are inside and in no hole [K]."""
        inside = is_inside(self.corners, points)
        for hole in self.holes:
            inside &= ~is_inside(hole, points)
        return inside

    def edge_distances_m(self, points: Floats) -> Floats:
        """Distances [K] of points [K, 2] from the nearest edge, m."""
        return np.min([measure_edges(polygon, points) for polygon in (self.corners, *self.holes)], axis=0)


BaseRegionLike = BaseRegion | ArrayLike
"""A base region, or the corners [K, 2] of one without holes."""


def read_base_region(value: BaseRegionLike, where: Where = ("base_region",)) -> BaseRegion:
    """A base region; raises `InputError` for what is none."""
    if isinstance(value, BaseRegion):
        return value
    try:
        return BaseRegion(value)
    except InputError as error:
        raise InputError(error.message, where) from None


def is_inside(polygon: Floats, points: Floats) -> NDArray[np.bool_]:
    """Whether points [K, 2] are inside a polygon [C, 2], by the edges that a ray along x crosses."""
    (ax, ay), (bx, by) = polygon.T, np.roll(polygon, -1, axis=0).T
    x, y = points[:, :1], points[:, 1:]
    spans = (ay > y) != (by > y)
    with np.errstate(all="ignore"):
        crossing = ax + (y - ay) * ((bx - ax) / (by - ay))
    return (np.sum(spans & (x < crossing), axis=1) % 2) == 1


def measure_edges(polygon: Floats, points: Floats) -> Floats:
    """Distances [K] of points [K, 2] from the edges of a polygon, m."""
    a, along = polygon, np.roll(polygon, -1, axis=0) - polygon
    offset = points[:, None] - a
    share = np.clip(np.sum(offset * along, axis=-1) / np.sum(along * along, axis=-1), 0.0, 1.0)
    return np.linalg.norm(offset - share[..., None] * along, axis=-1).min(axis=1)


def _read_polygon(value: ArrayLike, where: Where) -> Floats:
    polygon = read_numbers(value, where)
    if polygon.ndim != 2 or polygon.shape[1:] != (2,) or not 3 <= len(polygon) <= MAX_CORNERS:
        shape = f"{len(polygon)} of them" if polygon.ndim == 2 and polygon.shape[1] == 2 else f"shape {polygon.shape}"
        raise InputError(f"expected at least 3 corners x, y, up to {MAX_CORNERS:,}, got {shape}", where)
    if not np.all(np.abs(polygon) <= MAX_MAGNITUDE):
        raise InputError(f"expected finite numbers up to {MAX_MAGNITUDE:g} m, got {quoted(polygon.tolist())}", where)
    following = np.roll(polygon, -1, axis=0)
    if same := np.flatnonzero((polygon == following).all(axis=1)).tolist():
        raise InputError(f"corner {same[0]} stands where the next one does", where)
    if crossing := _find_crossing(polygon, polygon):
        raise InputError(
            f"the polygon crosses or touches itself: its edges {crossing[0]} and {crossing[1]} meet", where
        )
    x, y = (polygon - polygon[0]).T
    area = 0.5 * abs(float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)))
    if area <= FLAT * float(np.ptp(polygon, axis=0).max()) ** 2:
        raise InputError("a polygon of zero area has no room for a base", where)
    return polygon


def _check_holes(outline: Floats, holes: Sequence[Floats]) -> None:
    for place, hole in enumerate(holes):
        if _find_crossing(outline, hole) or not is_inside(outline, hole).all():
            raise InputError("expected a hole that is inside the polygon, and does not touch it", ("holes", place))
    for (first, hole), (second, other) in combinations(enumerate(holes), 2):
        if _find_crossing(hole, other) or is_inside(hole, other).any() or is_inside(other, hole).any():
            raise InputError(f"expected holes apart from each other; this meets hole {first}", ("holes", second))


def _find_crossing(one: Floats, other: Floats) -> tuple[int, int] | None:
    """Two edges that meet, of two polygons, or of one those that are not neighbours or lie on each other."""
    a, b, c, d = one[:, None], np.roll(one, -1, axis=0)[:, None], other[None], np.roll(other, -1, axis=0)[None]
    sides = [_side(a, b, c), _side(a, b, d), _side(c, d, a), _side(c, d, b)]
    meet = (sides[0] * sides[1] <= 0) & (sides[2] * sides[3] <= 0) & _boxes_meet(a, b, c, d)
    if one is other:
        count, row = len(one), np.arange(len(one))
        apart = (row[:, None] - row) % count
        folded = (apart == count - 1) & (sides[0] == 0) & (sides[1] == 0) & (np.sum((b - a) * (d - c), axis=-1) < 0)
        meet = (meet & (apart != 0) & (apart != 1) & (apart != count - 1)) | folded
    places = np.argwhere(meet)
    return (int(places[0, 0]), int(places[0, 1])) if len(places) else None


def _side(a: Floats, b: Floats, c: Floats) -> Floats:
    """On which side of the line from a to b the point c is: the sign."""
    along, offset = b - a, c - a
    return np.sign(along[..., 0] * offset[..., 1] - along[..., 1] * offset[..., 0])


def _boxes_meet(a: Floats, b: Floats, c: Floats, d: Floats) -> NDArray[np.bool_]:
    """Whether the boxes about two edges have a point in common."""
    apart = (np.maximum(a, b) < np.minimum(c, d)) | (np.maximum(c, d) < np.minimum(a, b))
    return np.asarray(~apart.any(axis=-1))
