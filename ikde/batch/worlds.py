"""The worlds of a run: read by a floor above, named, and some of them with obstacles moved at random."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from ikde.batch.generators import make_box
from ikde.batch.parts import PLAIN_NAME
from ikde.batch.recipe import digest
from ikde.batch.spec import MAX_ARMS, BatchSpec, WorldEntry
from ikde.errors import InputError
from ikde.formats.attached import Held, pick_up
from ikde.formats.entries import UnitsEntry
from ikde.formats.error_path import prefix_errors
from ikde.kernels.arrays import Floats
from ikde.model.collision_model import CollisionModel
from ikde.model.rotation import rotation_about
from ikde.model.world import NOTHING, Obstacle, World

NO_WORLD = "none"

Errors = Callable[[], AbstractContextManager[None]]
"""A block in which what is wrong with a world is said at its place in its own file."""
Read = Callable[[str], tuple[World, Errors]]
"""Reads a world file, whose path starts where the run file is; raises `FileError`."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RunWorld:
    """A world of a run."""

    name: str
    world: World
    file: str | None
    """As the run file writes it; None for no world, and for one of which obstacles were moved or picked up."""
    errors: Errors


def make_worlds(spec: BatchSpec, read: Read) -> tuple[RunWorld, ...]:
    """The worlds of a run, none if it is in none; `read` gives what stands in a file.

    Raises:
        InputError: with the path of the key inside the run file.
        FileError: for what is wrong inside a world file.
    """
    if spec.world is not None and spec.worlds is not None:
        raise InputError("expected one of world, worlds, got both", ("worlds",))
    if spec.world is not None:
        with prefix_errors("world"):
            found = list(_make_some(spec.world, spec, read))
    else:
        found = []
        for index, entry in enumerate(spec.worlds or ()):
            with prefix_errors("worlds", index):
                found += _make_some(entry, spec, read)
                _check_names(found)
    if len(found) > MAX_ARMS:
        raise InputError(f"expected at most {MAX_ARMS:,} worlds, got {len(found):,}", ("worlds",))
    return tuple(found)


def pick_up_all(
    worlds: Sequence[RunWorld], held: Sequence[Held], model: CollisionModel, q: Floats | None, key: str
) -> tuple[RunWorld, ...]:
    """The worlds after the robot has picked up some obstacles of each, at `q` [N], m and rad, or at home.

    Raises:
        InputError: at `key`; or at its place in a world's file.
    """
    if held and not worlds:
        raise InputError("what is picked up is an obstacle of a `world`: name one", (key,))
    found = []
    for one in worlds if held else ():
        with one.errors():
            try:
                found.append(replace(one, world=pick_up(one.world, held, model, q, key), file=None))
            except InputError as error:
                place = f" (in {one.name})" if len(worlds) > 1 else ""
                raise InputError(f"{error.message}{place}", error.where) from None
    return tuple(found) if held else tuple(worlds)


def _check_names(found: list[RunWorld]) -> None:
    """Names of several worlds become those of arms."""
    names = [one.name for one in found]
    if not PLAIN_NAME.fullmatch(names[-1]):
        raise InputError(
            f"{names[-1]!r} cannot name files; expected a `name` of up to 100 letters, digits and . _ -, and a `path`"
        )
    if len(set(names)) < len(names):
        raise InputError(f"two worlds are called {names[-1]!r}; give one a `name`, and its `path`")


def _make_some(entry: str | WorldEntry, spec: BatchSpec, read: Read) -> Iterator[RunWorld]:
    """The world of an entry, or as many as it moves obstacles of."""
    if isinstance(entry, str):
        entry = WorldEntry(path=entry)
    if entry.path == NO_WORLD:
        yield RunWorld(name=entry.name or NO_WORLD, world=NOTHING, file=None, errors=partial(prefix_errors))
        return
    world, errors = read(entry.path)
    name = entry.name or entry.path.replace("\\", "/").rsplit("/", 1)[-1].rpartition(".")[0] or entry.path
    if not entry.move:
        if entry.count > 1:
            raise InputError("several of one world differ by what moves; expected `move`, too", ("count",))
        yield RunWorld(name=name, world=world, file=entry.path, errors=errors)
        return
    for obstacle in entry.move:
        with prefix_errors("move"):
            world[obstacle]  # raises for a name that there is not
    for number in range(entry.count):
        moved = _move_some(world, entry, spec.units, spec.seed, number)
        yield RunWorld(name=f"{name}-{number}", world=moved, file=None, errors=errors)


def _move_some(world: World, entry: WorldEntry, units: UnitsEntry, seed: int, number: int) -> World:
    """World `number` of those in which some obstacles stand elsewhere; it depends on seed, name and number alone."""
    for name, move in entry.move.items():
        most = np.abs(move.by) * units.length_m
        own = int(digest([seed, name])[:15], 16)
        shift = make_box(-most, most, entry.count, own, {}).make_points(number, number + 1)[0]
        angle = make_box(-np.ones(3), np.ones(3), entry.count, own + 1, {}).make_points(number, number + 1)[0, 0]
        world = world.move(name, _shift(world[name], shift, angle * move.turn * units.angle_rad))
    return world


def _shift(obstacle: Obstacle, shift: np.ndarray, angle_rad: float) -> np.ndarray:
    """Its pose [3, 4] after a turn about z through its own origin and a shift [3], m."""
    T = obstacle.T_world_obstacle
    R = rotation_about(np.array([0.0, 0.0, 1.0]), angle_rad) @ T[:, :3]
    return np.column_stack([R, T[:, 3] + shift])
