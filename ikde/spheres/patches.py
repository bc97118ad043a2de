"""A surface in small patches, each inside a box of its own: what spheres have to cover."""

from dataclasses import dataclass

import numpy as np

from ikde.errors import InputError
from ikde.kernels.arrays import Floats, Ints

MAX_PIECES = 3_000_000
PATCHES = 8_000
"""About so many for one body; four times as many take 5 times as long for 5 % fewer spheres, on the UR5's links."""
FINEST, COARSEST = 0.1, 0.4
"""Size of a patch as a share of the protrusion: at the coarsest a sphere in its middle still covers it."""


@dataclass(frozen=True, slots=True, eq=False)
class Patches:
    """Boxes around the pieces of a surface, in m: a sphere that contains a box's corners covers the pieces in it."""

    centres: Floats
    """[N, 3]"""
    halves: Floats
    """[N, 3] of the edges along x, y, z."""
    triangles: list[Ints]
    """[N] which triangles of the surface have a piece in each."""

    def reach(self, points: Floats, chosen: Ints | slice = slice(None)) -> Floats:
        """[P, N] m from points [P, 3] to the farthest corner of each box; the same bits on every machine."""
        centres, halves = self.centres[chosen], self.halves[chosen]
        squares = (np.abs(points[:, None, 0] - centres[:, 0]) + halves[:, 0]) ** 2
        squares += (np.abs(points[:, None, 1] - centres[:, 1]) + halves[:, 1]) ** 2
        squares += (np.abs(points[:, None, 2] - centres[:, 2]) + halves[:, 2]) ** 2
        return np.sqrt(squares)

    def gap(self, point: Floats) -> Floats:
        """[N] m from a point [3] to the nearest corner, edge or face of each box; 0 inside."""
        away = np.maximum(np.abs(point - self.centres) - self.halves, 0.0)
        return np.sqrt(away[:, 0] ** 2 + away[:, 1] ** 2 + away[:, 2] ** 2)


def patch_size(area_m2: float, protrusion_m: float) -> float:
    """How large patches are, in m: for spheres that protrude so far, of a surface so large."""
    return float(np.clip(np.sqrt(area_m2 / PATCHES), FINEST * protrusion_m, COARSEST * protrusion_m))


def make_patches(corners: Floats, size_m: float) -> Patches:
    """The triangles [T, 3, 3] in cells of a grid: halved until no edge is longer than a cell, then sorted into cells.

    Raises:
        InputError: if there would be too many pieces.
    """
    pieces, source = split(corners, size_m)
    cells = np.floor(pieces.mean(axis=1) / size_m).astype(np.int64)
    order = np.lexsort((source, *cells.T))
    pieces, source, cells = pieces[order], source[order], cells[order]
    starts = np.r_[True, (np.diff(cells, axis=0) != 0).any(axis=1)]
    first = np.flatnonzero(starts)
    low = np.minimum.reduceat(pieces.min(axis=1), first)
    high = np.maximum.reduceat(pieces.max(axis=1), first)
    halves = 0.5 * (high - low) + 1e-12 * np.abs(pieces).max()  # rounding of the middle
    once = starts | np.r_[True, np.diff(source) != 0]  # in a cell, pieces of one triangle stand side by side
    held = np.split(source[once], np.cumsum(once)[first[1:]] - 1)
    return Patches(0.5 * (low + high), halves, held)


def split(corners: Floats, size_m: float) -> tuple[Floats, Ints]:
    """Triangles [T, 3, 3] halved at their longest edges until none is longer than `size_m`; whose piece each is."""
    source = np.arange(len(corners))
    done, sources, count = [], [], 0
    while len(corners):
        edges = ((np.roll(corners, -1, axis=1) - corners) ** 2).sum(axis=2)
        small = edges.max(axis=1) <= size_m**2
        done.append(corners[small])
        sources.append(source[small])
        count += int(small.sum())
        corners = halve(corners[~small], edges[~small].argmax(axis=1))
        source = np.repeat(source[~small], 2)
        if count + len(corners) > MAX_PIECES:
            raise InputError(
                f"the surface would be cut into more than {MAX_PIECES:,} pieces of {size_m * 1e3:.2g} mm; "
                "let spheres protrude further"
            )
    return np.concatenate(done), np.concatenate(sources)


def halve(corners: Floats, edge: Ints) -> Floats:
    """Each triangle [T, 3, 3] cut in two at the middle of one edge [T], counted by its first corner: [2 T, 3, 3]."""
    row = np.arange(len(corners))
    a, b, c = (corners[row, (edge + k) % 3] for k in range(3))
    middle = 0.5 * (a + b)
    return np.stack([np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)], axis=1).reshape(-1, 3, 3)
