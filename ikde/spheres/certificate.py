"""The proof that spheres cover a surface: a triangle whose three corners lie in one sphere lies in that sphere."""

from dataclasses import dataclass

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.spheres.patches import halve
from ikde.spheres.solid import Bools

ROUNDING = 1e-12
"""A corner counts as inside a sphere up to this much of its radius less, so that rounding never adds to the proof."""
SMALLEST = 1e-4
"""A triangle is given up where halving has made it smaller than this share of all area."""
SHORT = 0.1
"""An edge of this share of the smallest radius is short."""
BLOCK = 4_000_000  # distances at a time


@dataclass(frozen=True, slots=True, eq=False)
class Certificate:
    """What is proved of a surface."""

    area_m2: float
    covered: float
    """Share of the area that is proved to be covered, in [0, 1]."""
    open_pieces: Floats
    """[U, 3, 3] triangles that no proof was found for, in m."""


def certify(triangles: Floats, centres: Floats, radii: Floats, *, halvings: int = 14) -> Certificate:
    """How much of a surface is proved to be covered by spheres.

    A sphere is convex, so it contains a triangle if it contains its corners. What is in none is halved at its longest
    edge and asked again, until it is small or was halved so often; what is left then is not proved, whatever it is.
    What is long and thin has two long edges, so it is halved up to twice as often, until it is short.

    Args:
        triangles: [T, 3, 3] in m.
        centres: [S, 3] of the spheres, m.
        radii: [S] in m.
        halvings: of one triangle, at most; of a long one twice as many.
    """
    total = _areas(triangles).sum()
    covered, given_up = 0.0, []
    short_m = SHORT * radii.min(initial=np.inf)
    for done in range(2 * halvings + 1):
        bare = ~_in_one_sphere(triangles, centres, radii)
        covered += float(_areas(triangles[~bare]).sum())
        triangles = triangles[bare]
        if not len(triangles):
            break
        edges = _squared_edges(triangles)
        small = _areas(triangles) < SMALLEST**2 * total
        if done >= halvings:
            small |= edges.max(axis=1) <= short_m**2
        given_up.append(triangles[small])
        triangles = halve(triangles[~small], edges[~small].argmax(axis=1))
    left = np.concatenate([*given_up, triangles])
    share = 1.0 if not len(left) else min(covered / total, 1.0 - float(_areas(left).sum()) / total)
    return Certificate(float(total), max(share, 0.0), left)


def _in_one_sphere(triangles: Floats, centres: Floats, radii: Floats) -> Bools:
    inside = np.zeros(len(triangles), dtype=np.bool_)
    squares = (radii * (1.0 - ROUNDING)) ** 2
    step = max(1, BLOCK // (9 * max(1, len(radii))))
    for start in range(0, len(triangles), step):
        away = triangles[start : start + step, :, None] - centres
        within = (away[..., 0] ** 2 + away[..., 1] ** 2 + away[..., 2] ** 2 <= squares).all(axis=1)
        inside[start : start + step] = np.logical_or.reduce(within, axis=1)
    return inside


def _squared_edges(triangles: Floats) -> Floats:
    return ((np.roll(triangles, -1, axis=1) - triangles) ** 2).sum(axis=2)


def _areas(triangles: Floats) -> Floats:
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return 0.5 * np.sqrt((normals**2).sum(axis=1))
