"""From `solve` and `arms` of a run file to problems: names resolved, numbers in m and rad."""

from collections.abc import Mapping, Sequence
from contextlib import nullcontext
from dataclasses import replace
from typing import Any

from ikde.batch.parts import PLAIN_NAME
from ikde.batch.plan import Arm
from ikde.batch.recipe import as_plain
from ikde.batch.spec import MAX_ARMS, BatchSpec, SolveEntry
from ikde.batch.worlds import RunWorld
from ikde.errors import FileError, InputError
from ikde.formats.entries import UnitsEntry
from ikde.formats.error_path import prefix_errors
from ikde.formats.margins import read_margins
from ikde.formats.robot_entries import read_collision, to_si, with_ranges
from ikde.model.robot import Robot
from ikde.solver.problem import make_problem
from ikde.solver.settings import SolveSettings

MERGED = ("settings", "ranges", "near", "weights", "freeze")  # an arm adds to these instead of replacing them
TOLERANCES = {"position_tolerance": "position_tolerance_m", "orientation_tolerance": "orientation_tolerance_rad"}


def make_arms(spec: BatchSpec, robot: Robot, worlds: Sequence[RunWorld] = ()) -> tuple[Arm, ...]:
    """The arms of a run, or the one that is called like its method; in several worlds, each of them in each."""
    arms: list[Arm] = []
    for world in worlds or [None]:
        if spec.arms:
            arms += (_make_named(name, spec, robot, world) for name in spec.arms)
        else:
            with prefix_errors("solve"):
                arms.append(make_arm(spec.solve.method, robot, spec.solve, spec.units, world))
    if len(worlds) < 2:
        return tuple(arms)
    arms = [replace(arm, name=f"{arm.name}-{arm.world}") for arm in arms]
    names = [arm.name for arm in arms]
    if len(names) > MAX_ARMS:
        raise InputError(f"arms and worlds make {len(names):,}; expected at most {MAX_ARMS:,} in all", ("worlds",))
    for name in names:
        if names.count(name) > 1 or not PLAIN_NAME.fullmatch(name):
            raise InputError(
                f"{name!r} names the files of an arm in a world: expected a shorter, or another", ("arms",)
            )
    return tuple(arms)


def make_arm(name: str, robot: Robot, entry: SolveEntry, units: UnitsEntry, world: RunWorld | None = None) -> Arm:
    """One arm; raises `InputError` with a path inside a `SolveEntry`, or `FileError` at a place of the world's file."""
    own = with_ranges(robot, entry.ranges, units)
    with prefix_errors("detector"):
        collision = read_collision(own, entry.detector, units)
    with nullcontext() if world is None else world.errors():
        if world is None and entry.margin is not None:
            raise InputError("a margin needs a world to be kept from", ("margin",))
        if world is not None and (world.world.obstacles or world.world.attached):
            margins = str(entry.margin) if entry.margin is not None else None
            collision = collision.in_world(world.world, *read_margins(margins, units.length_m))
        problem = make_problem(
            own,
            _make_settings(entry, units),
            collision=collision,
            near=None if entry.near is None else to_si(robot, "near", entry.near, units),
            freeze=to_si(robot, "freeze", entry.freeze, units) or None,
            weights=entry.weights,
        )
    place = {} if world is None else {"world": world.name, "world_file": world.file}
    return Arm(name=name, method=entry.method, problem=problem, **place)


def describe_arm(arm: Arm) -> dict[str, Any]:
    """All of an arm that its answers depend on, as plain data in m and rad."""
    problem, names = arm.problem, arm.problem.robot.joint_names
    start, model = dict(zip(names, problem.lower, strict=True)), problem.collision
    place: dict[str, dict[str, Any]] = {} if arm.world is None else {"world": {"name": arm.world}}
    if model.is_in_world:
        kept = {"margin_m": model.margin_m, "margins_m": dict(model.margins_m)}
        place["world"] |= {"digest": model.world.digest, **kept}
        if model.world.attached:
            place["world"]["attached"] = {thing.name: thing.frame for thing in model.world.attached}
    return as_plain(
        {
            "method": arm.method,
            "detector": problem.collision.detector,
            "settings": problem.settings,
            "ranges": {joint.name: (joint.lower, joint.upper) for joint in problem.robot.joints},
            "near": None if problem.near is None else dict(zip(names, problem.near, strict=True)),
            "weights": dict(zip(names, problem.weights, strict=True)),
            "freeze": {name: start[name] for name in problem.frozen},
            **place,
        }
    )


def _make_named(name: str, spec: BatchSpec, robot: Robot, world: RunWorld | None) -> Arm:
    """An arm laid over `solve`; what is wrong with it is placed where it was written."""
    own = spec.arms[name].model_dump(exclude_unset=True)
    if not PLAIN_NAME.fullmatch(name):
        raise InputError("expected a name of up to 100 letters, digits and . _ -, since it names files", ("arms", name))
    shared = spec.solve.model_dump(exclude_unset=True)
    added = {key: _lay_over(shared[key], own[key]) for key in MERGED if shared.get(key) and own.get(key)}
    try:
        return make_arm(name, robot, SolveEntry.model_validate({**shared, **own, **added}), spec.units, world)
    except FileError:
        raise
    except InputError as error:
        inherited = _holds(shared, error.where) and not _holds(own, error.where)
        where = ("solve",) if inherited else ("arms", name)
        raise InputError(error.message, (*where, *error.where)) from None


def _lay_over(shared: Mapping[str, Any], own: Mapping[str, Any]) -> dict[str, Any]:
    """Both, key by key; where both say something, what is its own."""
    nested = [key for key in own if isinstance(own[key], dict) and isinstance(shared.get(key), dict)]
    both = {key: _lay_over(shared[key], own[key]) for key in nested}
    return {**shared, **own, **both}


def _holds(data: Any, where: tuple[str | int, ...]) -> bool:
    for key in where:
        if not isinstance(data, dict) or key not in data:
            return False
        data = data[key]
    return True


def _make_settings(entry: SolveEntry, units: UnitsEntry) -> SolveSettings:
    given = entry.settings.model_dump(exclude_none=True)
    factors = {"position_tolerance": units.length_m, "orientation_tolerance": units.angle_rad}
    given |= {key: given[key] * factor for key, factor in factors.items() if key in given}
    changes = {TOLERANCES.get(key, key): value for key, value in given.items()}
    try:
        return SolveSettings.for_method(entry.method).with_changes(**changes)
    except InputError as error:
        written = {suffixed: key for key, suffixed in TOLERANCES.items()}
        raise InputError(error.message, tuple(written.get(str(key), key) for key in error.where)) from None
