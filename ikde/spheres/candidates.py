"""Where spheres may stand: the centres that a cover is chosen from, each with the patches that its sphere covers."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ikde.kernels.arrays import Floats, Ints
from ikde.spheres.patches import Patches
from ikde.spheres.solid import Solid

WITHIN = 1e-9
"""m that a radius stays below what is allowed, against rounding."""
PITCH = 0.3
"""Of the grid inside, as a share of the protrusion, unless that makes too many points."""


@dataclass(frozen=True, slots=True, eq=False)
class Candidates:
    """Centres, and the largest sphere around each that protrudes no more than is allowed.

    Its radius is the centre's depth below the surface + the protrusion allowed: the ball of that depth lies in the
    solid, so nothing of the larger one is farther from the solid than that protrusion. A centre on the surface counts
    as outside by the rounding of its place, whichever side it is on.
    """

    centres: Floats
    """[M, 3] m"""
    radii: Floats
    """[M] m"""
    covers: list[Ints]
    """[M] the patches inside each sphere."""


def find_candidates(solid: Solid, patches: Patches, protrusion_m: float, most: int) -> Candidates:
    """Centres on a grid inside the solid and in the middles of patches, and what they can cover."""
    inside = grid_inside(solid, protrusion_m, most)
    centres = np.concatenate([inside, patches.centres])
    radii, covers = np.empty(len(centres)), [np.empty(0, dtype=np.int64)] * len(centres)
    sign = np.where(np.arange(len(centres)) < len(inside), 1.0, -1.0)
    for block in _neighbours(centres, protrusion_m):
        around = _Around(patches, centres[block])
        near = around.find_patches(protrusion_m)
        depth = sign[block] * solid.surface.take(around.find_triangles()).distances(centres[block])
        radii[block] = depth + protrusion_m - WITHIN
        reach = patches.reach(centres[block], near)
        for index, row in zip(block, reach <= radii[block, None], strict=True):
            covers[index] = near[row]
    return Candidates(centres, radii, covers)


def _neighbours(points: Floats, size_m: float) -> Iterator[Ints]:
    """Points in blocks: those that share a cell of a grid."""
    cells = np.floor(points / size_m).astype(np.int64)
    order = np.lexsort(cells.T)
    cuts = np.flatnonzero((np.diff(cells[order], axis=0) != 0).any(axis=1)) + 1
    for block in np.split(order, cuts):
        yield from np.array_split(block, len(block) // 64 + 1)


class _Around:
    """What of a surface may matter to a block of points [P, 3], by their middle: no farther than its nearest patch."""

    def __init__(self, patches: Patches, block: Floats) -> None:
        middle = block.mean(axis=0)
        spread = np.sqrt(((block - middle) ** 2).sum(axis=1).max())
        self._patches, self._gaps = patches, patches.gap(middle)
        self._far = patches.reach(middle[None])[0].min() + 2.0 * spread

    def find_patches(self, protrusion_m: float) -> Ints:
        """The patches that spheres around the points may touch."""
        return np.flatnonzero(self._gaps <= self._far + protrusion_m)

    def find_triangles(self) -> Ints:
        """The triangles among which the nearest to each point is."""
        nearest = np.flatnonzero(self._gaps <= self._far)
        return np.unique(np.concatenate([self._patches.triangles[i] for i in nearest]))


def grid_inside(solid: Solid, protrusion_m: float, most: int) -> Floats:
    """[.., 3] points of a grid inside the closed parts: along each vertical line the faces passed are counted."""
    triangles = solid.parts.corners
    if not len(triangles):
        return np.empty((0, 3))
    low, high = triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))
    pitch = max(PITCH * protrusion_m, float(np.prod(high - low) / most) ** (1.0 / 3.0))
    counts = np.maximum(np.ceil((high - low) / pitch), 1).astype(int)
    steps, offsets = (high - low) / counts, (0.4981, 0.5023, 0.5)  # off the middles, where edges of faces often are
    axes = [a + (np.arange(n) + o) * s for a, n, s, o in zip(low, counts, steps, offsets, strict=True)]
    winding = np.zeros(tuple(counts), dtype=np.int64)
    for triangle in triangles:
        _add_crossings(winding, axes, triangle)
    inside = np.argwhere(winding > 0)
    return np.stack([axis[inside[:, k]] for k, axis in enumerate(axes)], axis=1)


def _add_crossings(winding: Ints, axes: list[Floats], triangle: Floats) -> None:
    """Count a face at all points of the grid below it: upwards as +1, downwards as -1."""
    (x, y, z), (a, b, c) = axes, triangle
    (x0, y0, _), (x1, y1, _) = triangle.min(axis=0), triangle.max(axis=0)
    ix, iy = slice(*np.searchsorted(x, [x0, x1])), slice(*np.searchsorted(y, [y0, y1]))
    area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    if ix.start == ix.stop or iy.start == iy.stop or area == 0.0:
        return
    gx, gy = x[ix, None], y[None, iy]
    u, v, w = (((q[0] - p[0]) * (gy - p[1]) - (q[1] - p[1]) * (gx - p[0])) / area for p, q in ((b, c), (c, a), (a, b)))
    over = (u >= 0.0) & (v >= 0.0) & (w >= 0.0)
    height = u * a[2] + v * b[2] + w * c[2]
    winding[ix, iy] += np.where(area > 0.0, 1, -1) * (over[..., None] & (z < height[..., None]))
