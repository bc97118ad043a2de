"""CuRobo's scenes as worlds: kinds of obstacles, each by name; poses are x, y, z, then the quaternion w, x, y, z.

What is not known is refused by name: a scene that is read in part would be called free where it is not.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ikde.errors import InputError, nearest, quoted
from ikde.formats.error_path import prefix_errors
from ikde.io.mesh_solids import make_inline_hull, read_mesh_hulls
from ikde.io.scene_values import Reading, as_mapping, as_number, as_numbers, check_keys, get, make_pose, prefixed
from ikde.kernels.arrays import Floats
from ikde.model.rotation import rotation_with_z
from ikde.model.solids import Solid, make_solid
from ikde.model.world import Obstacle, World, make_obstacle, make_world

KINDS = ("cuboid", "sphere", "capsule", "cylinder", "mesh")
UNREAD = ("blox", "voxel")
XYZ, POSE = ("x", "y", "z"), ("x", "y", "z", "qw", "qx", "qy", "qz")
LOOKS = ("name", "color", "texture", "texture_id", "material", "vertex_colors", "vertex_normals", "face_colors")
KEYS = {
    "cuboid": ("dims",),
    "sphere": ("radius", "position"),
    "capsule": ("radius", "base", "tip"),
    "cylinder": ("radius", "height"),
    "mesh": ("file_path", "vertices", "faces", "urdf_path"),
}


def is_curobo_scene(data: Mapping[str, Any]) -> bool:
    """True for keys that only cuRobo's scenes have."""
    return any(key in (*KINDS, *UNREAD) for key in data)


def read_curobo_scene(data: Mapping[str, Any], reading: Reading) -> World:
    """The world of a scene; raises `InputError` with the key that is wrong."""
    obstacles: dict[str, Obstacle] = {}
    for kind, entries in data.items():
        with prefix_errors(kind):
            if kind not in KINDS:
                known = ", ".join(KINDS)
                raise InputError(f"this kind is not read{nearest(kind, KINDS)}; expected some of {known}")
            for name, entry in as_mapping(entries).items():
                with prefix_errors(name):
                    if name in obstacles:
                        raise InputError(f"two obstacles are called {name!r}")
                    obstacles[name] = _read_obstacle(kind, name, as_mapping(entry), reading)
    return make_world(obstacles.values())


def _read_obstacle(kind: str, name: str, entry: Mapping[str, Any], reading: Reading) -> Obstacle:
    check_keys(entry, (*KEYS[kind], "pose", "scale", *LOOKS))
    if kind == "sphere" and entry.get("pose") is None and entry.get("position") is not None:
        T = make_pose(prefixed(("position",), entry["position"], XYZ), np.array([1.0, 0.0, 0.0, 0.0]))
    else:
        with prefix_errors("pose"):
            pose = as_numbers(get_pose(entry), POSE)
            T = make_pose(pose[:3], pose[3:])
    scale = _read_scale(entry.get("scale"))
    if kind != "mesh" and not (scale == 1.0).all():
        raise InputError("only meshes are scaled", ("scale",))
    return make_obstacle(name, _read_solids(kind, entry, scale, reading), T)


def get_pose(entry: Mapping[str, Any]) -> Any:
    """The pose that is given, or that of the world's frame."""
    given = entry.get("pose")
    return [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0] if given is None else given


def _read_scale(value: Any) -> Floats:
    if value is None:
        return np.ones(3)
    return prefixed(("scale",), value if isinstance(value, list) else [value] * 3, XYZ)


def _read_solids(kind: str, entry: Mapping[str, Any], scale: Floats, reading: Reading) -> list[Solid]:
    if kind == "mesh":
        return _read_mesh(entry, scale, reading)
    if kind == "cuboid":
        sizes = prefixed(("dims",), get(entry, "dims"), XYZ)
        with prefix_errors("dims"):
            return [make_solid("box", sizes)]
    radius = _read_number(entry, "radius")
    if kind == "sphere":
        return [make_solid("sphere", [radius])]
    if kind == "cylinder":
        return [make_solid("cylinder", [radius, _read_number(entry, "height")])]
    base, tip = (prefixed((key,), get(entry, key), XYZ) for key in ("base", "tip"))
    line = tip - base
    height = float(np.linalg.norm(line))
    T = np.eye(4)[:3]
    T[:, 3] = 0.5 * (base + tip)
    if height == 0.0:
        raise InputError("expected a tip that is not the base: that is a sphere", ("tip",))
    T[:, :3] = rotation_with_z(line / height)
    return [make_solid("capsule", [radius, height], T)]


def _read_number(entry: Mapping[str, Any], key: str) -> float:
    value = get(entry, key)
    with prefix_errors(key):
        return as_number(value)


def _read_mesh(entry: Mapping[str, Any], scale: Floats, reading: Reading) -> list[Solid]:
    path, vertices = entry.get("file_path"), entry.get("vertices")
    if (path is None) == (vertices is None):
        raise InputError("expected one of file_path and vertices")
    if vertices is not None:
        return [make_inline_hull(vertices, entry.get("faces"), scale, reading)]
    if not isinstance(path, str):
        raise InputError(f"expected the path of a mesh, got {quoted(path)}", ("file_path",))
    with prefix_errors("file_path"):
        return read_mesh_hulls(path, scale, np.eye(4)[:3], reading)
