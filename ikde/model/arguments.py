"""Robots and targets as callers give them: a name for a robot, an array or another library's pose for a target."""

from collections.abc import Iterable, Mapping, Set
from importlib import import_module
from os import PathLike
from pathlib import Path
from typing import Any, Protocol, cast

import numpy as np
from numpy.typing import ArrayLike

from ikde.errors import FileError, InputError, quoted
from ikde.kernels.arrays import Floats
from ikde.model.numbers import read_numbers
from ikde.model.robot import Robot
from ikde.model.target import Target, Targets

Where = tuple[str | int, ...]

ONE = "a Target, a position [3] in m or a pose [4, 4]"
MANY = "Targets, a sequence of targets, positions [T, 3] in m or poses [T, 4, 4]"
ROTATIONS = "; rotations have no position: Target(p, R_world_tool=R), or Targets for many"


class HasHomogeneous(Protocol):
    """As `pinocchio.SE3` is."""

    @property
    def homogeneous(self) -> Any:
        """[4, 4]."""


class HasA(Protocol):
    """As `spatialmath.SE3` is."""

    @property
    def A(self) -> Any:
        """[4, 4], or a list of them."""


class HasAsMatrix(Protocol):
    """As `mink.SE3` is."""

    def as_matrix(self) -> Any:
        """[4, 4]."""


class HasDetector(Protocol):
    """A robot and what is compared on it: as `CollisionModel` is."""

    @property
    def robot(self) -> Robot:
        """Whose it is."""
        ...

    @property
    def detector(self) -> Any:
        """What it compares."""
        ...


RobotLike = Robot | str | PathLike[str]
"""A robot, the name of one that ships with ikde, or the path of a file; a file is read at each call."""
Pose = HasHomogeneous | HasA | HasAsMatrix
"""T_world_tool [4, 4] of another library: `.homogeneous`, `.A` or `.as_matrix()`."""
TargetLike = Target | ArrayLike | Pose
"""A target, a position [3] in m, or a pose T_world_tool [4, 4]."""
TargetsLike = Targets | Target | ArrayLike | Pose | Iterable[Target | ArrayLike | Pose]
"""Targets, a sequence of what is taken for one, positions [T, 3] in m, poses [T, 4, 4]; one target is one row."""


def read_robot(robot: RobotLike, where: Where = ("robot",)) -> Robot:
    """The robot itself, or that of a name or path; raises `InputError` for what is none."""
    if isinstance(robot, Robot):
        return robot
    if not isinstance(robot, str | PathLike):
        raise InputError(f"expected a Robot, a robot's name or a path, got {quoted(robot)}", where)
    name = robot if isinstance(robot, str) else Path(robot)
    try:
        return import_module("ikde.io.robots").load_robot(name)  # files are above this floor
    except FileError:
        raise
    except InputError as error:
        raise InputError(error.message, where) from None


def read_target(target: TargetLike, where: Where = ("target",)) -> Target:
    """One target; raises `InputError` for what is none."""
    if isinstance(target, Target):
        return target
    if isinstance(target, Targets):
        raise InputError(f"expected {ONE}, got Targets; solve_many takes many", where)
    array = _read_array(target, ONE, where)
    if array.shape not in ((3,), (4, 4)):
        raise InputError(f"expected {ONE}, got {_describe(target, array)}{_find_hint(array)}", where)
    try:
        return Target(array) if array.ndim == 1 else Target.from_matrix(array)
    except InputError as error:
        raise InputError(error.message, where) from None


def read_targets(targets: TargetsLike, where: Where = ("targets",)) -> Targets:
    """Many targets, or one as one row; raises `InputError` for what is none, with its row."""
    if isinstance(targets, Targets):
        return targets
    if isinstance(targets, Target):
        return Targets.of([targets])
    if _is_listed(targets, where):
        targets = list(cast(Iterable[Any], targets))
        if not targets or not _are_numbers(targets):
            return Targets.of([read_target(one, (*where, row)) for row, one in enumerate(targets)])
    array = _read_array(targets, MANY, where)
    if array.shape in ((3,), (4, 4)):
        return Targets.of([read_target(array, where)])
    try:
        if array.ndim == 2 and array.shape[1] == 3 and find_matrix(targets, where) is None:
            return Targets(array)
        if array.ndim == 3 and array.shape[1:] == (4, 4):
            return Targets.from_matrix(array)
    except InputError as error:
        raise InputError(error.message, (*where, *error.where[1:])) from None
    raise InputError(f"expected {MANY}, got {_describe(targets, array)}{_find_hint(array)}", where)


def _is_listed(value: object, where: Where) -> bool:
    """Whether it holds targets one by one, rather than numbers in an array."""
    is_array = isinstance(value, np.ndarray | str | bytes | Mapping | Set) or hasattr(value, "__array__")
    return isinstance(value, Iterable) and not is_array and find_matrix(value, where) is None


def _are_numbers(values: list[Any]) -> bool:
    """Whether a list is an array of numbers, not of targets of several kinds."""
    try:
        return np.array(values).dtype.kind in "biuf"
    except (TypeError, ValueError):
        return False


def find_matrix(value: object, where: Where) -> Any:
    """The matrix of another library's pose, or None; raises `InputError` with what that library raises."""
    if isinstance(value, type | np.ndarray | list | tuple):
        return None
    name = ""
    try:
        for name in ("homogeneous", "A", "as_matrix"):
            if (found := getattr(value, name, None)) is not None and (name != "as_matrix" or callable(found)):
                return found() if name == "as_matrix" else found
    except InputError:
        raise
    except Exception as error:
        text = f": {quoted(str(error))}" if str(error) else ""
        raise InputError(f"`.{name}` of {quoted(value)} raised {type(error).__name__}{text}", where) from error
    return None


def _read_array(value: Any, expected: str, where: Where) -> Floats:
    pose = find_matrix(value, where)
    try:
        return read_numbers(value if pose is None else pose, where)
    except InputError:
        raise InputError(f"expected {expected}, got {quoted(value)}", where) from None


def _describe(value: object, array: Floats) -> str:
    return f"shape {array.shape}" if array.ndim else quoted(value)


def _find_hint(array: Floats) -> str:
    return ROTATIONS if array.shape[-2:] == (3, 3) else ""
