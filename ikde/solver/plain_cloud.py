"""The nearest points of a cloud in plain numpy, for graders: boxes in boxes about its points, all queries at once.

Exact, and nothing is shared with the cells of the kernels (`model/pack_world.py`, `kernels/world_grades.py`). Of each
group of spheres only the smallest gap is asked for. A box is left out if all of it is farther than a point that is
known; of each box one point is measured before the boxes inside it are.
"""

import weakref
from typing import NamedTuple

import numpy as np

from ikde.kernels.arrays import Floats, Ints

BITS = 10  # of a cell along an axis, where cells are smallest
LEAF = 16  # points of a smallest box, on average at most
FEW = 64  # boxes to begin with
AT_ONCE = 2048  # spheres
ROUNDING = 1e-12  # m


class Boxes(NamedTuple):
    """The boxes of one size."""

    low: Floats
    """[3, n] m, of the points in each."""
    high: Floats
    """[3, n] m."""
    middle: Ints
    """[n] one of its points."""
    first: Ints
    """[n + 1] of the boxes inside it, or of its points where none are smaller."""


class CloudBoxes(NamedTuple):
    """A cloud cut into boxes."""

    points: Floats
    """[K, 3] m."""
    order: Ints
    """[K] of points, by box."""
    sizes: list[Boxes]
    """The largest first."""


def find_cloud_gaps(points: Floats, P: Floats, less: Floats, groups: Ints, count: int) -> Floats:
    """Smallest distance to a cloud less `less` of each group of spheres [count], m; inf of a group without any.

    Args:
        points: of the cloud [K, 3], m, at least one.
        P: middles of spheres [Q, 3], m, in the cloud's frame.
        less: what is taken off each distance [Q], m: radii.
        groups: of each sphere [Q], ascending.
        count: of groups.
    """
    boxes, best = find_boxes(points), np.full(count, np.inf)
    for begin in range(0, len(P), AT_ONCE):
        some = slice(begin, begin + AT_ONCE)
        _search(boxes, np.ascontiguousarray(P[some].T), less[some], groups[some], best)
    return best


_KNOWN: dict[int, tuple[weakref.ref[Floats], CloudBoxes]] = {}


def find_boxes(points: Floats) -> CloudBoxes:
    """The boxes of a cloud, made once as long as its points are there."""
    key = id(points)
    known = _KNOWN.get(key)
    if known is not None and known[0]() is points:
        return known[1]._replace(points=points)
    made = make_boxes(points)
    if not points.flags.writeable:
        _KNOWN[key] = weakref.ref(points, lambda _: _KNOWN.pop(key, None)), made._replace(points=np.empty((0, 3)))
    return made


def make_boxes(points: Floats) -> CloudBoxes:
    """Cut a cloud [K, 3] into boxes: cells by halves, of which one holds the next eight."""
    codes, low = np.zeros(len(points), dtype=np.uint32), points.min(axis=0)
    span = max(float(np.ptp(points, axis=0).max()), 1e-300)
    for axis in range(3):
        cells = ((points[:, axis] - low[axis]) * ((2**BITS - 0.5) / span)).astype(np.uint32)
        codes |= _spread(cells) << np.uint32(2 - axis)
    order = np.argsort(codes, kind="stable")
    codes, sizes = codes[order], list[Ints]()
    for depth in range(1, BITS + 1):
        cells = codes >> np.uint32(3 * (BITS - depth))
        starts = np.concatenate([[0], np.flatnonzero(cells[1:] != cells[:-1]) + 1])
        if sizes and len(sizes[-1]) <= FEW:
            sizes.pop()  # what is larger is not needed
        sizes.append(starts)
        if len(starts) * LEAF >= len(points):
            break
    return CloudBoxes(points, order, _bound(points[order].T, order, sizes))


def _spread(cells: Ints) -> Ints:
    """Bits of whole numbers below 2^10, three apart."""
    for shift, mask in ((16, 0x030000FF), (8, 0x0300F00F), (4, 0x030C30C3), (2, 0x09249249)):
        cells = (cells | (cells << np.uint32(shift))) & np.uint32(mask)
    return cells


def _bound(points: Floats, order: Ints, sizes: list[Ints]) -> list[Boxes]:
    """Boxes of all sizes, by where each begins among the points [3, K] that are in order."""
    found = list[Boxes]()
    low = high = points
    inside = np.arange(points.shape[1])  # where what is in the next boxes begins
    for starts in sizes[::-1]:
        first = np.searchsorted(inside, starts)
        low = np.array([np.minimum.reduceat(row, first) for row in low])
        high = np.array([np.maximum.reduceat(row, first) for row in high])
        middle = order[(starts + np.append(starts[1:], points.shape[1])) // 2]
        found.append(Boxes(low, high, middle, np.append(first, len(inside))))
        inside = starts
    return found[::-1]


def _search(boxes: CloudBoxes, P: Floats, less: Floats, groups: Ints, best: Floats) -> None:
    """Lower `best` [count] to the smallest gaps of spheres at `P` [3, Q]."""
    points, count = boxes.points, len(boxes.sizes[0].middle)
    which, box = np.repeat(np.arange(len(less)), count), np.tile(np.arange(count), len(less))
    for low, high, middle, first in boxes.sizes:
        at, off, group = P[:, which], less[which], groups[which]
        _lower(best, group, np.sqrt(((at - points[middle[box]].T) ** 2).sum(axis=0)) - off)
        beyond = np.maximum(low[:, box] - at, at - high[:, box])
        np.maximum(beyond, 0.0, out=beyond)
        near = np.sqrt((beyond * beyond).sum(axis=0)) - off <= best[group] + ROUNDING
        which, box = which[near], box[near]
        counts = first[box + 1] - first[box]
        ends = np.cumsum(counts)
        box = np.repeat(first[box] - ends + counts, counts) + np.arange(ends[-1] if len(ends) else 0)
        which = np.repeat(which, counts)
    gaps = np.sqrt(((P[:, which] - points[boxes.order[box]].T) ** 2).sum(axis=0)) - less[which]
    _lower(best, groups[which], gaps)


def _lower(best: Floats, group: Ints, gaps: Floats) -> None:
    """Lower `best` to the smallest of each group, whose gaps stand together."""
    if len(gaps):
        starts = np.concatenate([[0], np.flatnonzero(group[1:] != group[:-1]) + 1])
        each = group[starts]
        best[each] = np.minimum(best[each], np.minimum.reduceat(gaps, starts))
