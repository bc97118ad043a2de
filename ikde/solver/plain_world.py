"""Signed distances to obstacles in plain numpy, one short formula a solid: what `check` and `verify` see of a world.

Nothing is shared with the kernels' own (`kernels/obstacles.py`). Outside a solid a distance is exact; inside, it is
minus the depth: how far it is to the nearest point of the surface. Of an obstacle of several solids it is the smallest
of theirs, so inside two that overlap the depth is that of one of them.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import lru_cache, reduce
from typing import NamedTuple

import numpy as np

from ikde.kernels.arrays import Floats, Ints
from ikde.model.hull import measure_normals
from ikde.model.solids import Solid, SolidKind
from ikde.model.world import Obstacle
from ikde.solver.plain_cloud import find_cloud_gaps

CHUNK = 4096  # points of a cloud, or points times triangles of a hull, at a time


def measure_obstacle(obstacle: Obstacle, P: Floats) -> Floats:
    """Signed distances [...] in m of points `P` [..., 3] in the world from an obstacle."""
    R, p = obstacle.T_world_obstacle[:, :3], obstacle.T_world_obstacle[:, 3]
    own = (P - p) @ R  # R^T (P - p)
    return np.min([measure_solid(solid, own) for solid in obstacle.solids], axis=0)


def measure_solid(solid: Solid, P: Floats) -> Floats:
    """Signed distances [...] in m of points `P` [..., 3] in the obstacle's frame from a solid."""
    R, p = solid.T_obstacle_solid[:, :3], solid.T_obstacle_solid[:, 3]
    if solid.kind in _ALIKE:
        return _ALIKE[solid.kind](np.array(solid.size_m), (P - p) @ R)
    return _SINGLE[solid.kind](solid, (P - p) @ R)


class Alike(NamedTuple):
    """Solids of one kind that are measured together, in the order of their obstacles."""

    kind: SolidKind
    owners: Ints
    """[S] which obstacle each belongs to."""
    R: Floats
    """[S, 3, 3] its axes in the world."""
    p: Floats
    """[S, 1, 3] its place in the world, m."""
    sizes: Floats
    """[S, 1, k] m."""
    solid: Solid | None
    """If it is a kind that is measured one by one."""

    def measure(self, P: Floats) -> Iterator[tuple[Ints, Floats]]:
        """Owners [s] and distances [s, K] of points `P` [K, 3] in the world, m, so many at a time as a cache holds."""
        several = max(1, CHUNK // len(P))
        for first in range(0, len(self.owners), several):
            some = slice(first, first + several)
            own = (P - self.p[some]) @ self.R[some]
            if self.solid is None:
                yield self.owners[some], _ALIKE[self.kind](self.sizes[some], own)
            else:
                yield self.owners[some], _SINGLE[self.kind](self.solid, own)


def list_alike(obstacles: Sequence[Obstacle], Ts_world_frame: Mapping[str, Floats]) -> tuple[Alike, ...]:
    """All solids of obstacles in the frames [4, 4] that they stand in."""
    found: dict[tuple[SolidKind, int], list[tuple[int, Floats, Solid]]] = {}
    for owner, obstacle in enumerate(obstacles):
        T = Ts_world_frame[obstacle.frame][:3]
        T_world_obstacle = _compose(T, obstacle.T_world_obstacle)
        for solid in obstacle.solids:
            group = solid.kind, -1 if solid.kind in _ALIKE else id(solid)
            found.setdefault(group, []).append((owner, _compose(T_world_obstacle, solid.T_obstacle_solid), solid))
    groups = []
    for (kind, single), rows in found.items():
        owners, Ts, solids = zip(*rows, strict=True)
        T, sizes = np.array(Ts), np.array([solid.size_m for solid in solids])[:, None]
        own = None if single < 0 else solids[0]
        groups.append(Alike(kind, np.array(owners), T[:, :, :3], T[:, None, :, 3], sizes, own))
    return tuple(groups)


def _compose(one: Floats, other: Floats) -> Floats:
    """The product of two poses [3, 4]."""
    T = one[:, :3] @ other
    T[:, 3] += one[:, 3]
    return T


def _sphere(size: Floats, P: Floats) -> Floats:
    return np.sqrt(np.einsum("...i,...i->...", P, P)) - size[..., 0]


def _box(size: Floats, P: Floats) -> Floats:
    beyond = np.abs(P) - 0.5 * size
    return _combine(beyond[..., 0], beyond[..., 1], beyond[..., 2])


def _cylinder(size: Floats, P: Floats) -> Floats:
    across, along = np.hypot(P[..., 0], P[..., 1]) - size[..., 0], np.abs(P[..., 2]) - 0.5 * size[..., 1]
    return _combine(across, along)


def _combine(*beyond: Floats) -> Floats:
    """From how far points are beyond each pair of faces, or a round one; inside all of them the nearest counts."""
    outside = np.sqrt(sum(np.square(np.maximum(one, 0.0)) for one in beyond))
    return outside + np.minimum(reduce(np.maximum, beyond), 0.0)


def _capsule(size: Floats, P: Floats) -> Floats:
    half = 0.5 * size[..., 1]
    z = P[..., 2] - np.clip(P[..., 2], -half, half)
    return np.sqrt(np.square(P[..., 0]) + np.square(P[..., 1]) + np.square(z)) - size[..., 0]


def _half_space(size: Floats, P: Floats) -> Floats:
    return P[..., 2].copy()


def _cone(solid: Solid, P: Floats) -> Floats:
    """In the plane through the axis: a triangle, of which only the base and the side are surface."""
    radius, height = solid.size_m
    point = np.stack([np.hypot(P[..., 0], P[..., 1]), P[..., 2]], axis=-1)
    centre, rim, tip = np.array([[0.0, -0.5 * height], [radius, -0.5 * height], [0.0, 0.5 * height]])
    distance = np.minimum(_to_segment(point, centre, rim), _to_segment(point, rim, tip))
    side = (tip - rim)[0] * (point - rim)[..., 1] - (tip - rim)[1] * (point - rim)[..., 0]  # > 0 inside
    inside = (point[..., 1] > -0.5 * height) & (side > 0.0)
    return np.where(inside, -distance, distance)


def _hull(solid: Solid, P: Floats) -> Floats:
    """By its planes inside, by its triangles outside."""
    faces, normals = _list_faces(solid)
    flat, found = P.reshape(-1, 3), np.empty(P.shape[:-1]).ravel()
    several = max(1, CHUNK // len(normals))
    for first in range(0, len(flat), several):
        found[first : first + several] = _points_to_hull(flat[first : first + several, None], faces, normals)
    return found.reshape(P.shape[:-1])


def _cloud(solid: Solid, P: Floats) -> Floats:
    """By every point of a small one, of a large one by its boxes."""
    assert solid.points is not None
    if len(solid.points) <= CHUNK:
        return np.linalg.norm(P[..., None, :] - solid.points, axis=-1).min(axis=-1) - solid.size_m[0]
    flat = P.reshape(-1, 3)
    gaps = find_cloud_gaps(solid.points, flat, np.zeros(len(flat)), np.arange(len(flat)), len(flat))
    return gaps.reshape(P.shape[:-1]) - solid.size_m[0]


_ALIKE: Mapping[SolidKind, Callable[[Floats, Floats], Floats]] = {
    "sphere": _sphere,
    "box": _box,
    "cylinder": _cylinder,
    "capsule": _capsule,
    "half_space": _half_space,
}
"""By sizes [..., k], of one solid or of many, and points [..., 3] in their own frames."""
_SINGLE: Mapping[SolidKind, Callable[[Solid, Floats], Floats]] = {"cone": _cone, "hull": _hull, "cloud": _cloud}


def _to_segment(point: Floats, a: Floats, b: Floats) -> Floats:
    """Distances [...] of points [..., D] from the line between two."""
    share = np.clip((point - a) @ (b - a) / ((b - a) @ (b - a)), 0.0, 1.0)
    return np.linalg.norm(point - a - share[..., None] * (b - a), axis=-1)


@lru_cache(maxsize=1024)
def _list_faces(solid: Solid) -> tuple[Floats, Floats]:
    """Corners [3, F, 3] of a hull's triangles, and their outward normals [F, 3], right for the thinnest triangle."""
    assert solid.points is not None
    assert solid.triangles is not None
    return solid.points[solid.triangles.T], measure_normals(solid.points, solid.triangles)


def _points_to_hull(points: Floats, faces: Floats, normals: Floats) -> Floats:
    """Signed distances [K] of points [K, 1, 3] from a convex hull."""
    sides = list(zip(faces, np.roll(faces, -1, axis=0), strict=True))
    heights = np.einsum("fi,kfi->kf", normals, points - faces[0])
    foot = points - heights[..., None] * normals
    inside = [np.einsum("kfi,fi->kf", foot - a, np.cross(normals, b - a)) >= 0.0 for a, b in sides]
    on_face = np.where(np.logical_and.reduce(inside), np.abs(heights), np.inf)
    edges = [_to_edges(points, a, b) for a, b in sides]
    deepest = heights.max(axis=1)
    return np.where(deepest <= 0.0, deepest, np.min([on_face, *edges], axis=(0, 2)))


def _to_edges(points: Floats, a: Floats, b: Floats) -> Floats:
    """Distances [K, F] of points [K, 1, 3] from edges [F, 3] to [F, 3]."""
    line = b - a
    share = np.clip(np.einsum("kfi,fi->kf", points - a, line) / np.einsum("fi,fi->f", line, line), 0.0, 1.0)
    return np.linalg.norm(points - a - share[..., None] * line, axis=-1)
