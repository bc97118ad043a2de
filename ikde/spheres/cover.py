"""The spheres of a link: each of its shapes covered by its own."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.spheres.cover_mesh import MeshCover, cover_mesh
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
    """Share of the meshes' surface that lies inside spheres by proof; 1 without meshes."""
    protrusion_m: float
    """How far they stand out of the shapes at most."""
    how: str
    warnings: tuple[str, ...] = ()


def cover_shapes(shapes: Sequence[Shape], protrusion_m: float = 0.02) -> Cover:
    """Spheres that cover the shapes of a link.

    All of a box, cylinder or capsule is covered, its inside as well, and the protrusion is exact: see
    `ikde.spheres.primitives`. Of a mesh the surface is covered, see `ikde.spheres.cover_mesh`; what is not proved of it
    lowers `covered`. A sphere's protrusion is measured from its own shape, whatever others lie beside it.

    Args:
        shapes: at least one.
        protrusion_m: how far spheres may stand out of the shapes, in m.

    Raises:
        FileError: for a mesh that cannot be read, or is too large.
        InputError: for a shape that would take too many spheres, and for meshes without trimesh (extra `meshes`).
    """
    meshes = [cover_mesh(s.mesh, s.scale, protrusion_m) if s.mesh else None for s in shapes]
    rows = [mesh.rows if mesh else _cover_exactly(s, protrusion_m) for s, mesh in zip(shapes, meshes, strict=True)]
    placed = [
        own.centres @ shape.T_link_shape[:3, :3].T + shape.T_link_shape[:3, 3]
        for shape, own in zip(shapes, rows, strict=True)
    ]
    known = [mesh for mesh in meshes if mesh]
    area = sum(mesh.area_m2 for mesh in known)
    return Cover(
        centres=np.concatenate(placed),
        radii=np.concatenate([own.radii for own in rows]),
        covered=sum(mesh.covered * mesh.area_m2 for mesh in known) / area if area else 1.0,
        protrusion_m=max(own.protrusion_m for own in rows),
        how=", ".join(_say_how(known, len(known) < len(shapes))),
        warnings=tuple(warning for mesh in known for warning in mesh.warnings),
    )


def _say_how(meshes: Sequence[MeshCover], has_others: bool) -> Iterator[str]:
    if has_others:
        yield "rows and grids in closed form"
    if meshes:
        yield "fitted to the mesh"
    if parts := sum(mesh.parts.hulls for mesh in meshes if mesh.only_hulls):
        yield f"hulls of {parts} parts, for fewer spheres" if parts > 1 else "hull, for fewer spheres"
    if hulls := sum(mesh.parts.hulls for mesh in meshes if not mesh.only_hulls):
        yield f"hulls of {hulls} open parts" if hulls > 1 else "hull of an open part"
    if sheets := sum(mesh.parts.sheets for mesh in meshes):
        yield f"{sheets} flat parts" if sheets > 1 else "a flat part"


def _cover_exactly(shape: Shape, protrusion_m: float) -> Rows:
    if shape.kind == "sphere":
        return Rows(np.zeros((1, 3)), np.array(shape.size), 0.0)
    if shape.kind == "box":
        x, y, z = shape.size
        return cover_box((x, y, z), protrusion_m)
    cover = cover_cylinder if shape.kind == "cylinder" else cover_capsule
    radius, length = shape.size
    return cover(radius, length, protrusion_m)
