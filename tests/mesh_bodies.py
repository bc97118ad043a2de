"""Small bodies of triangles, for tests of meshes."""

from pathlib import Path

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.spheres.solid import Solid, Triangles

CORNERS = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
FACES = np.array(
    [
        *([0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1]),
        *([2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]),
    ]
)
"""Of a box, seen from outside counterclockwise; the last two are its upper side."""
OUTLINE = np.array([[0.0, 0.0], [0.2, 0.0], [0.2, 0.1], [0.1, 0.1], [0.1, 0.2], [0.0, 0.2]])
"""Of an L."""


def box(x: float, y: float, z: float) -> Floats:
    """The 12 triangles [12, 3, 3] of a box with a corner at the origin."""
    return (CORNERS * (x, y, z))[FACES]


def make_l(height: float = 0.1) -> Floats:
    """The triangles of a prism over an L."""
    low, high = np.insert(OUTLINE, 2, 0.0, axis=1), np.insert(OUTLINE, 2, height, axis=1)
    lids = [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5)]
    sides = [(k, (k + 1) % 6) for k in range(6)]
    triangles = [high[list(lid)] for lid in lids] + [low[list(lid[::-1])] for lid in lids]
    triangles += [np.array([low[a], low[b], high[b]]) for a, b in sides]
    triangles += [np.array([low[a], high[b], high[a]]) for a, b in sides]
    return np.array(triangles)


def solid_of(triangles: Floats) -> Solid:
    """A closed body."""
    return Solid(Triangles.of(triangles), Triangles.of(triangles))


def write_stl(path: Path, triangles: Floats) -> Path:
    """A binary STL."""
    content = np.zeros(len(triangles), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])
    content["corners"] = triangles
    path.write_bytes(b"\0" * 80 + np.uint32(len(triangles)).tobytes() + content.tobytes())
    return path


def on_surface(triangles: Floats, count: int, seed: int = 0) -> Floats:
    """Random points [count, 3] of a surface, evenly over its area."""
    draw = np.random.default_rng(seed)
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    areas = np.linalg.norm(normals, axis=1)
    a, b, c = np.moveaxis(triangles[draw.choice(len(triangles), count, p=areas / areas.sum())], 1, 0)
    u, v = np.sqrt(draw.random((count, 1))), draw.random((count, 1))
    return (1 - u) * a + u * (1 - v) * b + u * v * c
