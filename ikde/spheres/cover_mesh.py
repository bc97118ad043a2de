"""Spheres that cover a mesh: chosen greedily among many, and certified afterwards."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ikde.errors import InputError
from ikde.kernels.arrays import Floats
from ikde.spheres.candidates import Candidates, find_candidates
from ikde.spheres.certificate import certify
from ikde.spheres.greedy import cover_greedily, improve
from ikde.spheres.mesh_file import import_trimesh, read_mesh
from ikde.spheres.parts import PartCounts, make_solid
from ikde.spheres.patches import make_patches, patch_size, split
from ikde.spheres.primitives import Rows
from ikde.spheres.solid import Solid

MAX_INSIDE = 6_000
"""Points of the grid inside a body, about."""
EXCHANGES = 80_000_000
"""Work of exchanging spheres for fewer, where they are not far too many anyway: about 0.5 s a mesh."""
MAX_SPHERES = 60
"""Of one mesh, unless the hulls of its parts take more: a thin wall has room for small spheres only."""


@dataclass(frozen=True, slots=True, eq=False)
class MeshCover:
    """Spheres of one mesh, in its own frame."""

    rows: Rows
    area_m2: float
    covered: float
    """Share of the area that is proved to be covered."""
    parts: PartCounts
    warnings: tuple[str, ...]
    only_hulls: bool = False
    """Whether the parts' hulls are covered, closed ones as well; protrusion is that from the parts all the same."""


def cover_mesh(path: Path, scale: tuple[float, float, float], protrusion_m: float) -> MeshCover:
    """Spheres that cover the surface of a mesh and protrude no more than is allowed.

    Where that takes more than `MAX_SPHERES`, the parts' convex hulls are covered instead, if that takes fewer. Spheres
    in their hollows protrude further than is allowed; how far at most is in the result.

    Raises:
        FileError: for a file that is no mesh, or too large.
        InputError: without trimesh, and for a surface too large for spheres that protrude so little.
    """
    triangles, warnings = read_mesh(path, scale)
    own, parts = make_solid(triangles, convex_hull)
    try:
        cover = _cover_surface(own, parts, protrusion_m, warnings)
    except InputError as error:
        raise InputError("; ".join([*warnings, error.message])) from None
    if len(cover.rows.radii) <= MAX_SPHERES:
        return cover
    hulls, parts = make_solid(triangles, convex_hull, only_hulls=True)
    coarse = replace(_cover_surface(hulls, parts, protrusion_m, warnings), only_hulls=True)
    if len(coarse.rows.radii) >= len(cover.rows.radii):
        return cover
    out_m = bound_protrusion(own, coarse.rows.centres, coarse.rows.radii)
    return replace(coarse, rows=coarse.rows._replace(protrusion_m=out_m))


def _cover_surface(solid: Solid, parts: PartCounts, protrusion_m: float, warnings: tuple[str, ...]) -> MeshCover:
    rows = cover_solid(solid, protrusion_m)
    certificate = certify(solid.surface.corners, rows.centres, rows.radii)
    return MeshCover(rows, certificate.area_m2, certificate.covered, parts, warnings)


def cover_solid(solid: Solid, protrusion_m: float) -> Rows:
    """Spheres that cover the surface of a solid."""
    size = patch_size(float(solid.surface.areas.sum()), protrusion_m)
    patches = make_patches(solid.surface.corners, size)
    candidates = find_candidates(solid, patches, protrusion_m, MAX_INSIDE)
    covers = list(candidates.covers)
    while True:
        chosen = cover_greedily(covers, len(patches.centres))
        if len(chosen) <= 1.5 * MAX_SPHERES:
            chosen = improve(covers, chosen, candidates.centres, EXCHANGES)
        wrong = [index for index in chosen if _is_too_large(candidates, index, solid, protrusion_m)]
        if not wrong:
            rows = Rows(candidates.centres[chosen], candidates.radii[chosen], protrusion_m)
            return drop_needless(solid.surface.corners, size, rows) if len(chosen) <= MAX_SPHERES else rows
        for index in wrong:
            covers[index] = covers[index][:0]


def drop_needless(corners: Floats, size_m: float, rows: Rows) -> Rows:
    """Without spheres that the proof of the cover does without, smallest first: triangles are smaller than patches.

    A sphere that alone holds a corner of the surface's pieces is needed; only the others are worth a proof.

    Args:
        corners: triangles [T, 3, 3] in m, that the spheres cover by proof.
        size_m: of the pieces.
        rows: the spheres.
    """
    points = np.unique(split(corners, size_m)[0].reshape(-1, 3), axis=0)
    holds = np.stack([((points - c) ** 2).sum(axis=1) <= r * r for c, r in zip(rows.centres, rows.radii, strict=True)])
    keep = np.ones(len(rows.radii), dtype=np.bool_)
    for index in np.argsort(rows.radii, kind="stable"):
        keep[index] = False
        if not holds[keep].any(axis=0).all() or certify(corners, rows.centres[keep], rows.radii[keep]).covered < 1.0:
            keep[index] = True
    return Rows(rows.centres[keep], rows.radii[keep], rows.protrusion_m)


def bound_protrusion(solid: Solid, centres: Floats, radii: Floats) -> float:
    """How far spheres [S, 3] and [S] stand out of a solid at most, in m.

    The ball as large as a centre is deep lies in the solid, so the sphere stands out by the rest of its radius at most.
    """
    depths = [solid.depth(centre) for centre in centres]
    return max(0.0, float((radii - depths).max()))


def _is_too_large(candidates: Candidates, index: int, solid: Solid, protrusion_m: float) -> bool:
    """Whether a centre lies less deep than was counted along its line of the grid, by solid angles."""
    return candidates.radii[index] > solid.depth(candidates.centres[index]) + protrusion_m


def convex_hull(points: Floats) -> Floats | None:
    """The triangles [T, 3, 3] of the hull of points [N, 3]; None where they lie in a plane."""
    trimesh = import_trimesh()
    away = points - points.mean(axis=0)
    if len(points) < 4 or np.linalg.matrix_rank(away, tol=1e-6 * np.abs(away).max()) < 3:
        return None
    return np.array(trimesh.convex.convex_hull(points).triangles, dtype=np.float64)
