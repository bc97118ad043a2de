"""What a robot picks up, as it is typed, `mug=tool:table+finger`, and in run and track files; and how it does so."""

from collections.abc import Iterable, Mapping
from typing import NamedTuple

from ikde.errors import InputError, quoted
from ikde.formats.entries import HeldEntry
from ikde.kernels.arrays import Floats
from ikde.model.collision_model import CollisionModel
from ikde.model.world import World


class Held(NamedTuple):
    """An object, the frame that holds it, and what it may touch."""

    name: str
    frame: str
    may_touch: tuple[str, ...]


def read_attached(text: str) -> list[Held]:
    """Objects in the order in which they are picked up, from `mug=tool:table+finger,lid=tool`.

    Raises:
        InputError: for what is no such text.
    """
    found: list[Held] = []
    for word in text.split(","):
        name, _, place = word.strip().partition("=")
        frame, colon, touched = place.partition(":")
        may_touch = tuple(part.strip() for part in touched.split("+")) if colon else ()
        if not (name.strip() and frame.strip() and all(may_touch)):
            raise InputError(f"expected OBJECT=FRAME or OBJECT=FRAME:T+T, got {quoted(word)}", ("attach",))
        found.append(Held(name.strip(), frame.strip(), may_touch))
    return found


def list_held(entries: Mapping[str, str | HeldEntry]) -> list[Held]:
    """The same from the `attached` of a file."""
    whole = {name: HeldEntry(frame=entry) if isinstance(entry, str) else entry for name, entry in entries.items()}
    return [Held(name, entry.frame, tuple(entry.may_touch)) for name, entry in whole.items()]


def pick_up(world: World, held: Iterable[Held], model: CollisionModel, q: Floats | None, key: str = "attach") -> World:
    """The world after a robot has picked up some obstacles at `q` [N], m and rad, or at home.

    Raises:
        InputError: at `key` and the object's name; of an obstacle that does not fit the robot, where that stands.
    """
    values = model.robot.home if q is None else q
    for thing in held:
        try:
            world = world.attach(thing.name, thing.frame, robot=model.own, q=values, may_touch=thing.may_touch)
        except InputError as error:
            if error.where[:1] == ("obstacles",):  # a line of the world's file
                raise
            inside = error.where if error.where[:1] == ("may_touch",) and key != "attach" else ()
            raise InputError(error.message, (key, thing.name, *inside)) from None
    return world
