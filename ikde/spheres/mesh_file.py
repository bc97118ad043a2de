"""Files of meshes: STL, OBJ and, by trimesh (the extra `meshes`), DAE as triangles in m."""

import io
from importlib import import_module
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from ikde.errors import FileError, InputError, quoted
from ikde.kernels.arrays import Floats
from ikde.spheres.collada import count_triangles
from ikde.spheres.mesh_text import read_obj, read_text_stl

MAX_BYTES = 50_000_000
MAX_TRIANGLES = 500_000
LARGE_M = 20.0
"""A body beyond this is most likely given in mm."""
KINDS = {".stl": "stl", ".obj": "obj", ".dae": "dae"}
STL_HEADER = 84  # bytes
STL_TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])
MISSING = "meshes need trimesh: pip install 'ikde[meshes]'"


def read_mesh(path: Path, scale: tuple[float, float, float] = (1.0, 1.0, 1.0)) -> tuple[Floats, tuple[str, ...]]:
    """The triangles [T, 3, 3] of a mesh in m, outer sides as the file has them, and what is odd about them.

    Only the file itself is read, no materials or textures that it names. DAE: its unit counts, its up axis does not, as
    in ROS.

    Args:
        path: an STL (binary or text), OBJ or DAE file.
        scale: of its coordinates, to m; where it mirrors, the order of each triangle's corners is reversed.

    Raises:
        FileError: for what is no mesh of this kind, is too large, is empty, or holds numbers that are not finite.
        InputError: if trimesh is not installed.
    """
    content = _read_whole(path)
    triangles = _parse(path, content) * np.asarray(scale, dtype=np.float64)
    if len(triangles) > MAX_TRIANGLES:
        raise FileError(path, f"expected at most {MAX_TRIANGLES:,} triangles, got {len(triangles):,}")
    if not np.isfinite(triangles).all():
        raise FileError(path, "expected finite coordinates, got NaN or infinity")
    size = float(np.ptp(triangles.reshape(-1, 3), axis=0).max()) if len(triangles) else 0.0
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    if not (normals != 0.0).any():
        raise FileError(path, f"expected a surface, got {len(triangles)} triangles without area")
    if size > 1e6:
        raise FileError(path, f"expected a body of at most 1,000 km, got {size:.3g} m")
    warnings = (f"{path.name} is {size:.4g} m large; if it is given in mm, use --mesh-scale 0.001",)
    return (triangles[:, ::-1] if np.prod(scale) < 0.0 else triangles), warnings if size > LARGE_M else ()


def import_trimesh() -> Any:
    """trimesh, or one line on how to get it."""
    try:
        return import_module("trimesh")
    except ImportError:
        raise InputError(MISSING) from None


def _read_whole(path: Path) -> bytes:
    if path.suffix.lower() not in KINDS:
        raise FileError(path, f"expected a mesh with the ending {', '.join(KINDS)}")
    try:
        if not path.is_file():
            raise FileError(path, "no such file")
        size = path.stat().st_size
        if size > MAX_BYTES:
            raise FileError(path, f"expected at most {MAX_BYTES // 10**6} MB, got {size / 1e6:.0f} MB")
        return path.read_bytes()
    except OSError as error:
        raise FileError(path, f"cannot be read: {error.strerror}") from None


def _parse(path: Path, content: bytes) -> Floats:
    kind = KINDS[path.suffix.lower()]
    import_trimesh()  # for hulls: without it nothing is read
    if not content:
        raise FileError(path, f"is no {kind.upper()} that can be read: it is empty")
    if kind == "dae":
        return _read_dae(path, content)
    if kind == "obj":
        return read_obj(path, content.decode("utf-8", "replace"))
    return _read_stl(path, content)


def _read_stl(path: Path, content: bytes) -> Floats:
    """Of an STL that is binary, as its length says, or of text."""
    count = int.from_bytes(content[STL_HEADER - 4 : STL_HEADER], "little")
    expected = STL_HEADER + STL_TRIANGLE.itemsize * count
    is_text = b"\0" not in content and content.lstrip()[:5].lower() == b"solid"
    if len(content) != expected and is_text:
        return read_text_stl(path, content.decode("utf-8", "replace"))
    if len(content) < STL_HEADER:
        fault = f"{len(content)} bytes are less than its header of {STL_HEADER}"
        raise FileError(path, f"is no STL that can be read: {fault}")
    if len(content) != expected:
        fault = f"its header tells of {count:,} triangles, {expected:,} bytes, but it has {len(content):,}"
        raise FileError(path, f"is no STL that can be read: {fault}")
    return np.frombuffer(content, STL_TRIANGLE, offset=STL_HEADER)["corners"].astype(np.float64)


def _read_dae(path: Path, content: bytes) -> Floats:
    """Of a DAE: all that its scene shows, or nothing."""
    unit_m, expected = _look_into(path, content)
    options: Any = {"resolver": None, "process": False, "skip_materials": True}
    try:
        mesh = import_trimesh().load_scene(io.BytesIO(content), file_type="dae", **options).to_mesh()
        triangles = np.array(mesh.triangles, dtype=np.float64).reshape(-1, 3, 3) * unit_m
    except ImportError as error:  # trimesh reads it with packages of its own
        raise FileError(path, f"cannot be read: {error}; a DAE needs it, or give the mesh as STL or OBJ") from None
    except Exception:
        message = "is no DAE that can be read: it is damaged, or of another kind than its ending"
        raise FileError(path, message) from None
    if len(triangles) != expected:
        raise FileError(path, f"of its {expected:,} triangles {len(triangles):,} can be read; give it as STL or OBJ")
    return triangles


def _look_into(path: Path, content: bytes) -> tuple[float, int]:
    """How long a DAE's unit is in m, and how many triangles it shows.

    A DOCTYPE, which could name other files and grow without end, is refused.
    """
    if b"\0" in content or b"<!DOCTYPE" in content or b"<!ENTITY" in content:
        raise FileError(path, "expected COLLADA in UTF-8 without a DOCTYPE")
    try:
        root = ElementTree.fromstring(content)
    except (ElementTree.ParseError, ValueError, LookupError, RecursionError) as error:
        raise FileError(path, f"is no COLLADA that can be read ({type(error).__name__})") from None
    unit = root.find("{*}asset/{*}unit")
    given = "1" if unit is None else unit.get("meter", "1")
    try:
        unit_m = float(given)
    except ValueError:
        unit_m = 0.0
    if not 0.0 < unit_m < 1e6:
        raise FileError(path, f"expected a unit of some m, got {quoted(given)}", ("asset", "unit"))
    try:
        count = count_triangles(root)
    except ValueError as error:
        raise FileError(path, f"is no DAE that can be read: {error}; give the mesh as STL or OBJ") from None
    if count > MAX_TRIANGLES:
        raise FileError(path, f"expected at most {MAX_TRIANGLES:,} triangles, got {count:,}")
    return unit_m, count
