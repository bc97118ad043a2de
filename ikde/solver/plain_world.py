"""Signed distances to obstacles in plain numpy, one short formula a solid: what `check` and `verify` see of a world.

Nothing is shared with the kernels' own (`kernels/obstacles.py`). Outside a solid a distance is exact; inside, it is
minus the depth: how far it is to the nearest point of the surface. Of an obstacle of several solids it is the smallest
of theirs, so inside two that overlap the depth is that of one of them.
"""

from collections.abc import Callable, Mapping

import numpy as np

from ikde.kernels.arrays import Floats, Ints
from ikde.model.solids import Solid, SolidKind
from ikde.model.world import Obstacle

CHUNK = 4096  # points of a cloud, or triangles of a hull, at a time


def measure_obstacle(obstacle: Obstacle, P: Floats) -> Floats:
    """Signed distances [...] in m of points `P` [..., 3] in the world from an obstacle."""
    R, p = obstacle.T_world_obstacle[:, :3], obstacle.T_world_obstacle[:, 3]
    own = (P - p) @ R  # R^T (P - p)
    return np.min([measure_solid(solid, own) for solid in obstacle.solids], axis=0)


def measure_solid(solid: Solid, P: Floats) -> Floats:
    """Signed distances [...] in m of points `P` [..., 3] in the obstacle's frame from a solid."""
    R, p = solid.T_obstacle_solid[:, :3], solid.T_obstacle_solid[:, 3]
    return _MEASURES[solid.kind](solid, (P - p) @ R)


def _sphere(solid: Solid, P: Floats) -> Floats:
    return np.linalg.norm(P, axis=-1) - solid.size_m[0]


def _box(solid: Solid, P: Floats) -> Floats:
    beyond = np.abs(P) - 0.5 * np.array(solid.size_m)
    outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=-1)
    return outside + np.minimum(beyond.max(axis=-1), 0.0)


def _cylinder(solid: Solid, P: Floats) -> Floats:
    radius, height = solid.size_m
    beyond = np.stack([np.hypot(P[..., 0], P[..., 1]) - radius, np.abs(P[..., 2]) - 0.5 * height], axis=-1)
    return np.linalg.norm(np.maximum(beyond, 0.0), axis=-1) + np.minimum(beyond.max(axis=-1), 0.0)


def _capsule(solid: Solid, P: Floats) -> Floats:
    radius, height = solid.size_m
    on_axis = np.zeros_like(P)
    on_axis[..., 2] = np.clip(P[..., 2], -0.5 * height, 0.5 * height)
    return np.linalg.norm(P - on_axis, axis=-1) - radius


def _cone(solid: Solid, P: Floats) -> Floats:
    """In the plane through the axis: a triangle, of which only the base and the side are surface."""
    radius, height = solid.size_m
    point = np.stack([np.hypot(P[..., 0], P[..., 1]), P[..., 2]], axis=-1)
    centre, rim, tip = np.array([[0.0, -0.5 * height], [radius, -0.5 * height], [0.0, 0.5 * height]])
    distance = np.minimum(_to_segment(point, centre, rim), _to_segment(point, rim, tip))
    side = (tip - rim)[0] * (point - rim)[..., 1] - (tip - rim)[1] * (point - rim)[..., 0]  # > 0 inside
    inside = (point[..., 1] > -0.5 * height) & (side > 0.0)
    return np.where(inside, -distance, distance)


def _half_space(solid: Solid, P: Floats) -> Floats:
    return P[..., 2].copy()


def _hull(solid: Solid, P: Floats) -> Floats:
    assert solid.points is not None
    assert solid.triangles is not None
    flat, found = P.reshape(-1, 3), np.empty(P.shape[:-1]).ravel()
    for row, point in enumerate(flat):
        found[row] = _point_to_hull(point, solid.points, solid.triangles)
    return found.reshape(P.shape[:-1])


def _cloud(solid: Solid, P: Floats) -> Floats:
    assert solid.points is not None
    nearest = np.full(P.shape[:-1], np.inf)
    for first in range(0, len(solid.points), CHUNK):
        some = solid.points[first : first + CHUNK]
        nearest = np.minimum(nearest, np.linalg.norm(P[..., None, :] - some, axis=-1).min(axis=-1))
    return nearest - solid.size_m[0]


_MEASURES: Mapping[SolidKind, Callable[[Solid, Floats], Floats]] = {
    "sphere": _sphere,
    "box": _box,
    "cylinder": _cylinder,
    "capsule": _capsule,
    "cone": _cone,
    "half_space": _half_space,
    "hull": _hull,
    "cloud": _cloud,
}


def _to_segment(point: Floats, a: Floats, b: Floats) -> Floats:
    """Distances [...] of points [..., D] from the line between two."""
    share = np.clip((point - a) @ (b - a) / ((b - a) @ (b - a)), 0.0, 1.0)
    return np.linalg.norm(point - a - share[..., None] * (b - a), axis=-1)


def _point_to_hull(point: Floats, corners: Floats, triangles: Ints) -> float:
    """Signed distance of a point [3] from a convex hull: by its planes inside, by its triangles outside."""
    a, b, c = (corners[triangles[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    heights = np.einsum("fi,fi->f", normals, point - a)
    if heights.max() <= 0.0:
        return float(heights.max())
    foot = point - heights[:, None] * normals
    insides = [np.einsum("fi,fi->f", np.cross(q - p, foot - p), normals) >= 0.0 for p, q in ((a, b), (b, c), (c, a))]
    on_face = np.where(np.logical_and.reduce(insides), np.abs(heights), np.inf)
    edges = [np.linalg.norm(_edge_foot(point, p, q), axis=1) for p, q in ((a, b), (b, c), (c, a))]
    return float(min(on_face.min(), *(edge.min() for edge in edges)))


def _edge_foot(point: Floats, a: Floats, b: Floats) -> Floats:
    """From the nearest points of edges [F, 3] to [F, 3] to a point [3]."""
    line = b - a
    share = np.clip(np.einsum("fi,fi->f", point - a, line) / np.einsum("fi,fi->f", line, line), 0.0, 1.0)
    return point - a - share[:, None] * line
