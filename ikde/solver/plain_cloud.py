"""The nearest points of a cloud in plain numpy, for graders: boxes in boxes about its points, all queries at once.

Exact, and nothing is shared with the cells of the search (`model/cloud_cells.py`, `kernels/world_grades.py`). Of each
group of spheres only the smallest gap is asked for. A box is left out if all of it is farther than a point that is
known; of each box one point is measured before what is inside it. The points of the cells are cut into small boxes when
a sphere is first near: of a million points a robot comes near few.
"""

from functools import lru_cache
from threading import Lock
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ikde.kernels.arrays import Floats, Ints
from ikde.model.per_array import PerArray

BITS = 5  # of a cell along an axis: cells and places in one are numbers of 15 bits, which numpy sorts by counting
LEAF, BLOCK = 16, 256  # points of the smallest boxes, and of those about them
FEW = 64  # boxes to begin with
AT_ONCE = 2048  # spheres
IN_CACHE = 16_384  # points
ROUNDING = 1e-12  # m
SLACK = 1e-9  # of coordinates: a cell may hold what its faces, which are rounded, do not


class Boxes(NamedTuple):
    """The boxes of one size."""

    low: Floats
    """[3, n] m, at or below all points in each."""
    high: Floats
    """[3, n] m."""
    middle: Ints
    """[n] one of its points."""
    first: Ints
    """[n + 1] of the boxes inside it; of cells, of their points."""


class CloudBoxes:
    """A cloud cut into boxes; small ones in the cells that were opened."""

    def __init__(self, points: Floats) -> None:
        low, high = _find_corners(points)
        self.order, starts, occupied = _sort_by_cell(points, low, high)
        self.sizes: list[Boxes] = _list_sizes(occupied, self.order[starts[:-1]], starts, low, high)
        """Of the cells and what holds them, the largest first."""
        count, cells = len(points), len(occupied)
        self._lock, self._ends = Lock(), (0, 0, 0)
        self.points = np.empty((3, count))  # empty arrays take no memory before they are written to
        self.leaves = np.empty((6, count // LEAF + cells)), np.empty(count // LEAF + cells + 1, dtype=np.int64)
        self.blocks = np.empty((6, count // BLOCK + cells)), np.empty(count // BLOCK + cells + 1, dtype=np.int64)
        self.first, self.last = np.full(cells, -1), np.full(cells, -1)
        """[n] first and last block in each cell that was opened, else -1."""

    def open(self, points: Floats, cells: Ints) -> None:
        """Cut the points [K, 3] in some cells into small boxes, those where that was not done before."""
        with self._lock:
            new = cells[self.first[cells] < 0]
            if len(new):
                self._cut(points, new)

    def _cut(self, points: Floats, cells: Ints) -> None:
        starts, begin = self.sizes[-1].first, self._ends
        counts = starts[cells + 1] - starts[cells]
        owner, ends = np.repeat(np.arange(len(cells)), counts), np.cumsum(counts)
        inside = self.order[np.arange(ends[-1]) + np.repeat(starts[cells] - ends + counts, counts)]
        own = np.ascontiguousarray(points[inside].T)
        by_place = np.argsort(_number_places(own, self.sizes[-1], cells[owner]), kind="stable")
        by_cell = by_place[np.argsort(owner[by_place].astype(np.uint16), kind="stable")]
        own = np.array([np.take(axis, by_cell) for axis in own])
        leaf, _ = _cut_runs(ends, counts, LEAF)
        block, blocks = _cut_runs(ends, counts, BLOCK)
        self._ends = begin[0] + len(owner), begin[1] + len(leaf), begin[2] + len(block)
        self.points[:, begin[0] : self._ends[0]] = own
        for (bounds, first), starts, count, inner in (
            (self.leaves, leaf, begin[1], begin[0] + np.append(leaf, len(owner))),
            (self.blocks, block, begin[2], begin[1] + np.append(np.searchsorted(leaf, block), len(leaf))),
        ):
            some = slice(count, count + len(starts))
            bounds[:3, some], bounds[3:, some] = (f.reduceat(own, starts, axis=1) for f in (np.minimum, np.maximum))
            first[count : count + len(starts) + 1] = inner
        self.last[cells] = begin[2] + np.cumsum(blocks)
        self.first[cells] = self.last[cells] - blocks


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
        _Search(np.ascontiguousarray(P[some].T), less[some], groups[some], best).run(boxes, points)
    return best


_KNOWN = PerArray(CloudBoxes)


def find_boxes(points: Floats) -> CloudBoxes:
    """The boxes of a cloud, made once as long as its points are there."""
    return _KNOWN.find(points)


def _find_corners(points: Floats) -> tuple[Floats, Floats]:
    """Smallest and largest coordinates [3], m, of many rows side by side: of one column it takes 20 times as long."""
    whole = len(points) // FEW * FEW
    wide = points[:whole].reshape(-1, 3 * FEW)
    ends = [points[whole:]] + ([f(wide, axis=0).reshape(FEW, 3) for f in (np.min, np.max)] if whole else [])
    found = np.concatenate(ends)
    return found.min(axis=0), found.max(axis=0)


def _sort_by_cell(points: Floats, low: Floats, high: Floats) -> tuple[Ints, Ints, Ints]:
    """Points in the order of the cells that hold them, where the points of each of these begin, and their numbers."""
    numbers, scale = np.empty(len(points), dtype=np.uint16), _scale(low, high)
    for begin in range(0, len(points), IN_CACHE):
        some, found = points[begin : begin + IN_CACHE], np.uint16(0)
        for axis in range(3):
            found = (found << np.uint16(BITS)) + ((some[:, axis] - low[axis]) * scale).astype(np.uint16)
        numbers[begin : begin + IN_CACHE] = found
    numbers = _list_turns()[numbers]  # as they lie in the boxes about them
    counts = np.bincount(numbers, minlength=2 ** (3 * BITS))
    order = np.argsort(numbers, kind="stable")
    occupied = np.flatnonzero(counts)
    return order, np.concatenate([[0], np.cumsum(counts[occupied])]), occupied


def _scale(low: Floats, high: Floats) -> float:
    """Cells a metre; also the last coordinate falls into one."""
    return (2**BITS - 0.5) / max(float((high - low).max()), 1e-300)


@lru_cache(maxsize=1)
def _list_turns() -> NDArray[np.uint16]:
    """Of each number of three coordinates, one after the other, that with their bits in turn."""
    numbers = np.arange(2 ** (3 * BITS))
    found = np.zeros(len(numbers), dtype=np.uint16)
    for axis in range(3):
        for bit in range(BITS):
            found |= (((numbers >> (BITS * (2 - axis) + bit)) & 1) << (3 * bit + 2 - axis)).astype(np.uint16)
    return found


def _separate(codes: Ints, bits: int) -> Floats:
    """Coordinates [3, n] of numbers whose bits are in turn."""
    found = np.zeros((3, len(codes)))
    for axis in range(3):
        for bit in range(bits):
            found[axis] += ((codes >> (3 * bit + 2 - axis)) & 1) << bit
    return found


def _list_sizes(cells: Ints, middle: Ints, starts: Ints, low: Floats, high: Floats) -> list[Boxes]:
    """The occupied cells, and the boxes about them until there are few; the largest first."""
    slack = SLACK * (np.abs([low, high]).max() + (high - low).max())
    found, first, pitch, bits = list[Boxes](), starts, 1.0 / _scale(low, high), BITS
    while True:
        corner = low[:, None] + pitch * _separate(cells, bits)
        found.append(Boxes(corner - slack, corner + pitch + slack, middle, first))
        if len(cells) <= FEW or bits == 1:
            return found[::-1]
        parents, inside = np.unique(cells >> 3, return_index=True)
        cells, middle, first = parents, middle[inside], np.append(inside, len(cells))
        pitch, bits = 2.0 * pitch, bits - 1


def _number_places(own: Floats, cells: Boxes, owner: Ints) -> NDArray[np.uint16]:
    """Where in their cells points [3, n] are: numbers of 15 bits, of neighbours alike."""
    low, high = cells.low[:, owner], cells.high[:, owner]
    layers = np.clip((own - low) * (2**BITS / (high - low)), 0.0, 2**BITS - 1.0).astype(np.int64)
    numbers = (layers[0] << (2 * BITS)) | (layers[1] << BITS) | layers[2]
    return _list_turns()[numbers]


def _cut_runs(ends: Ints, counts: Ints, most: int) -> tuple[Ints, Ints]:
    """Where runs of at most `most` begin that hold what ends at `ends` [n], and how many there are of each [n]."""
    runs = -(-counts // most)
    last = np.cumsum(runs)
    place = np.arange(last[-1]) - np.repeat(last - runs, runs)
    return np.repeat(ends - counts, runs) + most * place, runs


class _Search:
    """Spheres at `P` [3, Q], less what is taken off, in groups, whose smallest gaps `best` [count] are lowered."""

    def __init__(self, P: Floats, less: Floats, groups: Ints, best: Floats) -> None:
        self.P, self.less, self.groups, self.best = P, less, groups, best

    def run(self, boxes: CloudBoxes, points: Floats) -> None:
        """Measure what cannot be left out."""
        count = len(boxes.sizes[0].middle)
        which, box = np.repeat(np.arange(len(self.less)), count), np.tile(np.arange(count), len(self.less))
        for low, high, middle, first in boxes.sizes:
            which, box = self._keep_near(which, box, (low, high), points[middle[box]].T)
            if first is not boxes.sizes[-1].first:
                which, box = _enter(which, first[box], first[box + 1])
        boxes.open(points, np.unique(box))
        which, box = _enter(which, boxes.first[box], boxes.last[box])
        (bounds, first), (_, starts) = boxes.blocks, boxes.leaves
        which, box = self._keep_near(which, box, (bounds[:3], bounds[3:]), boxes.points[:, starts[first[box]]])
        which, box = _enter(which, first[box], first[box + 1])
        (bounds, first) = boxes.leaves
        which, box = self._keep_near(which, box, (bounds[:3], bounds[3:]), boxes.points[:, first[box]])
        which, box = _enter(which, first[box], first[box + 1])
        self._lower(which, boxes.points[:, box])

    def _keep_near(self, which: Ints, box: Ints, bounds: tuple[Floats, Floats], inside: Floats) -> tuple[Ints, Ints]:
        """Spheres and boxes that may hold what is nearer than the points that are known, `inside` [3, n] among them."""
        self._lower(which, inside)
        at = self.P[:, which]
        beyond = np.maximum(bounds[0][:, box] - at, at - bounds[1][:, box])
        np.maximum(beyond, 0.0, out=beyond)
        gaps = np.sqrt((beyond * beyond).sum(axis=0)) - self.less[which]
        near = gaps <= self.best[self.groups[which]] + ROUNDING
        return which[near], box[near]

    def _lower(self, which: Ints, points: Floats) -> None:
        """Lower the smallest gap of each group, whose spheres stand together, by points [3, n]."""
        if len(which):
            group = self.groups[which]
            gaps = np.sqrt(((self.P[:, which] - points) ** 2).sum(axis=0)) - self.less[which]
            starts = np.concatenate([[0], np.flatnonzero(group[1:] != group[:-1]) + 1])
            each = group[starts]
            self.best[each] = np.minimum(self.best[each], np.minimum.reduceat(gaps, starts))


def _enter(which: Ints, first: Ints, last: Ints) -> tuple[Ints, Ints]:
    """Spheres with each of what stands from `first` to before `last`."""
    counts = last - first
    ends = np.cumsum(counts)
    count = ends[-1] if len(ends) else 0
    return np.repeat(which, counts), np.repeat(first - ends + counts, counts) + np.arange(count)
