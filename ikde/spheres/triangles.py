"""Shapes as triangles: boxes and meshes as they are, round ones with flat facets, for drawings."""

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.spheres.mesh_file import read_mesh
from ikde.spheres.shapes import Shape

FACETS = 32
"""Around a round shape."""
_CORNERS = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
_FACES = np.array(
    [
        *([0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1]),
        *([2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]),
    ]
)


def shape_triangles(shape: Shape) -> Floats:
    """The triangles [T, 3, 3] of a shape in m, in the frame of its link, wound outwards.

    Raises:
        FileError: for a mesh that cannot be read, or is too large.
        InputError: for meshes without trimesh (extra `meshes`).
    """
    if shape.mesh:
        own = read_mesh(shape.mesh, shape.scale)[0]
    elif shape.kind == "box":
        own = (_CORNERS * shape.size)[_FACES]
    else:
        own = _turn(_outline(shape))
    return own @ shape.T_link_shape[:3, :3].T + shape.T_link_shape[:3, 3]


def _outline(shape: Shape) -> Floats:
    """Points [N, 2] from the lowest to the highest: distance from z, and height."""
    radius = shape.size[0]
    half = 0.5 * shape.size[1] if len(shape.size) > 1 else 0.0
    if shape.kind == "cylinder":
        return np.array([[0.0, -half], [radius, -half], [radius, half], [0.0, half]])
    angles = np.linspace(-0.5 * np.pi, 0.5 * np.pi, FACETS // 2 + 2)
    shift = np.where(angles > 0.0, half, -half)
    return np.column_stack([radius * np.cos(angles), radius * np.sin(angles) + shift])


def _turn(outline: Floats) -> Floats:
    """The triangles between an outline and the same one facet further about z."""
    angles = np.linspace(0.0, 2.0 * np.pi, FACETS + 1)
    radial, height = outline.T
    points = np.stack(
        [np.outer(np.cos(angles), radial), np.outer(np.sin(angles), radial), np.tile(height, (FACETS + 1, 1))], axis=2
    )
    a, b, c, d = points[:-1, :-1], points[1:, :-1], points[1:, 1:], points[:-1, 1:]
    return np.concatenate(
        [np.stack([a, b, c], axis=2).reshape(-1, 3, 3), np.stack([a, c, d], axis=2).reshape(-1, 3, 3)]
    )
