"""Options of commands that mind a world, and how they become a collision model."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from ikde.cli.options import LengthUnit, of_collision
from ikde.cli.output import print_note

if TYPE_CHECKING:
    from ikde.model.collision_model import CollisionModel

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
NAMED = 3  # pairs in a note
NEAR_M = 0.02  # a gap that could be asked for as a margin


def place_in_world(
    collision: "CollisionModel", world: Path | None, margin: str | None, unit: LengthUnit
) -> "CollisionModel":
    """The robot in the world of a file; stderr says how it was read, and what is near whatever joints do.

    A world and margins that `collision` has already are kept where no others are given.
    """
    from ikde.errors import InputError

    if world is None and margin is None:
        return collision
    from ikde.formats.margins import read_margins
    from ikde.formats.units import LENGTHS_M
    from ikde.model.world import NOTHING
    from ikde.solver.standing import find_standing_obstacles, refuse_touching

    kept = collision.margin_m, dict(collision.margins_m)
    margin_m, margins_m = kept if margin is None else read_margins(margin, LENGTHS_M[unit])
    if world is None:
        if collision.world is NOTHING:
            raise InputError("a margin needs a --world to be kept from", ("margin",))
        model = collision.in_world(collision.world, margin_m, margins_m)
        refuse_touching(model)
        return model
    from ikde.io.world_file import read_world

    found = read_world(world)
    with found.errors():
        model = collision.in_world(found.world, margin_m, margins_m)
        refuse_touching(model)
    for note in found.notes:
        print_note(f"ikde: {note}")
    near = [pair for pair in find_standing_obstacles(model) if pair.clearance_m <= NEAR_M]
    if near:
        near.sort(key=lambda pair: pair.clearance_m)
        named = ", ".join(f"{p.component} - {p.obstacle} {1e3 * p.clearance_m:.4g} mm" for p in near[:NAMED])
        more = f" and {len(near) - NAMED} more" if len(near) > NAMED else ""
        print_note(f"ikde: as near in every configuration: {named}{more}")
    return model
