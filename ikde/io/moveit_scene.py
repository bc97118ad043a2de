"""MoveIt's planning scenes as worlds: box edges, [height, radius] of cylinders and cones, quaternions x, y, z, w.

What is not known is refused by name: a scene that is read in part would be called free where it is not.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ikde.errors import InputError, quoted
from ikde.formats.error_path import prefix_errors
from ikde.io.mesh_solids import make_inline_hull
from ikde.io.scene_values import (
    Frames,
    Reading,
    as_list,
    as_mapping,
    as_name,
    as_numbers,
    as_values,
    check_keys,
    compose,
    get,
    make_pose,
)
from ikde.kernels.arrays import Floats
from ikde.model.pack import pack_floats
from ikde.model.robot import WORLD
from ikde.model.rotation import rotation_with_z
from ikde.model.solids import IDENTITY, Solid, SolidKind, make_solid
from ikde.model.world import MAX_OBSTACLES, Attached, Obstacle, World, make_obstacle, make_world
from ikde.solver.cover_solid import cover_solids, refuse_endless

KINDS: dict[str, tuple[SolidKind, tuple[str, ...]]] = {  # with what their dimensions are
    "box": ("box", ("x", "y", "z")),
    "sphere": ("sphere", ("radius",)),
    "cylinder": ("cylinder", ("height", "radius")),
    "cone": ("cone", ("height", "radius")),
}
NUMBERED = {1: "box", 2: "sphere", 3: "cylinder", 4: "cone", 5: "prism"}
OBJECT = (
    *("id", "header", "pose", "type", "operation", "primitives", "primitive_poses", "meshes", "mesh_poses"),
    *("planes", "plane_poses", "subframe_names", "subframe_poses"),
)
SCENE = (
    *("name", "robot_state", "robot_model_name", "fixed_frame_transforms", "allowed_collision_matrix"),
    *("link_padding", "link_scale", "object_colors", "world", "is_diff"),
)
XYZ, XYZW, PLANE = ("x", "y", "z"), ("x", "y", "z", "w"), ("a", "b", "c", "d")
ADD = (0, "0", "add", "ADD", b"\0", "\0")


def is_moveit_scene(data: Mapping[str, Any]) -> bool:
    """True for keys that only planning scenes have."""
    return "collision_objects" in data or isinstance(data.get("world"), Mapping)


def read_moveit_scene(data: Mapping[str, Any], reading: Reading) -> World:
    """The world of a planning scene, or of its `world` alone.

    A `pose` of an object composes with those of its shapes. `header.frame_id` names a frame of the scene
    (`fixed_frame_transforms`, another object) or of the robot. Touching that the scene's matrix allows is ignored.
    """
    scene, where = (data, ("world",)) if "world" in data else ({"world": data}, ())
    check_keys(scene, SCENE)
    _refuse_unread(scene)
    with prefix_errors(*where):
        content = as_mapping(scene["world"])
        check_keys(content, ("collision_objects", "octomap"))
        if as_mapping(as_mapping(content.get("octomap")).get("octomap")).get("data"):
            raise InputError("an octomap is not read: give its occupied cells as a cloud", ("octomap",))
        with prefix_errors("collision_objects"):
            entries = _read_ids(as_list(content.get("collision_objects")))
    frames = Frames()
    _place_fixed_frames(frames, scene)
    with prefix_errors(*where, "collision_objects"):
        _place_objects(frames, entries)
    allowed = _read_allowed(as_mapping(scene.get("allowed_collision_matrix")), list(entries))
    obstacles = []
    for place, (name, entry) in enumerate(entries.items()):
        with prefix_errors(*where, "collision_objects", place):
            obstacles.append(_read_object(name, entry, frames, allowed.get(name, ()), reading))
    with prefix_errors("robot_state"):
        return make_world(obstacles, (), read_attached(as_mapping(scene.get("robot_state")), reading))


def read_attached(state: Mapping[str, Any], reading: Reading) -> tuple[Attached, ...]:
    """What a robot holds in a state."""
    found = []
    for place, value in enumerate(as_list(state.get("attached_collision_objects"))):
        with prefix_errors("attached_collision_objects", place):
            found.append(_read_attached(as_mapping(value), reading))
    return tuple(found)


def _read_attached(entry: Mapping[str, Any], reading: Reading) -> Attached:
    """An object whose poses are in the link that holds it; it may touch that, and `touch_links`."""
    check_keys(entry, ("link_name", "object", "touch_links", "detach_posture", "weight"))
    link, held = as_name(get(entry, "link_name")), as_mapping(get(entry, "object"))
    touch = tuple(as_name(name) for name in as_list(entry.get("touch_links")))
    with prefix_errors("object"):
        check_keys(held, OBJECT)
        frame = read_frame(held)
        if frame != link:
            message = f"expected poses in {quoted(link)}, which holds it, got them in {quoted(frame)}"
            raise InputError(message, ("header", "frame_id"))
        found = _read_object(as_name(get(held, "id")), held, Frames(), (), reading)
        refuse_endless(found.solids)
        spheres, out_m = cover_solids(found.solids)
        obstacle = replace(found, frame=WORLD, T_world_obstacle=IDENTITY)
    known = {"spheres": pack_floats(spheres), "protrusion_m": out_m, "may_touch": tuple(dict.fromkeys(touch))}
    return Attached(obstacle=obstacle, frame=link, T_frame_object=found.T_world_obstacle, **known)


def _refuse_unread(scene: Mapping[str, Any]) -> None:
    for key, value, neutral in (("link_padding", "padding", 0.0), ("link_scale", "scale", 1.0)):
        for place, entry in enumerate(as_list(scene.get(key))):
            if as_mapping(entry).get(value, neutral) != neutral:
                raise InputError(f"a link with a {value} of its own is not read: give margins", (key, place))


def _read_ids(objects: list[Any]) -> dict[str, Mapping[str, Any]]:
    if len(objects) > MAX_OBSTACLES:
        raise InputError(f"expected at most {MAX_OBSTACLES:,} objects, got {len(objects):,}")
    found: dict[str, Mapping[str, Any]] = {}
    for place, value in enumerate(objects):
        with prefix_errors(place):
            entry = as_mapping(value)
            check_keys(entry, OBJECT)
            with prefix_errors("id"):
                if entry.get("id") is None:
                    raise InputError("this key is missing")
                name = as_name(entry["id"])
                if name in found:
                    raise InputError(f"two objects are called {quoted(name)}")
            found[name] = entry
    return found


def _place_fixed_frames(frames: Frames, scene: Mapping[str, Any]) -> None:
    for place, value in enumerate(as_list(scene.get("fixed_frame_transforms"))):
        with prefix_errors("fixed_frame_transforms", place):
            entry = as_mapping(value)
            child, transform = as_name(get(entry, "child_frame_id")), as_mapping(get(entry, "transform"))
            with prefix_errors("transform"):
                T = read_pose(transform, ("translation", "rotation"))
            parent = read_frame(entry)
            if child != parent or not np.array_equal(T, IDENTITY):  # some say of a frame that it is where it is
                frames.add(child, parent, T)


def _place_objects(frames: Frames, entries: Mapping[str, Mapping[str, Any]]) -> None:
    """Objects are frames, too, if others are placed in them."""
    used = {read_frame(entry) for entry in entries.values()}
    for place, (name, entry) in enumerate(entries.items()):
        if name in used:
            with prefix_errors(place):
                frames.add(name, read_frame(entry), _read_own_pose(entry))


def read_frame(entry: Mapping[str, Any]) -> str:
    """Of a header; where there is none, the root of the robot."""
    with prefix_errors("header"):
        header = as_mapping(entry.get("header"))
        with prefix_errors("frame_id"):
            return as_name(header.get("frame_id") or WORLD).removeprefix("/") or WORLD


def _read_own_pose(entry: Mapping[str, Any]) -> Floats:
    with prefix_errors("pose"):
        return read_pose(as_mapping(entry.get("pose")))


def _read_object(
    name: str, entry: Mapping[str, Any], frames: Frames, ignore: tuple[str, ...], reading: Reading
) -> Obstacle:
    if entry.get("operation", 0) not in ADD:
        raise InputError(f"expected an object that is added, got {quoted(entry['operation'])}", ("operation",))
    solids = []
    readers = {"primitives": "primitive_poses", "planes": "plane_poses", "meshes": "mesh_poses"}
    for key, poses_key in readers.items():
        shapes, poses = as_list(entry.get(key)), as_list(entry.get(poses_key))
        if not poses and len(shapes) == 1:
            poses = [{}]
        if len(shapes) != len(poses):
            raise InputError(f"expected {len(shapes)} poses, one a shape, got {len(poses)}", (poses_key,))
        for place, (shape, pose) in enumerate(zip(shapes, poses, strict=True)):
            with prefix_errors(poses_key, place):
                T = read_pose(pose)
            with prefix_errors(key, place):
                solids.append(_read_shape(key, as_mapping(shape), T, reading))
    with prefix_errors("header", "frame_id"):
        frame, T_frame_header = frames.resolve(read_frame(entry))
    if not solids:
        raise InputError("this object has no shape", ("primitives",))
    return make_obstacle(name, solids, compose(T_frame_header, _read_own_pose(entry)), frame=frame, ignore=ignore)


def _read_shape(key: str, shape: Mapping[str, Any], T: Floats, reading: Reading) -> Solid:
    if key == "planes":
        return _read_plane(shape, T, reading)
    if key == "meshes":
        return _read_mesh(shape, T, reading)
    check_keys(shape, ("type", "dimensions", "polygon"))
    given = get(shape, "type")
    word = NUMBERED.get(given, given) if isinstance(given, int) and not isinstance(given, bool) else given
    kind, names = KINDS.get(word.lower(), (None, ())) if isinstance(word, str) else (None, ())
    if kind is None:
        raise InputError(f"expected a type of {', '.join(KINDS)}, got {quoted(word)}", ("type",))
    dimensions = get(shape, "dimensions")
    with prefix_errors("dimensions"):
        sizes = as_numbers(dimensions, names)
        return make_solid(kind, sizes[::-1] if names == ("height", "radius") else sizes, T)


def _read_plane(shape: Mapping[str, Any], T: Floats, reading: Reading) -> Solid:
    """A x + b y + c z + d = 0, as all that lies below it: a robot that is through it has touched it."""
    coef = get(shape, "coef")
    with prefix_errors("coef"):
        *normal, d = as_numbers(coef, PLANE)
        size = float(np.linalg.norm(normal))
        if not size > 1e-9:
            raise InputError("expected a normal that is not zero")
    own = np.eye(4)[:3]
    unit = np.array(normal) / size
    own[:, :3], own[:, 3] = rotation_with_z(unit), -d / size * unit
    reading.note("a plane is read as all that lies below it, where its normal does not point")
    return make_solid("half_space", (), compose(T, own))


def _read_mesh(shape: Mapping[str, Any], T: Floats, reading: Reading) -> Solid:
    if shape.get("vertices") is None:
        raise InputError("a mesh that another file holds is not read: give its vertices, or a world file with `mesh`")
    check_keys(shape, ("triangles", "vertices"))
    faces = [as_values(face, "vertex_indices") for face in as_list(shape.get("triangles"))]
    solid = make_inline_hull(shape["vertices"], faces, np.ones(3), reading)
    return make_solid("hull", (), T, solid.points)


def read_pose(entry: Any, keys: tuple[str, str] = ("position", "orientation")) -> Floats:
    """A pose as [x, y, z] and [qx, qy, qz, qw], or with their names; what is not given is the identity."""
    parts = as_mapping(entry)
    check_keys(parts, keys)
    place, quat = (parts.get(key) for key in keys)
    with prefix_errors(keys[0]):
        p = np.zeros(3) if place is None else as_numbers(place, XYZ)
    with prefix_errors(keys[1]):
        return make_pose(p, np.array([1.0, 0, 0, 0]) if quat is None else as_numbers(quat, XYZW)[[3, 0, 1, 2]])


def _read_allowed(matrix: Mapping[str, Any], objects: list[str]) -> dict[str, tuple[str, ...]]:
    """Which links of the robot may touch which objects."""
    with prefix_errors("allowed_collision_matrix"):
        names = [as_name(name) for name in as_list(matrix.get("entry_names"))]
        rows = [as_list(as_values(row, "enabled")) for row in as_list(matrix.get("entry_values"))]
        if len(rows) != len(names) or any(len(row) != len(names) for row in rows):
            raise InputError(f"expected {len(names)} rows of as many values", ("entry_values",))
        values = as_list(matrix.get("default_entry_values"))
        for place, name in enumerate(as_list(matrix.get("default_entry_names"))):
            if name in objects and any(values[place : place + 1]):
                raise InputError("an object that may touch all by default is not read", ("default_entry_names", place))
    known, found = set(objects), {}
    for name, row in zip(names, rows, strict=True):
        if name in known:
            found[name] = tuple(n for n, may in zip(names, row, strict=True) if may is True and n not in known)
    return found
