"""The spheres of a link: each of its shapes covered by its own."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ikde.errors import InputError
from ikde.kernels.arrays import Floats
from ikde.spheres.primitives import Rows, cover_box, cover_capsule, cover_cylinder
from ikde.spheres.shapes import Shape


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Cover:
    """Spheres that cover shapes, and what is proved of them."""

    centres: Floats
    """[S, 3] m, in the link."""
    radii: Floats
    """[S] m"""
    covered: float
    """Share of the surface that lies inside spheres by proof."""
    protrusion_m: float
    """How far they stand out of the shapes at most."""
    how: str


def cover_shapes(shapes: Sequence[Shape], protrusion_m: float = 0.02) -> Cover:
    """Spheres that cover the boxes, cylinders and capsules of a link.

    All of each shape is covered, its inside as well, and the protrusion is exact: see `ikde.spheres.primitives`. A
    sphere's protrusion is measured from its own shape, whatever others lie beside it.

    Args:
        shapes: at least one.
        protrusion_m: how far spheres may stand out of the shapes, in m.

    Raises:
        InputError: for a mesh, or a shape that would take too many spheres.
    """
    rows = [_cover_one(shape, protrusion_m) for shape in shapes]
    placed = [
        own.centres @ shape.T_link_shape[:3, :3].T + shape.T_link_shape[:3, 3]
        for shape, own in zip(shapes, rows, strict=True)
    ]
    return Cover(
        centres=np.concatenate(placed),
        radii=np.concatenate([own.radii for own in rows]),
        covered=1.0,
        protrusion_m=max(own.protrusion_m for own in rows),
        how="rows and grids in closed form",
    )


def _cover_one(shape: Shape, protrusion_m: float) -> Rows:
    if shape.kind == "sphere":
        return Rows(np.zeros((1, 3)), np.array(shape.size), 0.0)
    if shape.kind == "box":
        x, y, z = shape.size
        return cover_box((x, y, z), protrusion_m)
    if shape.kind == "mesh":
        raise InputError("a mesh cannot be covered with spheres yet; --no-spheres does without")
    cover = cover_cylinder if shape.kind == "cylinder" else cover_capsule
    radius, length = shape.size
    return cover(radius, length, protrusion_m)
