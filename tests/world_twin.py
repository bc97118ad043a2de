"""Distances from solids by other means than ikde's: nearest points, and the edges of what is turned about an axis."""

from itertools import pairwise

import numpy as np


def measure(kind, size, points, P):
    """Signed distances [K] of points [K, 3] from a solid in its own frame, m."""
    if kind == "sphere":
        return np.linalg.norm(P, axis=1) - size[0]
    if kind == "half_space":
        return P[:, 2]
    if kind == "cloud":
        return np.linalg.norm(P[:, None] - points, axis=2).min(axis=1) - size[0]
    if kind == "box":
        half = 0.5 * np.array(size)
        depth = np.hstack([half - P, half + P]).min(axis=1)
        return np.where(depth >= 0.0, -depth, np.linalg.norm(P - np.clip(P, -half, half), axis=1))
    radius, half = size[0], 0.5 * size[1]
    if kind == "capsule":
        return to_line(P, np.array([0.0, 0.0, -half]), np.array([0.0, 0.0, half])) - radius
    corners = {"cylinder": [[0, -half], [radius, -half], [radius, half], [0, half]]}
    return turned(np.array(corners.get(kind, [[0, -half], [radius, -half], [0, half]])), P)


def turned(corners, P):
    """From what a convex outline (across, along), counter-clockwise from the axis to the axis, makes turned about z."""
    point = np.column_stack([np.hypot(P[:, 0], P[:, 1]), P[:, 2]])
    distance, inside = np.full(len(P), np.inf), np.ones(len(P), dtype=bool)
    for a, b in pairwise(corners):
        distance = np.minimum(distance, to_line(point, a, b))
        inside &= (b - a)[0] * (point - a)[:, 1] - (b - a)[1] * (point - a)[:, 0] >= 0.0
    return np.where(inside, -distance, distance)


def to_line(points, a, b):
    share = np.clip((points - a) @ (b - a) / ((b - a) @ (b - a)), 0.0, 1.0)
    return np.linalg.norm(points - a - share[:, None] * (b - a), axis=1)


def from_hull(corners, triangles, P):
    """As `measure`, of a convex hull: the deepest plane inside, the nearest point of a triangle outside."""
    gap, highest = np.full(len(P), np.inf), np.full(len(P), -np.inf)
    for a, b, c in corners[triangles]:
        normal = np.cross(b - a, c - a)
        normal /= np.linalg.norm(normal)
        height = (P - a) @ normal
        foot = P - height[:, None] * normal
        over = np.logical_and.reduce([(foot - p) @ np.cross(normal, q - p) >= 0 for p, q in ((a, b), (b, c), (c, a))])
        edges = np.min([to_line(P, p, q) for p, q in ((a, b), (b, c), (c, a))], axis=0)
        gap = np.minimum(gap, np.where(over, np.abs(height), edges))
        highest = np.maximum(highest, height)
    return np.where(highest <= 0.0, highest, gap)


def measure_placed(obstacle, P):
    """Of an obstacle, for points [K, 3] of the world."""
    found = []
    for solid in obstacle.solids:
        own = (P - obstacle.T_world_obstacle[:, 3]) @ obstacle.T_world_obstacle[:, :3]
        own = (own - solid.T_obstacle_solid[:, 3]) @ solid.T_obstacle_solid[:, :3]
        if solid.kind == "hull":
            found.append(from_hull(solid.points, solid.triangles, own))
        else:
            found.append(measure(solid.kind, solid.size_m, solid.points, own))
    return np.min(found, axis=0)
