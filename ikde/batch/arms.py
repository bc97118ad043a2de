"""From `solve` and `arms` of a run file to problems: names resolved, numbers in m and rad."""

from collections.abc import Mapping
from typing import Any

from ikde.batch.parts import PLAIN_NAME
from ikde.batch.plan import Arm
from ikde.batch.recipe import as_plain
from ikde.batch.spec import BatchSpec, SolveEntry
from ikde.errors import InputError
from ikde.formats.entries import UnitsEntry
from ikde.formats.error_path import prefix_errors
from ikde.formats.robot_entries import read_collision, to_si, with_ranges
from ikde.model.robot import Robot
from ikde.solver.problem import make_problem
from ikde.solver.settings import SolveSettings

MERGED = ("settings", "ranges", "near", "weights", "freeze")  # an arm adds to these instead of replacing them
TOLERANCES = {"position_tolerance": "position_tolerance_m", "orientation_tolerance": "orientation_tolerance_rad"}


def make_arms(spec: BatchSpec, robot: Robot) -> tuple[Arm, ...]:
    """The arms of a run, or the one that is called like its method."""
    if not spec.arms:
        with prefix_errors("solve"):
            return (make_arm(spec.solve.method, robot, spec.solve, spec.units),)
    return tuple(_make_named(name, spec, robot) for name in spec.arms)


def make_arm(name: str, robot: Robot, entry: SolveEntry, units: UnitsEntry) -> Arm:
    """One arm; raises `InputError` with a path inside a `SolveEntry`."""
    own = with_ranges(robot, entry.ranges, units)
    with prefix_errors("detector"):
        collision = read_collision(own, entry.detector, units)
    problem = make_problem(
        own,
        _make_settings(entry, units),
        collision=collision,
        near=None if entry.near is None else to_si(robot, "near", entry.near, units),
        freeze=to_si(robot, "freeze", entry.freeze, units) or None,
        weights=entry.weights,
    )
    return Arm(name=name, method=entry.method, problem=problem)


def describe_arm(arm: Arm) -> dict[str, Any]:
    """All of an arm that its answers depend on, as plain data in m and rad."""
    problem, names = arm.problem, arm.problem.robot.joint_names
    start = dict(zip(names, problem.lower, strict=True))
    return as_plain(
        {
            "method": arm.method,
            "detector": problem.collision.detector,
            "settings": problem.settings,
            "ranges": {joint.name: (joint.lower, joint.upper) for joint in problem.robot.joints},
            "near": None if problem.near is None else dict(zip(names, problem.near, strict=True)),
            "weights": dict(zip(names, problem.weights, strict=True)),
            "freeze": {name: start[name] for name in problem.frozen},
        }
    )


def _make_named(name: str, spec: BatchSpec, robot: Robot) -> Arm:
    """An arm laid over `solve`; what is wrong with it is placed where it was written."""
    own = spec.arms[name].model_dump(exclude_unset=True)
    if not PLAIN_NAME.fullmatch(name):
        raise InputError("expected a name of up to 100 letters, digits and . _ -, since it names files", ("arms", name))
    shared = spec.solve.model_dump(exclude_unset=True)
    added = {key: _lay_over(shared[key], own[key]) for key in MERGED if shared.get(key) and own.get(key)}
    try:
        return make_arm(name, robot, SolveEntry.model_validate({**shared, **own, **added}), spec.units)
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
