"""Triangles as files hold them, made into a solid: merged, sorted into connected parts, closed, turned outwards."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ikde.kernels.arrays import Floats, Ints
from ikde.spheres.solid import Solid, Triangles
from ikde.spheres.union import outer_triangles

MERGED = 1e-8
"""Corners closer than this share of a body's size along every axis are one: files round their numbers."""

Hull = Callable[[Floats], Floats | None]
"""Points [N, 3] to the triangles [T, 3, 3] of their convex hull, or None where they lie in a plane."""


@dataclass(frozen=True, slots=True)
class PartCounts:
    """What became of the connected parts of a mesh."""

    closed: int
    hulls: int
    """Those of which the convex hull is taken: open ones, or all."""
    sheets: int
    """Open ones that lie in a plane, so that they have no hull either."""


def make_solid(triangles: Floats, hull: Hull, *, only_hulls: bool = False) -> tuple[Solid, PartCounts]:
    """The solid that triangles [T, 3, 3] in m enclose, one connected part after the other, and what became of them.

    A part is closed if its faces pass each of their edges as often in one direction as in the other. An open part is
    exchanged for its convex hull (with `only_hulls` each part is); one in a plane stays as it is, without an inside.
    """
    corners, faces = merge_corners(triangles)
    part = connect(faces)
    closed: list[Floats] = []
    sheets: list[Floats] = []
    hulls = 0
    for index in range(int(part.max()) + 1):
        own = faces[part == index]
        if is_closed(own) and not only_hulls:
            closed.append(turn_outwards(corners[own]))
        elif (around := hull(corners[np.unique(own)])) is not None:
            closed.append(turn_outwards(around))
            hulls += 1
        else:
            sheets.append(corners[own])
    inner = np.concatenate(closed) if closed else np.empty((0, 3, 3))
    surface = np.concatenate([*outer_triangles(closed), *sheets])
    return Solid(Triangles.of(surface), Triangles.of(inner)), PartCounts(len(closed) - hulls, hulls, len(sheets))


def merge_corners(triangles: Floats) -> tuple[Floats, Ints]:
    """Distinct corners [V, 3], and the faces [F, 3] between them that have an area."""
    points = triangles.reshape(-1, 3)
    size = float(np.ptp(points, axis=0).max())
    rounded = np.round((points - points.min(axis=0)) / (size * MERGED)).astype(np.int64)
    _, first, inverse = np.unique(rounded, axis=0, return_index=True, return_inverse=True)
    faces = inverse.reshape(-1, 3)
    distinct = (faces != np.roll(faces, -1, axis=1)).all(axis=1)
    return points[first], faces[distinct]


def connect(faces: Ints) -> Ints:
    """[F] the connected part of each face [F, 3], counted in the order of their first faces."""
    label = np.arange(int(faces.max()) + 1)
    while True:
        lowest = label[faces].min(axis=1)
        new = label.copy()
        np.minimum.at(new, faces.ravel(), np.repeat(lowest, 3))
        new = new[new]
        if (new == label).all():
            break
        label = new
    _, first, part = np.unique(label[faces[:, 0]], return_index=True, return_inverse=True)
    rank = np.empty(len(first), dtype=np.int64)
    rank[np.argsort(first)] = np.arange(len(first))
    return rank[part]


def is_closed(faces: Ints) -> bool:
    """True if every edge is passed as often from one end as from the other."""
    ends = np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2)
    sign = np.where(ends[:, 0] < ends[:, 1], 1, -1)
    _, edge = np.unique(np.sort(ends, axis=1), axis=0, return_inverse=True)
    return bool((np.bincount(edge.ravel(), weights=sign) == 0).all())


def turn_outwards(triangles: Floats) -> Floats:
    """The triangles [T, 3, 3] of a closed part, wound so that they enclose a positive volume."""
    about = triangles - triangles.reshape(-1, 3).mean(axis=0)
    volume = (about[:, 0] * np.cross(about[:, 1], about[:, 2])).sum()
    return triangles if volume >= 0.0 else triangles[:, ::-1]
