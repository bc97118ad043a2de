"""Covers judged by points: written from what is promised, with geometry of its own and nothing of `ikde.spheres`.

A connected part is closed if every edge is passed as often either way, and solid then; of any other the convex hull is
solid, or it lies in a plane. A point of the surface of one has to be in a sphere, or inside another solid.
"""

from collections import Counter
from typing import NamedTuple

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from ikde.kernels.arrays import Floats

WITHIN_M = 1e-9  # as a share of the mesh's size, too


class Part(NamedTuple):
    """One connected part."""

    triangles: Floats
    is_solid: bool


class Verdict(NamedTuple):
    """What points show of a cover."""

    bare: float  # share of the points asked about that are in no sphere and in no other solid
    out_m: float  # how far the point of a sphere that stands out most is from all parts
    points: int


def judge(
    triangles: Floats, centres: Floats, radii: Floats, rng: np.random.Generator, *, of_hulls: bool, count: int = 4_000
) -> Verdict:
    """Points of all surfaces, and of all spheres, that show whether they are covered and how far they stand out.

    Args:
        triangles: [T, 3, 3] m.
        centres: [S, 3] m.
        radii: [S] m.
        rng: for the points.
        of_hulls: the hulls of all parts are covered, not those of open ones alone.
        count: points of each part's surface.
    """
    own = list_parts(triangles, of_hulls=False)
    covered = list_parts(triangles, of_hulls=True) if of_hulls else own
    near = WITHIN_M * max(1.0, float(np.ptp(triangles.reshape(-1, 3), axis=0).max()))
    bare = asked = 0
    for k, part in enumerate(covered):
        points = draw_points(part.triangles, count, rng)
        left = points[_beyond(points, centres, radii) > near]
        for other in covered[:k] + covered[k + 1 :]:
            left = left[~is_inside(other, left, rng)]
        bare, asked = bare + len(left), asked + len(points)
    ways = rng.normal(size=(len(radii), 30, 3))
    ways /= np.linalg.norm(ways, axis=2)[:, :, None]
    points = (centres[:, None] + radii[:, None, None] * ways).reshape(-1, 3)
    points = points[rng.permutation(len(points))[:600]]
    away = np.min([find_distances(part.triangles, points) * ~is_inside(part, points, rng) for part in own], axis=0)
    return Verdict(bare / asked, float(away.max()), asked)


def list_parts(triangles: Floats, *, of_hulls: bool) -> list[Part]:
    """Connected parts, whose faces share corners; those without an area are left out."""
    points, corner = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
    faces = [tuple(face) for face in corner.reshape(-1, 3).tolist() if len(set(face)) == 3]
    group = list(range(len(points)))

    def find(k: int) -> int:
        while group[k] != k:
            group[k] = group[group[k]]
            k = group[k]
        return k

    for a, b, c in faces:
        group[find(a)] = group[find(b)] = find(c)
    members: dict[int, list[tuple[int, ...]]] = {}
    for face in faces:
        members.setdefault(find(face[0]), []).append(face)
    return [_make_part(points, own, of_hulls=of_hulls) for own in members.values()]


def _make_part(points: Floats, faces: list[tuple[int, ...]], *, of_hulls: bool) -> Part:
    passed = Counter((face[k], face[(k + 1) % 3]) for face in faces for k in range(3))
    triangles = points[np.array(faces)]
    if not of_hulls and all(passed[a, b] == passed[b, a] for a, b in passed):
        return Part(triangles, True)
    corners = points[np.unique(faces)]
    away = corners - corners.mean(axis=0)
    if len(corners) < 4 or np.linalg.matrix_rank(away, tol=1e-6 * np.abs(away).max()) < 3:
        return Part(triangles, False)
    try:
        hull = ConvexHull(corners)
    except QhullError:
        return Part(triangles, False)
    around = corners[hull.simplices]
    normals = np.cross(around[:, 1] - around[:, 0], around[:, 2] - around[:, 0])
    is_inwards = np.einsum("ij,ij->i", normals, hull.equations[:, :3]) < 0.0
    return Part(np.where(is_inwards[:, None, None], around[:, ::-1], around), True)


def draw_points(triangles: Floats, count: int, rng: np.random.Generator) -> Floats:
    """Points of a surface: spread over its area, and its corners, edges and middles of faces."""
    a, b, c = np.moveaxis(triangles, 1, 0)
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    chosen = rng.choice(len(triangles), count, p=areas / areas.sum() if areas.sum() else None)
    shares = rng.dirichlet(np.ones(3), count)
    inner = np.einsum("ij,ijk->ik", shares, triangles[chosen])
    t = rng.random((3 * len(triangles), 1))
    edges = np.concatenate([a, b, c]) * t + np.concatenate([b, c, a]) * (1.0 - t)
    return np.concatenate([inner, edges, triangles.reshape(-1, 3), triangles.mean(axis=1)])


def _beyond(points: Floats, centres: Floats, radii: Floats) -> Floats:
    """[P] m from points to the nearest sphere; negative inside."""
    return np.min([np.linalg.norm(points - c, axis=1) - r for c, r in zip(centres, radii, strict=True)], axis=0)


def is_inside(part: Part, points: Floats, rng: np.random.Generator) -> np.ndarray:
    """[P] whether points are inside a solid part: faces crossed by a ray to a random side, with their signs."""
    a, b, c = np.moveaxis(part.triangles, 1, 0)
    volume = np.einsum("ij,ij->", a - a.mean(axis=0), np.cross(b - a.mean(axis=0), c - a.mean(axis=0)))
    way = rng.normal(size=3)
    times = np.zeros(len(points))
    if not part.is_solid:
        return times > 0.0
    for p, q, r in zip(a, b, c, strict=True):
        normal = np.cross(q - p, r - p)
        slope = float(normal @ way)
        if slope == 0.0:
            continue
        along = (p - points) @ normal / slope
        hit = points + along[:, None] * way
        sides = [np.cross(end - start, hit - start) @ normal for start, end in ((p, q), (q, r), (r, p))]
        times += np.where((along > 0.0) & (np.min(sides, axis=0) > 0.0), np.sign(slope), 0.0)
    return times * np.sign(volume) > 0.5


def find_distances(triangles: Floats, points: Floats) -> Floats:
    """[P] m from points to the nearest triangle: to its plane where the foot is inside, else to an edge."""
    nearest = np.full(len(points), np.inf)
    for a, b, c in triangles:
        normal = np.cross(b - a, c - a)
        size = float(np.linalg.norm(normal))
        for start, end in ((a, b), (b, c), (c, a)):
            way = end - start
            t = np.clip((points - start) @ way / max(float(way @ way), 1e-300), 0.0, 1.0)
            nearest = np.minimum(nearest, np.linalg.norm(points - start - t[:, None] * way, axis=1))
        if size > 0.0:
            height = (points - a) @ normal / size
            foot = points - height[:, None] * normal / size
            sides = [np.cross(end - start, foot - start) @ normal for start, end in ((a, b), (b, c), (c, a))]
            nearest = np.where(np.min(sides, axis=0) > 0.0, np.minimum(nearest, np.abs(height)), nearest)
    return nearest
