"""The surface of overlapping parts as one body: what lies inside another part is left out."""

from collections.abc import Iterator

import numpy as np

from ikde.kernels.arrays import Floats, Ints
from ikde.spheres.patches import halve
from ikde.spheres.solid import Bools, Triangles

SMALLEST_M = 6e-3
"""Pieces with shorter edges are not halved further: they count as outside."""
MAX_UNDECIDED = 1_500
FLAT = 1e-9
"""m over a face within which a corner counts as in its plane."""
BLOCK = 1_000_000  # distances at a time
MANY = 2_000
"""Triangles of a part from which on those that are near are chosen before distances are taken."""
SLACK_M = 1e-9


def outer_triangles(parts: list[Floats]) -> list[Floats]:
    """Of closed parts [T, 3, 3], each wound outwards, what is proved to lie inside another part is taken away.

    A triangle is inside a convex part if its corners are, and outside if one of the part's faces has them all in
    front. A triangle in a ball that no triangle of another part comes near is inside that part, or outside, as the
    middle of the ball is. Where neither is proved it is halved, and kept in the end: so the surface that is left
    holds all of the body's, and a distance to it is never longer than the true one. A triangle that is kept
    altogether stays whole.
    """
    return [_outside(part, [other for j, other in enumerate(parts) if j != i]) for i, part in enumerate(parts)]


def _outside(part: Floats, others: list[Floats]) -> Floats:
    near = [Triangles.of(other) for other in others if _boxes_meet(part, other)]
    pieces, source = part, np.arange(len(part))
    cut = np.zeros(len(part), dtype=np.bool_)
    for other in near:
        keep, kept_source, lost = _outside_one(pieces, source, other)
        cut[lost] = True
        pieces, source = keep, kept_source
    whole = np.unique(source[~cut[source]])
    return np.concatenate([part[whole], pieces[cut[source]]])


def _outside_one(pieces: Floats, source: Ints, other: Triangles) -> tuple[Floats, Ints, Ints]:
    """The pieces that are not inside another part, whose they are, and which sources have lost some."""
    kept, sources, lost = [pieces[:0]], [source[:0]], [source[:0]]
    planes = _planes(other)
    convex = _is_convex(other, planes)
    while len(pieces):
        middles = pieces.mean(axis=1)
        radius = np.sqrt(((pieces - middles[:, None]) ** 2).sum(axis=2).max(axis=1))
        clear, inside = _ask_planes(pieces, planes) if convex else _ask_ball(middles, radius, other)
        small = radius < SMALLEST_M
        keep = (clear & ~inside) | (~clear & small)
        kept.append(pieces[keep])
        sources.append(source[keep])
        lost.append(source[inside])
        pieces, source = pieces[~clear & ~small], source[~clear & ~small]
        if len(pieces) > MAX_UNDECIDED:
            kept.append(pieces)
            sources.append(source)
            break
        edges = ((np.roll(pieces, -1, axis=1) - pieces) ** 2).sum(axis=2)
        pieces, source = halve(pieces, edges.argmax(axis=1)), np.repeat(source, 2)
    return np.concatenate(kept), np.concatenate(sources), np.unique(np.concatenate(lost))


def _boxes_meet(a: Floats, b: Floats) -> bool:
    low = np.maximum(a.min(axis=(0, 1)), b.min(axis=(0, 1)))
    return bool((low <= np.minimum(a.max(axis=(0, 1)), b.max(axis=(0, 1)))).all())


def _are_far(points: Floats, reach: Floats, other: Triangles) -> Bools:
    """[P] of points: whether no triangle of another part comes as near as [P] m.

    Of a part of many triangles only those are measured whose ball, about the mean of their corners, comes near.
    """
    step = max(1, BLOCK // len(other.corners))
    blocks = [slice(start, start + step) for start in range(0, len(points), step)]
    if len(other.corners) < MANY:
        return np.concatenate([other.distances(points[block]) > reach[block] for block in blocks])
    far = np.ones(len(points), dtype=np.bool_)
    middles = other.corners.mean(axis=1)
    own = np.sqrt(((other.corners - middles[:, None]) ** 2).sum(axis=2).max(axis=1)) + SLACK_M
    for block in blocks:
        away = sum((points[block, None, axis] - middles[:, axis]) ** 2 for axis in range(3))
        near = away <= (reach[block, None] + own) ** 2
        for row in np.flatnonzero(near.any(axis=1)):
            place = block.start + row
            far[place] = other.take(near[row]).distances(points[place][None])[0] > reach[place]
    return far


def _ask_ball(middles: Floats, radius: Floats, other: Triangles) -> tuple[Bools, Bools]:
    """[P] of balls: whether none of another part's triangles comes near; and whether they lie inside it then."""
    clear = _are_far(middles, radius * (1.0 + 1e-9) + 1e-12, other)
    inside = np.zeros(len(middles), dtype=np.bool_)
    inside[clear] = other.windings(middles[clear]) > 0.5
    return clear, inside


def _is_convex(part: Triangles, planes: tuple[Floats, Floats]) -> bool:
    """Whether no corner of a part lies in front of one of its faces; where one does, others are not measured."""
    return all((heights <= FLAT).all() for heights in _blocks_of_heights(part.corners, planes))


def _ask_planes(pieces: Floats, planes: tuple[Floats, Floats]) -> tuple[Bools, Bools]:
    """[P] of triangles: whether all corners lie inside a convex part or in front of one face; and whether inside."""
    inside, outside = [], []
    for heights in _blocks_of_heights(pieces, planes):
        inside.append((heights < -FLAT).all(axis=(1, 2)))
        outside.append((heights >= 0.0).all(axis=1).any(axis=-1))
    is_inside = np.concatenate(inside)
    return np.logical_or(is_inside, np.concatenate(outside)), is_inside


def _blocks_of_heights(triangles: Floats, planes: tuple[Floats, Floats]) -> Iterator[Floats]:
    """`_heights` of some triangles after others: all at once are as many as the square of a mesh's triangles."""
    step = max(1, BLOCK // (3 * len(planes[1])))
    for start in range(0, len(triangles), step):
        yield _heights(triangles[start : start + step], planes)


def _planes(part: Triangles) -> tuple[Floats, Floats]:
    """Of the faces with an area: normals [F, 3] of length 1, and their heights over the origin [F]."""
    size = np.sqrt((part.normals**2).sum(axis=1))
    normals = part.normals[size > 0.0] / size[size > 0.0, None]
    return normals, (normals * part.corners[size > 0.0, 0]).sum(axis=1)


def _heights(triangles: Floats, planes: tuple[Floats, Floats]) -> Floats:
    """[P, 3, F] m of the corners of triangles over planes."""
    normals, offsets = planes
    x, y, z = (triangles[..., k, None] for k in range(3))
    return x * normals[:, 0] + y * normals[:, 1] + z * normals[:, 2] - offsets
