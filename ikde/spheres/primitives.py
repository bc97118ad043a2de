"""Spheres that cover boxes, cylinders and capsules wholly: in rows and grids, with exactly known protrusion.

Three facts are all the proof. A shape cut into cells is covered if each cell lies in a sphere. A ball contains a box,
or a slice of a sector of a ring (see `_cover_ring`), if it contains its corners. And a ball with centre c and radius R
is R - depth(c) out of a convex shape at most, where depth is the distance from c to the surface, negative outside:
inside, the ball of radius depth(c) lies in the shape, so nothing of the larger one is farther off, and straight through
the nearest face that far is reached; outside, straight away from the nearest point of the shape.
"""

from typing import NamedTuple

import numpy as np

from ikde.errors import InputError
from ikde.kernels.arrays import Floats

MAX_SPHERES = 2_000
"""Spheres of one shape."""


class Rows(NamedTuple):
    """Spheres in the frame of their shape, and how far the farthest point of them is from it."""

    centres: Floats
    """[S, 3] m"""
    radii: Floats
    """[S] m"""
    protrusion_m: float


def cover_capsule(radius_m: float, length_m: float, protrusion_m: float) -> Rows:
    """A row along z, `length_m` long without the caps.

    Half way between two centres, s apart, spheres of radius R reach sqrt(R^2 - (s / 2)^2) from the axis, and no less
    between: it has to be the capsule's radius. The caps lie in the outermost spheres. All centres are as deep as the
    capsule's radius.
    """
    widest = np.sqrt(2.0 * radius_m * protrusion_m + protrusion_m**2)  # s / 2 where R is the radius + the protrusion
    count = _count(length_m / (2.0 * widest)) + (length_m > 0.0)
    _refuse_many(count, "capsule", protrusion_m)
    half_step = 0.5 * length_m / max(count - 1, 1)
    reach = float(np.hypot(radius_m, half_step))
    centres = np.zeros((count, 3))
    centres[:, 2] = np.linspace(-0.5 * length_m, 0.5 * length_m, count) if count > 1 else 0.0
    return Rows(centres, np.full(count, reach), reach - radius_m)


def cover_box(edges_m: tuple[float, float, float], protrusion_m: float) -> Rows:
    """A grid: cells whose longest edge is halved, cut in three, .. until the sphere around a corner cell fits.

    Cells that touch no face are taken together and cut anew, into larger ones, as they lie deeper.
    """
    half = 0.5 * np.asarray(edges_m, dtype=np.float64)
    centres, radii = _cover_inner_box(half, half, protrusion_m)
    depths = (half - np.abs(centres)).min(axis=1)
    return Rows(centres, radii, float((radii - depths).max()))


def _cover_inner_box(half: Floats, outer: Floats, protrusion_m: float) -> tuple[Floats, Floats]:
    """Spheres that cover a box [3] m of half edges, and protrude no more from a larger one about the same center."""
    counts = np.ones(3, dtype=np.int64)
    while _norm(half / counts) > protrusion_m + (outer - half + half / counts).min():
        counts[(half / counts).argmax()] += 1
        _refuse_many(int(counts.prod() - np.maximum(counts - 2, 0).prod()), "box", protrusion_m)
    cell = half / counts
    index = np.indices(tuple(counts.tolist())).reshape(3, -1).T
    at_face = ((index == 0) | (index == counts - 1)).any(axis=1)
    centres = ((2.0 * index + 1.0) * cell - half)[at_face]
    radii = np.full(len(centres), _norm(cell))
    if at_face.all():
        return centres, radii
    inside, larger = _cover_inner_box(half - 2.0 * cell, outer, protrusion_m)
    return np.concatenate([centres, inside]), np.concatenate([radii, larger])


def cover_cylinder(radius_m: float, length_m: float, protrusion_m: float) -> Rows:
    """Equal slices along z, each a disc in its middle and rings of equal width around it, cut into equal sectors.

    Of all numbers of rings, with the fewest slices that will do, the one that takes the fewest spheres.
    """
    best: list[tuple[float, float, int]] | None = None
    fewest, slices, finest = MAX_SPHERES + 1, 1, 4.0 / protrusion_m
    for rings in range(1, _count(radius_m * finest) + 1):
        if 3 * rings - 2 >= fewest:
            break
        for count in range(1, min(_count(0.5 * length_m * finest), (fewest - 1) // (3 * rings - 2)) + 1):
            layout = _cover_slice(radius_m, 0.5 * length_m / count, rings, protrusion_m)
            if layout is not None:
                total = count * sum(sectors for _, _, sectors in layout)
                if total < fewest:
                    best, fewest, slices = layout, total, count
                break
    if best is None:
        raise _too_many("cylinder", protrusion_m)
    return _lay_slices(radius_m, length_m, slices, best)


def _cover_slice(
    radius_m: float, half_height: float, rings: int, protrusion_m: float
) -> list[tuple[float, float, int]] | None:
    """Of each ring, the outermost first: the centres' distance from the axis, the sphere's radius, how many there are.

    None where some ring cannot be covered.
    """
    width = radius_m / rings
    layout = []
    for ring in range(rings - 1, 0, -1):
        found = _cover_ring(ring * width, (ring + 1) * width, radius_m, half_height, protrusion_m)
        if found is None:
            return None
        layout.append(found)
    reach = float(np.hypot(width, half_height))
    return [*layout, (0.0, reach, 1)] if reach - min(radius_m, half_height) <= protrusion_m else None


def _cover_ring(
    inner: float, outer: float, radius_m: float, half_height: float, protrusion_m: float
) -> tuple[float, float, int] | None:
    """The fewest sectors of a ring whose spheres protrude no more than is allowed.

    From a point at rho_c in the middle of a sector, the squared distance to (rho, theta) is rho^2 + rho_c^2 -
    2 rho rho_c cos(theta): it grows with |theta| and is convex in rho, so it is largest at a corner. Of all rho_c the
    best is in the middle of the outer chord, or where inner and outer corners are equally far.
    """
    sectors = np.arange(3, 3 + _count(np.pi * outer * 4.0 / protrusion_m))
    cos = np.cos(np.pi / sectors)
    middle = np.maximum(outer * cos, 0.0)
    equal = 0.5 * (inner + outer) / cos
    place = np.where(inner**2 - 2.0 * inner * middle * cos <= outer**2 - 2.0 * outer * middle * cos, middle, equal)
    corner = np.maximum(*(rho**2 + place**2 - 2.0 * rho * place * cos for rho in (inner, outer)))
    reach = np.sqrt(corner + half_height**2)
    fits = np.flatnonzero(reach - np.minimum(radius_m - place, half_height) <= protrusion_m)
    if not len(fits):
        return None
    first = fits[0]
    return float(place[first]), float(reach[first]), int(sectors[first])


def _lay_slices(radius_m: float, length_m: float, slices: int, layout: list[tuple[float, float, int]]) -> Rows:
    half_height = 0.5 * length_m / slices
    heights = (2.0 * np.arange(slices) + 1.0) * half_height - 0.5 * length_m
    centres, radii = [], []
    for place, reach, sectors in layout:
        angles = 2.0 * np.pi * np.arange(sectors) / sectors
        flat = np.stack([place * np.cos(angles), place * np.sin(angles)], axis=1)
        centres.append(np.column_stack([np.tile(flat, (slices, 1)), np.repeat(heights, sectors)]))
        radii.append(np.full(slices * sectors, reach))
    protrusion = max(reach - min(radius_m - place, half_height) for place, reach, _ in layout)
    return Rows(np.concatenate(centres), np.concatenate(radii), protrusion)


def _norm(vector: Floats) -> float:
    return float(np.sqrt((vector**2).sum()))


def _count(ratio: float) -> int:
    """Of parts that are no longer than 1 / `ratio`, bounded so that no search gets long."""
    return max(1, int(np.ceil(min(ratio, MAX_SPHERES))))


def _refuse_many(count: int, kind: str, protrusion_m: float) -> None:
    if count > MAX_SPHERES:
        raise _too_many(kind, protrusion_m)


def _too_many(kind: str, protrusion_m: float) -> InputError:
    return InputError(
        f"a {kind} would take more than {MAX_SPHERES:,} spheres that protrude {protrusion_m * 1e3:.3g} mm at most; "
        "allow more with --protrusion"
    )
