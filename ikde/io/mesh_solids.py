"""Meshes as obstacles: a convex hull of each closed part, and one of all that is open; said where that is more."""

from pathlib import Path
from typing import Any

import numpy as np

from ikde.errors import FileError, InputError
from ikde.formats.error_path import prefix_errors
from ikde.io.cloud_file import find_inside
from ikde.io.scene_values import Reading, as_list, as_numbers
from ikde.kernels.arrays import Floats, Ints
from ikde.model.hull import make_hull
from ikde.model.solids import MAX_HULL_POINTS, Solid, make_solid
from ikde.spheres.mesh_file import KINDS, read_mesh
from ikde.spheres.parts import connect, is_closed, merge_corners

MAX_TRIANGLES = 2_000_000  # of all meshes of a world together
MAX_PARTS = 1_000
SAME_VOLUME = 1e-3  # share by which a hull may be larger than its mesh before that is said
XYZ = ("x", "y", "z")


def read_mesh_hulls(name: str, scale: Floats, T: Floats, reading: Reading) -> list[Solid]:
    """Hulls, each in a pose `T` [3, 4], of a mesh file inside the reading's folder; `scale` [3] to m.

    Raises:
        InputError: for a path that leads out of the folder.
        FileError: for what is no mesh, too large, too round, or encloses no volume.
    """
    path = find_inside(reading.folder, name)
    if path.suffix.lower() not in KINDS:
        raise InputError(f"expected a mesh that ends in {', '.join(KINDS)}, got {name!r}")
    if not (np.abs(scale) > 0.0).all():
        raise InputError("expected a scale that is not 0")
    triangles, warnings = read_mesh(path, (float(scale[0]), float(scale[1]), float(scale[2])))
    reading.mesh_triangles += len(triangles)
    if reading.mesh_triangles > MAX_TRIANGLES:
        raise InputError(f"expected at most {MAX_TRIANGLES:,} triangles in all meshes together")
    for warning in warnings:
        reading.note(warning.partition(";")[0])
    corners, faces = merge_corners(triangles)
    try:
        return _make_hulls(corners, faces, T, path.name, reading)
    except InputError as error:
        raise FileError(path, error.message) from None


def make_inline_hull(vertices: Any, faces: Any, scale: Floats, reading: Reading) -> Solid:
    """The hull of vertices that stand in a file itself, with their faces, [F, 3] or end to end, if there are any."""
    with prefix_errors("vertices"):
        rows = as_list(vertices)
        if len(rows) > MAX_HULL_POINTS:
            raise InputError(f"expected at most {MAX_HULL_POINTS:,} points, got {len(rows):,}")
        points = np.array([_read_point(row, place) for place, row in enumerate(rows)]).reshape(-1, 3) * scale
        solid = make_solid("hull", (), None, points)
    with prefix_errors("faces"):
        corners = _read_faces(as_list(faces), len(points))
    _compare(points, corners, solid, "a mesh", reading)
    return solid


def _read_point(row: Any, place: int) -> Floats:
    with prefix_errors(place):
        return as_numbers(row, XYZ)


def _read_faces(faces: list[Any], count: int) -> Ints:
    flat = [index for face in faces for index in (face if isinstance(face, list) else [face])]
    if not all(isinstance(index, int) and 0 <= index < count for index in flat) or len(flat) % 3:
        raise InputError(f"expected triangles by the numbers of their vertices, 0 to {count - 1}")
    return np.array(flat, dtype=np.int64).reshape(-1, 3)


def _make_hulls(corners: Floats, faces: Ints, T: Floats, name: str, reading: Reading) -> list[Solid]:
    """Of each closed part, and of all open ones together."""
    part = connect(faces)
    parts = [faces[part == index] for index in range(min(int(part.max()) + 1, MAX_PARTS + 1))]
    if len(parts) > MAX_PARTS:
        if all(is_closed(own) for own in parts):
            raise InputError(f"expected a mesh of at most {MAX_PARTS:,} parts")
        parts = [faces]  # a heap of triangles
    still_open = [own for own in parts if not is_closed(own)]
    parts = [own for own in parts if is_closed(own)] + ([np.concatenate(still_open)] if still_open else [])
    found = []
    for own in parts:
        found.append(make_solid("hull", (), T, make_hull(corners[np.unique(own)])[0]))
        _compare(corners, own, found[-1], name, reading)
    return found


def _compare(points: Floats, faces: Ints, solid: Solid, name: str, reading: Reading) -> None:
    """Say how much larger the hull of a closed part is."""
    if not len(faces) or not is_closed(faces):
        reading.note(f"{name} is not closed: its convex hull is taken")
        return
    assert solid.points is not None
    assert solid.triangles is not None
    own, hull = measure_volume(points, faces), measure_volume(solid.points, solid.triangles)
    if hull > (1.0 + SAME_VOLUME) * abs(own):
        share = f"{hull / abs(own):.2f} times its volume" if own else "without a volume of its own"
        reading.note(f"{name} is not convex: its convex hull is taken, {share}")


def measure_volume(points: Floats, faces: Ints) -> float:
    """In m3, of a closed surface of triangles [F, 3] between points [V, 3] m, outer sides counter-clockwise."""
    a, b, c = (points[faces[:, k]] - points[faces[0, 0]] for k in range(3))
    return float(np.einsum("fi,fi->", a, np.cross(b, c))) / 6.0


def find_unit(path: str) -> bool:
    """True for meshes that say their unit themselves."""
    return Path(path).suffix.lower() == ".dae"
