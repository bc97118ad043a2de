"""A world as text: its obstacles, where they stand, and what was decided when it was read."""

from collections import Counter
from collections.abc import Sequence
from itertools import islice
from typing import Any

import numpy as np

from ikde.formats.units import LENGTHS_M
from ikde.model.robot import WORLD
from ikde.model.solids import SIZES, Solid
from ikde.model.world import Attached, Obstacle, World
from ikde.report.numbers import Units, count_of
from ikde.report.render import make_table, plain, render

MAX_ROWS = 1_000  # solids in a table
DIGITS = 6  # significant ones of a length


def world_json(world: World) -> dict[str, Any]:
    """A world as plain data, m; of hulls and clouds the number of their points."""
    return {
        "digest": world.digest,
        "obstacles": [_obstacle_json(world, obstacle) for obstacle in world.obstacles],
        "attached": [
            {
                "name": thing.name,
                "frame": thing.frame,
                "T_frame_object": thing.T_frame_object.tolist(),
                "spheres": len(thing.spheres),
                "protrusion_m": thing.protrusion_m,
                "may_touch": list(thing.may_touch),
                "picked_from": _obstacle_json(world, thing.obstacle),
            }
            for thing in world.attached
        ],
        "groups": {group: group not in world.switched_off for group in world.groups},
    }


def _obstacle_json(world: World, obstacle: Obstacle) -> dict[str, Any]:
    return {
        "name": obstacle.name,
        "frame": obstacle.frame,
        "T_frame_obstacle": obstacle.T_world_obstacle.tolist(),
        "margin_m": obstacle.margin_m,
        "ignore": list(obstacle.ignore),
        "group": obstacle.group,
        "on": obstacle.group not in world.switched_off,
        "solids": [
            {
                "kind": solid.kind,
                "size_m": dict(zip(SIZES[solid.kind], solid.size_m, strict=True)),
                "T_obstacle_solid": solid.T_obstacle_solid.tolist(),
                "points": None if solid.points is None else len(solid.points),
            }
            for solid in obstacle.solids
        ],
    }


def describe_world(world: World) -> str:
    """`3 obstacles of 7 solids (5 boxes, 2 cylinders); group tools is off`."""
    solids = [solid for obstacle in world.obstacles for solid in obstacle.solids]
    kinds = Counter(solid.kind for solid in solids)
    counted = ", ".join(_count_kind(kind, count) for kind, count in kinds.most_common())
    text = f"{count_of(len(world), 'obstacle')} of {count_of(len(solids), 'solid')}" if solids else "no obstacle"
    off = f"; off: {', '.join(sorted(world.switched_off))}" if world.switched_off else ""
    held = ", ".join(f"{thing.name} to {thing.frame}" for thing in world.attached)
    return f"{text}{f' ({counted})' if solids else ''}{off}{f'; attached: {held}' if held else ''}"


def format_world(
    world: World, units: Units, notes: Sequence[str] = (), *, color: bool = False, width: int = 100
) -> str:
    """A table of obstacles, a line each or a line a solid; then what is special of some, and the notes."""
    tables = [_table(world, units)] if len(world) else []
    special = [line for obstacle in world.obstacles for line in _describe_special(world, obstacle, units)]
    special += [_describe_attached(thing, units) for thing in world.attached]
    count = sum(len(obstacle.solids) for obstacle in world.obstacles)
    more = [f"and {count - MAX_ROWS:,} more solids; --json has all"] if count > MAX_ROWS else []
    special = special[:MAX_ROWS]
    below = [*more, *special, *(f"note: {note}" for note in notes), f"digest {world.digest[:16]}"]
    texts = [
        render(plain(describe_world(world)), width=width),
        render(*tables, color=color, width=width) if tables else "",
    ]
    return "\n\n".join([*filter(None, texts), render(*map(plain, below), color=color, width=width)])


def _table(world: World, units: Units) -> Any:
    u = units.length
    table = make_table("obstacle", "solid", f"size [{u}]", f"middle [{u}]", "frame")
    rows = ((o, place, solid) for o in world.obstacles for place, solid in enumerate(o.solids))
    for obstacle, place, solid in islice(rows, MAX_ROWS):
        name = obstacle.name if place == 0 else ""
        kind = solid.kind.replace("_", "-")
        cells = (name, kind, _size(solid, units), _middle(obstacle, solid, units), obstacle.frame)
        table.add_row(*map(plain, cells))
    if all(obstacle.frame == WORLD for obstacle in world.obstacles):
        table.columns.pop()
    return table


def _size(solid: Solid, units: Units) -> str:
    sizes = [_number(size, units) for size in solid.size_m]
    match solid.kind:
        case "sphere":
            return f"r {sizes[0]}"
        case "box":
            return " x ".join(sizes)
        case "half_space":
            return "below"
        case "hull":
            assert solid.points is not None
            return count_of(len(solid.points), "corner")
        case "cloud":
            assert solid.points is not None
            return f"{count_of(len(solid.points), 'point')}, r {sizes[0]}"
    return f"r {sizes[0]}, h {sizes[1]}"


def _middle(obstacle: Obstacle, solid: Solid, units: Units) -> str:
    """Of what holds points: of their box; of others, their origin; in the obstacle's frame."""
    own = np.zeros(3)
    if solid.points is not None:
        own = 0.5 * (solid.points.min(axis=0) + solid.points.max(axis=0))
    for T in (solid.T_obstacle_solid, obstacle.T_world_obstacle):
        own = T[:, :3] @ own + T[:, 3]
    return ", ".join(_number(value, units) for value in np.round(own, 9))


def _number(value_m: float, units: Units) -> str:
    return f"{value_m / LENGTHS_M[units.length] + 0.0:.{DIGITS}g}"


def _describe_special(world: World, obstacle: Obstacle, units: Units) -> list[str]:
    said = []
    if obstacle.group is not None:
        said.append(f"group {obstacle.group}{' (off)' * (obstacle.group in world.switched_off)}")
    if obstacle.margin_m:
        said.append(f"margin {units.format_length(obstacle.margin_m)}")
    if obstacle.ignore:
        said.append(f"ignores {', '.join(obstacle.ignore)}")
    return [f"{obstacle.name}: {'; '.join(said)}"] if said else []


def _describe_attached(thing: Attached, units: Units) -> str:
    said = [f"attached to {thing.frame}", count_of(len(thing.spheres), "sphere")]
    if thing.protrusion_m is not None:
        said[1] += f" that stand out by {units.format_length(thing.protrusion_m)} at most"
    if thing.obstacle.margin_m:
        said.append(f"margin {units.format_length(thing.obstacle.margin_m)}")
    if thing.may_touch:
        said.append(f"may touch {', '.join(thing.may_touch)}")
    return f"{thing.name}: {'; '.join(said)}"


def _count_kind(kind: str, count: int) -> str:
    many = {"box": "boxes"}.get(kind, f"{kind}s")
    return f"{count:,} {(kind if count == 1 else many).replace('_', '-')}"
