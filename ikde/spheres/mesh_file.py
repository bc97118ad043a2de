"""Files of meshes: STL, OBJ and DAE as triangles in m, read by trimesh (the extra `meshes`)."""

import io
from importlib import import_module
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from ikde.errors import FileError, InputError
from ikde.kernels.arrays import Floats

MAX_BYTES = 50_000_000
MAX_TRIANGLES = 500_000
LARGE_M = 20.0
"""A body beyond this is most likely given in mm."""
KINDS = {".stl": "stl", ".obj": "obj", ".dae": "dae"}
STL_HEADER, STL_TRIANGLE = 84, 50  # bytes
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
    trimesh = import_trimesh()
    kind = KINDS[path.suffix.lower()]
    unit_m = _read_unit(path, content) if kind == "dae" else 1.0
    options: Any = {"resolver": None, "process": False, "skip_materials": True}
    fault = _find_fault(kind, content)
    if fault:
        raise FileError(path, f"is no {kind.upper()} that can be read: {fault}")
    try:
        mesh = trimesh.load_scene(io.BytesIO(content), file_type=kind, **options).to_mesh()
        return np.array(mesh.triangles, dtype=np.float64) * unit_m
    except Exception as error:
        if isinstance(error, ImportError) and kind == "dae":  # trimesh reads it with packages of its own
            raise FileError(path, f"cannot be read: {error}; a DAE needs it, or give the mesh as STL or OBJ") from None
        raise FileError(
            path, f"is no {kind.upper()} that can be read: it is damaged, or of another kind than its ending"
        ) from None


def _find_fault(kind: str, content: bytes) -> str | None:
    """What is wrong with a mesh, as far as its length says."""
    if not content:
        return "it is empty"
    if kind == "stl" and not content.lstrip().startswith(b"solid"):
        if len(content) < STL_HEADER:
            return f"{len(content)} bytes are less than its header of {STL_HEADER}"
        count = int.from_bytes(content[STL_HEADER - 4 : STL_HEADER], "little")
        expected = STL_HEADER + STL_TRIANGLE * count
        if expected > len(content):
            return f"its header tells of {count:,} triangles, {expected:,} bytes, but it has {len(content):,}"
    return None


def _read_unit(path: Path, content: bytes) -> float:
    """How long a DAE's unit is in m; a DOCTYPE, which could name other files and grow without end, is refused."""
    if b"\0" in content or b"<!DOCTYPE" in content or b"<!ENTITY" in content:
        raise FileError(path, "expected COLLADA in UTF-8 without a DOCTYPE")
    try:
        unit = ElementTree.fromstring(content).find("{*}asset/{*}unit")
        unit_m = 1.0 if unit is None else float(unit.get("meter", "1"))
    except (ElementTree.ParseError, ValueError) as error:
        raise FileError(path, f"is no COLLADA that can be read ({type(error).__name__})") from None
    if not 0.0 < unit_m < 1e6:
        raise FileError(path, f"expected a unit of some m, got {unit_m:g}", ("asset", "unit"))
    return unit_m
