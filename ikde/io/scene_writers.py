"""Worlds as scenes of MoveIt and cuRobo, and what those cannot hold."""

from collections.abc import Callable, Iterable
from typing import Any

from ikde.io.scene_values import compose
from ikde.io.world_writer import WorldText, format_world_file
from ikde.io.yaml_text import format_flow
from ikde.kernels.arrays import Floats
from ikde.model.robot import WORLD
from ikde.model.rotation import quat_wxyz_from_rotation
from ikde.model.solids import Solid
from ikde.model.world import Obstacle, World

Entry = dict[str, Any]

NAMES = {"half_space": "half-space", "cloud": "cloud of points", "hull": "hull"}


def format_moveit_scene(world: World) -> WorldText:
    """A planning scene: boxes, spheres, cylinders and cones; hulls as meshes, half-spaces as planes."""
    lost = _list_lost(world)
    lines = ["world:", "  collision_objects:"]
    for obstacle in world.active:
        primitives, planes, meshes = [], [], []
        for solid in obstacle.solids:
            pose = _moveit_pose(solid.T_obstacle_solid)
            if solid.kind == "half_space":
                planes.append(({"coef": [0.0, 0.0, 1.0, 0.0]}, pose))
                lost.append(f"{obstacle.name}: a half-space is a plane in MoveIt, with room below it")
            elif solid.kind == "hull":
                meshes.append((_moveit_mesh(solid), pose))
            elif solid.kind in ("capsule", "cloud"):
                lost.append(_say_lost(obstacle, solid, "MoveIt"))
            else:
                primitives.append((_moveit_primitive(solid), pose))
        if not (primitives or planes or meshes):
            continue
        lines.append(f"    - id: {format_flow(obstacle.name)}")
        if obstacle.frame != WORLD:
            lines.append(f"      header: {format_flow({'frame_id': obstacle.frame})}")
        lines.append(f"      pose: {format_flow(_moveit_pose(obstacle.T_world_obstacle))}")
        listed = (("primitives", "primitive_poses", primitives), ("planes", "plane_poses", planes))
        for key, poses_key, found in (*listed, ("meshes", "mesh_poses", meshes)):
            if found:
                lines += [f"      {key}:", *(f"        - {format_flow(shape)}" for shape, _ in found)]
                lines += [f"      {poses_key}:", *(f"        - {format_flow(pose)}" for _, pose in found)]
    if lines[-1].endswith("collision_objects:"):
        lines[-1] += " []"
    return WorldText(text="\n".join(lines) + "\n", lost=tuple(dict.fromkeys(lost)))


def format_curobo_scene(world: World) -> WorldText:
    """A cuRobo scene: cuboids, spheres, capsules and cylinders; hulls as meshes. Each solid has a name of its own."""
    lost, kinds = _list_lost(world), {"cuboid": {}, "sphere": {}, "capsule": {}, "cylinder": {}, "mesh": {}}
    taken = set(world.names)
    for obstacle in world.active:
        if obstacle.frame != WORLD:
            lost.append(f"{obstacle.name}: left out, its frame {obstacle.frame} is one of the robot")
            continue
        for solid in obstacle.solids:
            kind, entry = _curobo_entry(solid)
            if kind is None:
                lost.append(_say_lost(obstacle, solid, "cuRobo"))
                continue
            T = compose(obstacle.T_world_obstacle, solid.T_obstacle_solid)
            pose = [*T[:, 3].tolist(), *quat_wxyz_from_rotation(T[:, :3]).tolist()]
            kinds[kind][_name_part(obstacle, taken)] = {**entry, "pose": pose}
    lines = []
    for kind, entries in kinds.items():
        lines += [f"{kind}:", *(f"  {format_flow(n)}: {format_flow(e)}" for n, e in entries.items())] if entries else []
    return WorldText(text="\n".join(lines or ["cuboid: {}"]) + "\n", lost=tuple(dict.fromkeys(lost)))


def _list_lost(world: World) -> list[str]:
    """What neither format holds."""
    lost = [f"{o.name}: left out, group {o.group} is off" for o in world.obstacles if o.group in world.switched_off]
    lost += [f"{o.name}: its margin of {o.margin_m * 1e3:g} mm" for o in world.active if o.margin_m]
    lost += [f"{thing.name}: left out, it is attached to {thing.frame}" for thing in world.attached]
    return lost + [f"{o.name}: what ignores it ({', '.join(o.ignore)})" for o in world.active if o.ignore]


def _say_lost(obstacle: Obstacle, solid: Solid, program: str) -> str:
    return f"{obstacle.name}: {program} has no {NAMES.get(solid.kind, solid.kind)}"


def _moveit_primitive(solid: Solid) -> Entry:
    sizes = list(solid.size_m)
    return {"type": solid.kind, "dimensions": sizes[::-1] if solid.kind in ("cylinder", "cone") else sizes}


def _moveit_mesh(solid: Solid) -> Entry:
    assert solid.points is not None
    assert solid.triangles is not None
    faces = [{"vertex_indices": face} for face in solid.triangles.tolist()]
    return {"vertices": [dict(zip("xyz", p, strict=True)) for p in solid.points.tolist()], "triangles": faces}


def _moveit_pose(T: Floats) -> Entry:
    quat = quat_wxyz_from_rotation(T[:, :3])[[1, 2, 3, 0]]
    return {"position": T[:, 3].tolist(), "orientation": quat.tolist()}


def _curobo_entry(solid: Solid) -> tuple[str | None, Entry]:
    match solid.kind:
        case "box":
            return "cuboid", {"dims": list(solid.size_m)}
        case "sphere":
            return "sphere", {"radius": solid.size_m[0]}
        case "cylinder":
            return "cylinder", dict(zip(("radius", "height"), solid.size_m, strict=True))
        case "capsule":
            half = 0.5 * solid.size_m[1]
            return "capsule", {"radius": solid.size_m[0], "base": [0.0, 0.0, -half], "tip": [0.0, 0.0, half]}
        case "hull":
            assert solid.points is not None
            assert solid.triangles is not None
            return "mesh", {"vertices": solid.points.tolist(), "faces": solid.triangles.tolist()}
    return None, {}


def _name_part(obstacle: Obstacle, taken: set[str]) -> str:
    """The obstacle's name, or, of several solids, one with a number that no other has."""
    if len(obstacle.solids) == 1:
        return obstacle.name
    number = 1
    while f"{obstacle.name}_{number}" in taken:
        number += 1
    taken.add(f"{obstacle.name}_{number}")
    return f"{obstacle.name}_{number}"


FORMATS: dict[str, Callable[[World, str, Iterable[str]], WorldText]] = {
    "ikde": format_world_file,
    "moveit": lambda world, stem, notes: format_moveit_scene(world),
    "curobo": lambda world, stem, notes: format_curobo_scene(world),
}
