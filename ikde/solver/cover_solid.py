"""Spheres that hold all of a convex solid, with exactly known protrusion: what is attached is compared by them.

Of boxes, cylinders and capsules they stand in rows and grids (`ikde.spheres.primitives`). A hull or a cone is cut into
pieces, and a ball that holds a piece's corners holds all of it. If its middle is d from the solid's surface, less than
0 inside, a ball of radius R is R + d out of the solid at most. What a plane cuts out of the hull of points is the hull
of where it cuts the lines between them.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ikde.errors import InputError
from ikde.kernels.arrays import Floats, read_only
from ikde.model.solids import IDENTITY, Solid
from ikde.solver.plain_world import measure_solid
from ikde.spheres.primitives import MAX_SPHERES, Rows, cover_box, cover_capsule, cover_cylinder

FEW = 128  # spheres of an object, unless its protrusion is given
PROTRUSIONS_M = tuple(5e-3 * factor * 2.0**k for k in range(24) for factor in (1.0, 1.5))
CORNERS = 24  # of the polygon around a cone
STEPS = 8  # towards the middle of the smallest ball
NO_END = {"half_space": "a half-space has no end", "cloud": "a cloud has no inside: give it as solids"}


class ObjectCover(NamedTuple):
    """Spheres of several solids in the frame of their object."""

    spheres: Floats
    """[n, 4] centre and radius, m; read-only."""
    protrusion_m: float
    """Of the sphere that stands out of its own solid most."""


def cover_solids(solids: Sequence[Solid], protrusion_m: float | None = None) -> ObjectCover:
    """Spheres that hold all of some solids.

    Args:
        solids: at least one.
        protrusion_m: how far they may stand out of them, m; None: 5 mm, or as much more as takes up to 128 spheres.

    Raises:
        InputError: for solids that have no end or no inside, and for what would take more than 2,000 spheres.
    """
    refuse_endless(solids)
    return _find_cover(tuple(solids), protrusion_m)


@lru_cache(maxsize=64)
def _find_cover(solids: tuple[Solid, ...], protrusion_m: float | None) -> ObjectCover:
    """The same object for equal solids: what is picked up again is not covered again."""
    if protrusion_m is not None:
        return _cover_all(solids, protrusion_m, MAX_SPHERES)
    for tried_m in PROTRUSIONS_M:
        try:
            return _cover_all(solids, tried_m, max(FEW, len(solids)))
        except InputError:
            continue
    raise InputError(f"{len(solids):,} solids would take more than {MAX_SPHERES:,} spheres", ("solids",))


def refuse_endless(solids: Sequence[Solid]) -> None:
    """Raise `InputError` for solids that have no end or no inside: no robot holds them."""
    for solid in solids:
        if solid.kind in NO_END:
            raise InputError(NO_END[solid.kind], ("solids",))


def _cover_all(solids: Sequence[Solid], protrusion_m: float, most: int) -> ObjectCover:
    placed, out_m = [], 0.0
    for solid in solids:
        own, (R, p) = _cover(solid, protrusion_m, most), (solid.T_obstacle_solid[:, :3], solid.T_obstacle_solid[:, 3])
        placed.append(np.column_stack([own.centres @ R.T + p, own.radii]))
        out_m = max(out_m, own.protrusion_m)
        if sum(map(len, placed)) > most:
            raise _too_many(most, protrusion_m)
    return ObjectCover(read_only(np.concatenate(placed)), max(out_m, 0.0))


def _cover(solid: Solid, protrusion_m: float, most: int) -> Rows:
    """In the solid's own frame."""
    if solid.kind == "sphere":
        return Rows(np.zeros((1, 3)), np.array(solid.size_m), 0.0)
    if solid.kind in ("box", "cylinder", "capsule"):
        try:
            return _cover_rows(solid, protrusion_m)
        except InputError:  # it names an option of imports
            raise _too_many(MAX_SPHERES, protrusion_m) from None
    return _cover_pieces(solid, protrusion_m, most)


def _cover_rows(solid: Solid, protrusion_m: float) -> Rows:
    """Rows and grids of a box, a cylinder or a capsule."""
    size = solid.size_m
    if solid.kind == "box":
        return cover_box((size[0], size[1], size[2]), protrusion_m)
    if solid.kind == "cylinder":
        return cover_cylinder(size[0], size[1], protrusion_m)
    return cover_capsule(size[0], size[1], protrusion_m)


def _cover_pieces(solid: Solid, protrusion_m: float, most: int) -> Rows:
    """Pieces, each the hull of points, that are halved until the ball about each protrudes little enough."""
    own, centres, radii, out_m = replace(solid, T_obstacle_solid=IDENTITY), [], [], 0.0
    pieces = [_list_corners(solid)]
    while pieces:
        if len(centres) + len(pieces) > most:
            raise _too_many(most, protrusion_m)
        points = pieces.pop()
        middles = _list_middles(points)
        reach = np.linalg.norm(points - middles[:, None], axis=-1).max(axis=1) * (1.0 + 1e-9) + 1e-12
        out = reach + measure_solid(own, middles)
        best = int(out.argmin())
        if out[best] <= protrusion_m:
            centres.append(middles[best])
            radii.append(float(reach[best]))
            out_m = max(out_m, float(out[best]))
        else:
            pieces += _halve(points)
    return Rows(np.array(centres), np.array(radii), out_m)


def _list_corners(solid: Solid) -> Floats:
    """Points [K, 3] whose hull holds a hull or a cone, in its own frame, m."""
    if solid.points is not None:
        return solid.points
    radius, height = solid.size_m
    angles = 2.0 * np.pi * np.arange(CORNERS) / CORNERS
    rim = radius / np.cos(np.pi / CORNERS)  # of a polygon around the base
    ring = np.column_stack([rim * np.cos(angles), rim * np.sin(angles), np.full(CORNERS, -0.5 * height)])
    return np.vstack([ring, [0.0, 0.0, 0.5 * height]])


def _list_middles(points: Floats) -> Floats:
    """Where a small ball about points may have its middle [k, 3]: that of their box, and ever nearer to the best."""
    middles = [0.5 * (points.min(axis=0) + points.max(axis=0))]
    for step in range(2, STEPS):
        away = points - middles[-1]
        middles.append(middles[-1] + away[np.einsum("ki,ki->k", away, away).argmax()] / step)
    return np.array(middles)


def _halve(points: Floats) -> list[Floats]:
    """Both sides of the plane through the middle of a hull's longest edge along an axis, as points that have them."""
    low, high = points.min(axis=0), points.max(axis=0)
    axis = int((high - low).argmax())
    heights = points[:, axis] - 0.5 * (low + high)[axis]
    above, below = points[heights > 0.0], points[heights < 0.0]
    up, down = heights[heights > 0.0], heights[heights < 0.0]
    share = up[:, None] / (up[:, None] - down)
    cut = (above[:, None] + share[..., None] * (below - above[:, None])).reshape(-1, 3)
    cut[:, axis] = 0.5 * (low + high)[axis]
    cut = np.vstack([cut, points[heights == 0.0]])
    kept = cut[_find_rim(np.delete(cut, axis, axis=1))]
    return [np.vstack([above, kept]), np.vstack([below, kept])]


def _find_rim(flat: Floats) -> list[int]:
    """Which of points [K, 2] in a plane have all others in their hull."""
    order = np.lexsort(flat.T[::-1]).tolist()
    places, found = flat.tolist(), []
    for way in (order, order[::-1]):
        rim: list[int] = []
        for k in way:
            x, y = places[k]
            while len(rim) > 1:
                (ax, ay), (bx, by) = places[rim[-2]], places[rim[-1]]
                if (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0.0:
                    break
                rim.pop()
            rim.append(k)
        found += rim
    return sorted(set(found))


def _too_many(most: int, protrusion_m: float) -> InputError:
    message = f"more than {most:,} spheres would be needed to stand out by {1e3 * protrusion_m:.3g} mm at most"
    return InputError(f"{message}: allow more", ("protrusion_m",))
