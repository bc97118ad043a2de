"""Spheres that stand in a file already, compared with the shapes that they are for: what is proved of them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.spheres.certificate import certify
from ikde.spheres.cover_mesh import bound_protrusion, convex_hull
from ikde.spheres.parts import make_solid
from ikde.spheres.shapes import Shape
from ikde.spheres.triangles import shape_triangles

TOLERANCE_M = 1e-9
"""Spheres that go through corners of shapes hold them, whatever rounding says."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Measured:
    """What is proved of spheres; None is not checked: a link without shapes, or with round ones."""

    covered: float | None
    """Share of the surface that lies inside spheres by proof, to `TOLERANCE_M`."""
    protrusion_m: float | None
    """No point of a sphere is farther from the shapes than this."""
    of_hulls: bool = False
    """Whether both are of the convex hulls of the parts, of which more is covered than of the parts."""


def measure_spheres(shapes: Sequence[Shape], centres: Floats, radii: Floats) -> Measured:
    """What is proved of a link's spheres [S, 3] and [S] in m, for shapes that are boxes and meshes.

    Raises:
        FileError: for a mesh that cannot be read, or is too large.
        InputError: for meshes without trimesh (extra `meshes`).
    """
    if not shapes or not all(shape.kind in ("box", "mesh") for shape in shapes) or not len(radii):
        return Measured(covered=None, protrusion_m=None)
    triangles = np.concatenate([shape_triangles(shape) for shape in shapes])
    own = _measure(triangles, centres, radii, only_hulls=False)
    if own.covered == 1.0:
        return own
    hulls = _measure(triangles, centres, radii, only_hulls=True)
    return hulls if (hulls.covered or 0.0) > (own.covered or 0.0) else own


def _measure(triangles: Floats, centres: Floats, radii: Floats, *, only_hulls: bool) -> Measured:
    solid, _ = make_solid(triangles, convex_hull, only_hulls=only_hulls)
    certificate = certify(solid.surface.corners, centres, radii + TOLERANCE_M)
    return Measured(
        covered=certificate.covered, protrusion_m=bound_protrusion(solid, centres, radii), of_hulls=only_hulls
    )
