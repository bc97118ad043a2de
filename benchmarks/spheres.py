"""Spheres for meshes, ours beside MorphIt and a plain grid: how many, at equal protrusion, once all is covered.

Needs `pip install 'ikde[meshes]' morphit-rs example-robot-data`. Run: python benchmarks/spheres.py ROBOTS_FOLDER

The others' spheres leave parts of the surface bare. Their radii are grown by the largest gap, measured at 20,000 points
of the surface, which says less than a proof; then their protrusion is measured at points of their spheres. MorphIt is
asked for ever more spheres until it protrudes no more than ours may; the grid gets ever finer cells, one sphere
around each cell that holds some of the body.
"""

import time
from argparse import ArgumentParser
from collections.abc import Callable, Iterator
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.spheres.candidates import grid_inside
from ikde.spheres.cover_mesh import convex_hull, cover_mesh
from ikde.spheres.mesh_file import read_mesh
from ikde.spheres.parts import make_solid
from ikde.spheres.solid import Solid

URDFS = {
    "UR5": "ur_description/urdf/ur5_robot.urdf",
    "Panda": "panda_description/urdf/panda.urdf",
    "TIAGo": "tiago_description/robots/tiago.urdf",
}
FIRST = 20
"""Collision meshes of each robot, by path."""
COUNTS = (1, 2, 4, 6, 8, 10, 13, 16, 20, 25, 32, 40, 50, 64, 80, 100, 128, 160, 200)
CELLS = range(1, 40)
POINTS = 20_000

Spheres = tuple[Floats, Floats]
"""Centres [S, 3] and radii [S] in m."""


def sample(solid: Solid) -> Floats:
    """Points [.., 3] of the surface: random ones, evenly by area, and all corners."""
    draw = np.random.default_rng(0)
    corners, areas = solid.surface.corners, solid.surface.areas
    a, b, c = np.moveaxis(corners[draw.choice(len(corners), POINTS, p=areas / areas.sum())], 1, 0)
    u, v = np.sqrt(draw.random((POINTS, 1))), draw.random((POINTS, 1))
    return np.concatenate([(1 - u) * a + u * (1 - v) * b + u * v * c, corners.reshape(-1, 3)])


def grow(points: Floats, spheres: Spheres) -> Spheres:
    """All radii larger by the largest gap."""
    centres, radii = spheres
    gaps = np.full(len(points), np.inf)
    for centre, radius in zip(centres, radii, strict=True):
        gaps = np.minimum(gaps, np.sqrt(((points - centre) ** 2).sum(axis=1)) - radius)
    return centres, radii + max(0.0, float(gaps.max()))


def protrudes(solid: Solid, spheres: Spheres, most_m: float) -> bool:
    """Whether one of 60 points of each sphere is farther from the body than allowed; more points would find more."""
    ways = np.random.default_rng(1).normal(size=(60, 3))
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    centres, radii = spheres
    deepest = np.array([solid.depth(centre) for centre in centres])
    for index in np.argsort(deepest - radii):
        if radii[index] - deepest[index] <= most_m:  # its ball inside leaves too little for that, and so do all others'
            return False
        if any(solid.depth(point) < -most_m for point in centres[index] + radii[index] * ways):
            return True
    return False


def morphit(solid: Solid) -> Iterator[Spheres]:
    """MorphIt's balanced preset with ever more spheres."""
    import morphit_rs

    corners = solid.surface.corners.reshape(-1, 3)
    points, faces = np.unique(corners, axis=0, return_inverse=True)
    mesh = morphit_rs.Mesh.from_arrays(points, faces.reshape(-1, 3))
    for count in COUNTS:
        found = morphit_rs.pack(mesh, morphit_rs.Config.preset("MorphIt-B", num_spheres=count, seed=1))
        yield np.asarray(found.centers, dtype=np.float64), np.asarray(found.radii, dtype=np.float64)


def grid(solid: Solid) -> Iterator[Spheres]:
    """Cells of a grid over the body's box, as even as they can be, one sphere around each that holds some of it."""
    points = np.concatenate([sample(solid), grid_inside(solid, 0.02, 6_000)])
    low, size = points.min(axis=0), np.ptp(points, axis=0)
    for longest in CELLS:
        counts = np.maximum(np.ceil(longest * size / size.max() - 1e-9), 1).astype(int)
        cells = np.unique(np.minimum((points - low) / size * counts, counts - 1).astype(int), axis=0)
        yield low + (cells + 0.5) * size / counts, np.full(len(cells), 0.5 * float(np.linalg.norm(size / counts)))


def fewest(solid: Solid, tries: Callable[[Solid], Iterator[Spheres]], most_m: float) -> str:
    """How many spheres the first try takes that protrudes no more, once grown."""
    points = sample(solid)
    for spheres in tries(solid):
        grown = grow(points, spheres)
        if not protrudes(solid, grown, most_m):
            return str(len(grown[1]))
    return "none"


def list_meshes(folder: Path, urdf: str) -> list[Path]:
    """The first collision meshes of a robot, by path; `package://example-robot-data/robots` is the folder."""
    elements = ElementTree.parse(folder / urdf).getroot().iterfind("link/collision/geometry/mesh")
    names = {element.get("filename", "").partition("example-robot-data/robots/")[2] for element in elements}
    return [folder / name for name in sorted(names)][:FIRST]


def main() -> None:
    """Print one line a mesh."""
    arguments = ArgumentParser(description=__doc__)
    arguments.add_argument("folder", type=Path, help="example-robot-data's `robots`")
    arguments.add_argument("--protrusion", type=float, default=20.0, metavar="MM")
    arguments.add_argument("--robots", nargs="+", default=list(URDFS), choices=list(URDFS))
    arguments.add_argument("--alone", action="store_true", help="ours alone")
    asked = arguments.parse_args()
    most_m = asked.protrusion / 1e3
    print("| mesh | proved, % | at most out, mm | CPU s | ours | MorphIt | grid |\n|---|---|---|---|---|---|---|")
    for robot in asked.robots:
        for path in list_meshes(asked.folder, URDFS[robot]):
            start = time.process_time()
            cover = cover_mesh(path, (1.0, 1.0, 1.0), most_m)
            spent = time.process_time() - start
            solid, _ = make_solid(read_mesh(path)[0], convex_hull, only_hulls=cover.only_hulls)
            tries = () if asked.alone else (morphit, grid)
            counts = [str(len(cover.rows.radii)), *(fewest(solid, own, most_m) for own in tries)]
            hull = ", hulls" if cover.only_hulls else ""
            figures = [f"{100 * cover.covered:.5g}", f"{1e3 * cover.rows.protrusion_m:.3g}", f"{spent:.1f}"]
            print(f"| {robot} {path.stem}{hull} | {' | '.join([*figures, *counts])} |", flush=True)


if __name__ == "__main__":
    main()
