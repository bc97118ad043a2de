"""Options of commands that mind a world, and how they become a collision model."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

from ikde.cli.options import LengthUnit, of_collision
from ikde.cli.output import print_note

if TYPE_CHECKING:
    from ikde.kernels.arrays import Floats
    from ikde.model.collision_model import CollisionModel
    from ikde.model.world import Attached, World

WorldOption = Annotated[
    Path | None,
    of_collision(metavar="FILE", help="Obstacles: a world file, a cuRobo scene or a MoveIt planning scene."),
]
MarginOption = Annotated[
    str | None,
    of_collision(
        metavar="D,C=D,..",
        help="Distance to keep from the world, in --unit; C=D is that of a component in its place, as in 10,gripper=0.",
    ),
]
AttachOption = Annotated[
    str | None,
    of_collision(
        metavar="OBJECT=FRAME,..",
        help="Objects of the world that the robot holds, picked up where they stand, with the robot at the values that "
        "the command knows (--near, --q, --start), else home. mug=tool:table+finger: what it may touch.",
    ),
]
NAMED = 3  # pairs in a note
NEAR_M = 0.02  # a gap that could be asked for as a margin


class Pick(NamedTuple):
    """What is typed to be attached, and the joint values [N] at which it is picked up; None: home."""

    text: str | None = None
    q: "Floats | None" = None


def place_in_world(
    collision: "CollisionModel", world: Path | None, margin: str | None, unit: LengthUnit, pick: Pick = Pick()
) -> "CollisionModel":
    """The robot in the world of a file; stderr says how it was read, what is near whatever joints do, and what it
    holds.

    A world and margins that `collision` has already are kept where no others are given.
    """
    from ikde.errors import InputError

    if world is None and margin is None and pick.text is None:
        return collision
    from ikde.formats.margins import read_margins
    from ikde.formats.units import LENGTHS_M
    from ikde.model.world import NOTHING
    from ikde.solver.standing import find_standing_obstacles, refuse_touching

    kept = collision.margin_m, dict(collision.margins_m)
    margin_m, margins_m = kept if margin is None else read_margins(margin, LENGTHS_M[unit])
    if world is None:
        if collision.world is NOTHING:
            what = (
                "a margin needs a --world to be kept from" if margin is not None else "expected a --world to pick from"
            )
            raise InputError(what, ("margin" if margin is not None else "attach",))
        model = collision.in_world(_pick_up(collision, collision.world, pick), margin_m, margins_m)
        refuse_touching(model)
        _note_held(model, pick)
        return model
    from ikde.io.world_file import read_world

    found = read_world(world)
    with found.errors():
        model = collision.in_world(_pick_up(collision, found.world, pick), margin_m, margins_m)
        refuse_touching(model)
    _note_held(model, pick)
    for note in found.notes:
        print_note(f"ikde: {note}")
    near = [pair for pair in find_standing_obstacles(model) if pair.clearance_m <= NEAR_M]
    if near:
        near.sort(key=lambda pair: pair.clearance_m)
        named = ", ".join(f"{p.component} - {p.obstacle} {1e3 * p.clearance_m:.4g} mm" for p in near[:NAMED])
        more = f" and {len(near) - NAMED} more" if len(near) > NAMED else ""
        print_note(f"ikde: as near in every configuration: {named}{more}")
    return model


def _pick_up(collision: "CollisionModel", world: "World", pick: Pick) -> "World":
    """The world after all that is typed has been picked up."""
    from ikde.formats.attached import pick_up, read_attached

    return world if pick.text is None else pick_up(world, read_attached(pick.text), collision, pick.q)


def _note_held(model: "CollisionModel", pick: Pick) -> None:
    """Say how what was picked up is compared."""
    if pick.text is not None:
        note_held(model, pick)


def note_held(model: "CollisionModel", pick: Pick) -> None:
    """Say of all that is held how it is compared, and how far it is from what holds it."""
    from ikde.report.numbers import count_of

    for thing in model.world.attached:
        out_mm = 1e3 * (thing.protrusion_m or 0.0)
        spheres = f"{count_of(len(thing.spheres), 'sphere')}, up to {out_mm:.3g} mm beyond it"
        print_note(f"ikde: {thing.frame} holds {thing.name}, {_tell_distance(thing, pick)}: {spheres}")


def _tell_distance(thing: "Attached", pick: Pick) -> str:
    """How far what is held is from what holds it: far away, it was picked up from the wrong place."""
    import numpy as np

    T = thing.T_frame_object
    away_m = np.linalg.norm(thing.spheres[:, :3] @ T[:, :3].T + T[:, 3], axis=1) - thing.spheres[:, 3]
    where = "home" if pick.q is None else "the joint values given"
    return f"{1e3 * max(away_m.min(), 0.0):.3g} mm away at {where}"
