"""Spheres for the shapes of links."""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from ikde.errors import FileError, InputError
from ikde.io.urdf_import.chain import LinkTree
from ikde.io.urdf_import.description import Description, UrdfShape
from ikde.io.urdf_import.imported import AS_THEY_ARE, CoveredLink
from ikde.io.urdf_import.meshes import find_mesh
from ikde.io.urdf_import.options import ImportOptions
from ikde.kernels.arrays import Floats
from ikde.spheres import cover_shapes
from ikde.spheres.shapes import Shape


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LinkSpheres:
    """Spheres of one link."""

    centres: Floats
    """[S, 3] m, in the link."""
    radii: Floats
    """[S] m"""
    report: CoveredLink
    warnings: tuple[str, ...] = ()


PLURALS = {"box": "boxes", "mesh": "meshes"}


def cover_links(description: Description, tree: LinkTree, options: ImportOptions) -> dict[str, LinkSpheres]:
    """Spheres of each link that has shapes; every mesh is found before any is covered."""
    shapes = find_shapes(description, tree, options)
    return {name: cover_link(description, name, own, options.protrusion_m) for name, own in shapes.items() if own}


def find_shapes(description: Description, tree: LinkTree, options: ImportOptions) -> dict[str, list[Shape]]:
    """The shapes of each link, their meshes found; raises `FileError` for one that is missing."""
    return {name: _find_shapes(description, description.links[name].shapes, options) for name in tree.order}


def cover_link(description: Description, link: str, shapes: list[Shape], protrusion_m: float) -> LinkSpheres:
    """Spheres of one link's shapes; raises `FileError` for what cannot be covered, with the link."""
    try:
        return _cover(link, shapes, protrusion_m)
    except FileError:
        raise
    except InputError as error:
        raise FileError(description.path, error.message, ("link", link)) from None


def _find_shapes(description: Description, shapes: Iterable[UrdfShape], options: ImportOptions) -> list[Shape]:
    factor = options.mesh_scale
    return [
        Shape(
            kind=shape.kind,
            size=shape.size,
            T_link_shape=shape.T_link_shape,
            mesh=find_mesh(description.path, shape.mesh, options.package_paths, shape.line) if shape.mesh else None,
            scale=(factor * shape.scale[0], factor * shape.scale[1], factor * shape.scale[2]),
        )
        for shape in shapes
    ]


def describe_shapes(shapes: list[Shape]) -> str:
    """How many there are of each kind: `2 boxes, 1 mesh`."""
    kinds = Counter(shape.kind for shape in shapes)
    return ", ".join(f"{n} {kind if n == 1 else PLURALS.get(kind, kind + 's')}" for kind, n in kinds.items())


def _cover(link: str, shapes: list[Shape], protrusion_m: float) -> LinkSpheres:
    own = [shape for shape in shapes if shape.kind == "sphere"]
    centres = np.array([shape.T_link_shape[:3, 3] for shape in own]).reshape(-1, 3)
    radii = np.array([shape.size[0] for shape in own])
    others = [shape for shape in shapes if shape.kind != "sphere"]
    covered, protrusion, how = None, 0.0, AS_THEY_ARE
    warnings: tuple[str, ...] = ()
    if others:
        cover = cover_shapes(others, protrusion_m)
        centres, radii = np.vstack([centres, cover.centres]), np.concatenate([radii, cover.radii])
        covered, protrusion, how = cover.covered, cover.protrusion_m, cover.how
        warnings = tuple(f"link {link}: {warning}" for warning in cover.warnings)
    return LinkSpheres(
        centres=centres,
        radii=radii,
        report=CoveredLink(
            link=link,
            shapes=describe_shapes(shapes),
            spheres=len(radii),
            covered=covered,
            protrusion_m=protrusion,
            how=how,
        ),
        warnings=warnings,
    )
