"""Worlds as files: ikde's own, which hold all of them to the bit, and scenes of MoveIt and cuRobo."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from io import BytesIO
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from ikde.errors import InputError, printable, quoted
from ikde.formats.atomic import write_named
from ikde.io.yaml_text import format_flow
from ikde.kernels.arrays import Floats
from ikde.model.robot import WORLD
from ikde.model.rotation import quat_wxyz_from_rotation, rotation_from_quat_wxyz
from ikde.model.solids import SIZES, Solid
from ikde.model.world import Attached, Obstacle, World

MAX_INLINE = 1_000  # points of a cloud that stand in the file itself

Entry = dict[str, Any]


@dataclass(frozen=True, slots=True, kw_only=True)
class WorldText:
    """A world as the text of a file, and what else there is to it."""

    text: str
    files: Mapping[str, bytes] = field(default_factory=dict)
    """Further files beside it, by name: clouds."""
    lost: tuple[str, ...] = ()
    """What the format cannot hold, a line each."""


def write_world(world: World, path: str | PathLike[str], notes: Iterable[str] = ()) -> tuple[Path, ...]:
    """Write a world's file, and its large clouds beside it, whole or not at all; returns the files.

    Args:
        world: obstacles, m and rad; `load_world` reads an equal one back, to the bit.
        path: the file to write; clouds become `STEM_cloud_1.npy` and so on.
        notes: comments on top of the file, a line each.

    Raises:
        FileError: in one line, if it cannot be written.
        InputError: for what is no world.
    """
    if not isinstance(world, World):
        raise InputError(f"expected a World, got {quoted(world)}", ("world",))
    return save_text(format_world_file(world, Path(path).stem, notes), path)


def save_text(written: WorldText, path: str | PathLike[str]) -> tuple[Path, ...]:
    """Write a text and its files into the folder of `path`; the file itself is the last to get its name."""
    where = Path(path)
    return write_named(where, written.text.encode(), written.files)


def format_world_file(world: World, stem: str = "world", notes: Iterable[str] = ()) -> WorldText:
    """The text of a world's file, a line an obstacle or a part; clouds are named after `stem`."""
    files: dict[str, bytes] = {}
    lines = [f"# {printable(note)}" for note in notes] + ["obstacles:" if len(world) else "obstacles: {}"]
    for obstacle in world.obstacles:
        entries = [_solid_entry(solid, stem, files) for solid in obstacle.solids]
        if len(entries) == 1 and np.array_equal(obstacle.solids[0].T_obstacle_solid, np.eye(4)[:3]):
            lines.append(f"  {format_flow(obstacle.name)}: {format_flow(entries[0] | _obstacle_entry(obstacle))}")
            continue
        lines.append(f"  {format_flow(obstacle.name)}:")
        lines += [f"    {key}: {format_flow(value)}" for key, value in _obstacle_entry(obstacle).items()]
        parts = zip(entries, obstacle.solids, strict=True)
        lines += ["    parts:", *(f"      - {format_flow(e | _pose_entry(s.T_obstacle_solid))}" for e, s in parts)]
    if world.switched_off:
        lines.append(f"switched_off: {format_flow(sorted(world.switched_off))}")
    if world.attached:
        lines.append("attached:")
    for thing in world.attached:
        lines.append(f"  {format_flow(thing.name)}:")
        lines += [f"    {key}: {format_flow(value)}" for key, value in _attached_entry(thing).items()]
        parts = ((_solid_entry(s, stem, files), s) for s in thing.obstacle.solids)
        lines += ["    parts:", *(f"      - {format_flow(e | _pose_entry(s.T_obstacle_solid))}" for e, s in parts)]
    return WorldText(text="\n".join(lines) + "\n", files=files)


def _solid_entry(solid: Solid, stem: str, files: dict[str, bytes]) -> Entry:
    sizes = dict(zip(SIZES[solid.kind], solid.size_m, strict=True))
    if solid.kind == "box":
        return {"box": list(solid.size_m)}
    if solid.kind == "hull":
        assert solid.points is not None
        return {"hull": {"points": solid.points.tolist()}}
    if solid.kind == "cloud":
        assert solid.points is not None
        if len(solid.points) <= MAX_INLINE:
            return {"cloud": {**sizes, "points": solid.points.tolist()}}
        name = f"{stem}_cloud_{len(files) + 1}.npy"
        buffer = BytesIO()
        np.save(buffer, np.ascontiguousarray(solid.points))
        files[name] = buffer.getvalue()
        return {"cloud": {**sizes, "path": name}}
    return {solid.kind: sizes}


def _attached_entry(thing: Attached) -> Entry:
    stood, entry = _obstacle_entry(thing.obstacle), {"frame": thing.frame, **_pose_entry(thing.T_frame_object)}
    entry |= {key: stood.pop(key) for key in ("margin", "ignore", "group") if key in stood}
    entry |= {"may_touch": list(thing.may_touch)} if thing.may_touch else {}
    entry |= {"protrusion": thing.protrusion_m} if thing.protrusion_m is not None else {}
    entry |= {"picked_from": stood} if stood else {}
    return entry | {"spheres": thing.spheres.tolist()}


def _obstacle_entry(obstacle: Obstacle) -> Entry:
    entry = {"frame": obstacle.frame} if obstacle.frame != WORLD else {}
    entry |= _pose_entry(obstacle.T_world_obstacle)
    entry |= {"margin": obstacle.margin_m} if obstacle.margin_m else {}
    entry |= {"ignore": list(obstacle.ignore)} if obstacle.ignore else {}
    return entry | ({"group": obstacle.group} if obstacle.group is not None else {})


def _pose_entry(T: Floats) -> Entry:
    """The identity is not written; a quaternion is, where it gives the same bits, else the matrix."""
    R, entry = T[:, :3], {}
    if T[:, 3].any():
        entry["position"] = T[:, 3].tolist()
    if not np.array_equal(R, np.eye(3)):
        quat = quat_wxyz_from_rotation(R)
        is_exact = np.array_equal(rotation_from_quat_wxyz(quat), R)
        entry |= {"quat_wxyz": quat.tolist()} if is_exact else {"rotation": R.tolist()}
    return entry
