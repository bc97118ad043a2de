"""Outlines of convex solids as they are seen from afar."""

import numpy as np

from ikde.kernels.arrays import Floats


def find_outline(points: Floats) -> Floats:
    """Corners [k, 2] of the convex hull of points [n, 2] in a plane, anticlockwise; fewer than three if it has no area.

    From left to right and back, a corner that the next one makes needless is dropped.
    """
    ordered = np.unique(np.asarray(points, dtype=float).reshape(-1, 2), axis=0)
    if len(ordered) < 3:
        return ordered
    return np.array(_walk(ordered)[:-1] + _walk(ordered[::-1])[:-1])


def _walk(ordered: Floats) -> list[Floats]:
    """Corners on the right of the way from the first point to the last."""
    corners: list[Floats] = []
    for point in ordered:
        while len(corners) > 1 and _turn(corners[-2], corners[-1], point) <= 0.0:
            corners.pop()
        corners.append(point)
    return corners


def _turn(a: Floats, b: Floats, c: Floats) -> float:
    """Above 0 where the way from a over b to c turns left."""
    return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
