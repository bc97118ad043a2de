"""What the tool is asked to do: a position, a position with a tool axis direction, or a full pose; once or often."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Literal, Self, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ikde.errors import InputError
from ikde.kernels.arrays import AXIS, POSE, POSITION, Floats, Ints, read_only
from ikde.model.numbers import read_numbers
from ikde.model.rotation import (
    TOLERANCE,
    are_rotations,
    check_rotation,
    length,
    rotation_from_quat_wxyz,
    rotation_from_rpy,
    rotation_with_z,
)
from ikde.model.value import Value

MAX_MAGNITUDE = 1e6  # m: beyond it, doubles hold less than a nanometre
MAX_LENGTH = 1e100  # of an axis, whose length says nothing
MIN_LENGTH = 1e-12
TargetKind = Literal["position", "axis", "pose"]
KINDS: tuple[TargetKind, ...] = ("position", "axis", "pose")  # in the order of their numbers in `Targets.kind`
NO_DIRECTION = "an axis of length 0 has no direction"
NOT_BOTH = "a target has a rotation (R_world_tool) or an axis (axis_world_tool), not both"


@dataclass(frozen=True, slots=True, init=False, eq=False)
class Target(Value):
    """Where the tool should be, in the world frame.

    Args:
        p_world_tool: position of the tool's origin [3], m.
        R_world_tool: orientation of the tool [3, 3], for a full pose.
        axis_world_tool: direction of the tool's z axis [3], any length; the rotation about it stays free.

    Raises:
        InputError: for a wrong shape, NaN, infinity, a matrix that is no rotation, an axis of length 0, or both.
    """

    kind: TargetKind
    T_world_tool: Floats
    """[3, 4]: R and p side by side, as the kernels take them."""

    def __init__(
        self,
        p_world_tool: ArrayLike,
        R_world_tool: ArrayLike | None = None,
        axis_world_tool: ArrayLike | None = None,
    ) -> None:
        kind, R = _read_orientation(R_world_tool, axis_world_tool, rows=())
        p = _read_vectors(p_world_tool, "p_world_tool", MAX_MAGNITUDE, rows=())
        self._set(KINDS[kind], np.concatenate([R, p[:, None]], axis=1))

    @classmethod
    def from_matrix(cls, T_world_tool: ArrayLike) -> Self:
        """A full pose from a homogeneous matrix [4, 4], m; raises `InputError` unless it is a rotation and a position.

        Poses of other libraries are taken as they are wherever a target is: `solve(robot, pin.SE3.Identity())`.
        """
        R, p = _read_matrices(T_world_tool, rows=())
        return cls(p, R_world_tool=R)

    @classmethod
    def from_quat_wxyz(cls, p_world_tool: ArrayLike, quat_wxyz: ArrayLike) -> Self:
        """A full pose from a position [3] in m and a quaternion [4] of any length, w first (MuJoCo, Drake)."""
        return cls(p_world_tool, R_world_tool=_rotation_from_quat(_read(quat_wxyz, "quat_wxyz", (4,)), "quat_wxyz"))

    @classmethod
    def from_quat_xyzw(cls, p_world_tool: ArrayLike, quat_xyzw: ArrayLike) -> Self:
        """A full pose from a position [3] in m and a quaternion [4] of any length, w last (ROS, scipy)."""
        quat_wxyz = np.roll(_read(quat_xyzw, "quat_xyzw", (4,)), 1)
        return cls(p_world_tool, R_world_tool=_rotation_from_quat(quat_wxyz, "quat_xyzw"))

    @classmethod
    def from_rpy(cls, p_world_tool: ArrayLike, rpy_rad: ArrayLike) -> Self:
        """A full pose from a position [3] in m and roll, pitch, yaw [3] in rad about fixed axes: Rz Ry Rx, as URDF."""
        rpy = _read_vectors(rpy_rad, "rpy_rad", MAX_MAGNITUDE, rows=())
        return cls(p_world_tool, R_world_tool=rotation_from_rpy(rpy))

    @property
    def p_world_tool(self) -> Floats:
        """Position [3] in m."""
        return self.T_world_tool[:, 3]

    @property
    def R_world_tool(self) -> Floats:
        """Orientation [3, 3]; of an axis target only the last column is asked for, of a position target nothing."""
        return self.T_world_tool[:, :3]

    @property
    def axis_world_tool(self) -> Floats:
        """Direction asked of the tool's z axis [3]."""
        return self.T_world_tool[:, 2]

    @classmethod
    def packed(cls, kind: TargetKind, T_world_tool: Floats) -> Self:
        """A target from a kind and a pose [3, 4] that are known to be right."""
        target = cls.__new__(cls)
        target._set(kind, T_world_tool)
        return target

    def __reduce__(self) -> tuple:
        return Target.packed, (self.kind, self.T_world_tool)  # arrays that travel arrive writable

    def _set(self, kind: TargetKind, T_world_tool: Floats) -> None:
        object.__setattr__(self, "kind", kind)
        object.__setattr__(self, "T_world_tool", read_only(np.ascontiguousarray(T_world_tool)))


@dataclass(frozen=True, slots=True, init=False, eq=False, repr=False)
class Targets(Value):
    """Many targets as arrays: a sequence of `Target`, and the cheap way to have a million of them.

    Args:
        p_world_tool: positions of the tool's origin [T, 3], m.
        R_world_tool: orientations of the tool [T, 3, 3], for full poses.
        axis_world_tool: directions of the tool's z axis [T, 3], any length.

    Raises:
        InputError: as `Target`, with the row.
    """

    kind: Ints
    """[T] 0 position, 1 axis, 2 pose: index into `KINDS`."""
    T_world_tool: Floats
    """[T, 3, 4]: R and p side by side, as the kernels take them."""

    def __init__(
        self,
        p_world_tool: ArrayLike,
        R_world_tool: ArrayLike | None = None,
        axis_world_tool: ArrayLike | None = None,
    ) -> None:
        kind, R = _read_orientation(R_world_tool, axis_world_tool, rows=("T",))
        p = _read_vectors(p_world_tool, "p_world_tool", MAX_MAGNITUDE, rows=("T",))
        if kind == POSITION:
            R = np.broadcast_to(R, (len(p), 3, 3))
        if len(R) != len(p):
            name = "R_world_tool" if kind == POSE else "axis_world_tool"
            raise InputError(f"expected {len(p)} rows, as many as positions, got {len(R)}", (name,))
        self._set(np.full(len(p), kind, dtype=np.int64), np.concatenate([R, p[:, :, None]], axis=2))

    @classmethod
    def of(cls, targets: Targets | Sequence[Target]) -> Targets:
        """Targets of any kinds from a sequence of `Target`; `Targets` are given back as they are."""
        if isinstance(targets, Targets):
            return targets
        T_world_tool = np.empty((len(targets), 3, 4))
        for row, target in zip(T_world_tool, targets, strict=True):
            row[:] = target.T_world_tool
        return cls.packed(np.array([KINDS.index(target.kind) for target in targets], dtype=np.int64), T_world_tool)

    @classmethod
    def from_matrix(cls, T_world_tool: ArrayLike) -> Self:
        """Full poses from homogeneous matrices [T, 4, 4], m."""
        R, p = _read_matrices(T_world_tool, rows=("T",))
        return cls(p, R_world_tool=R)

    @classmethod
    def packed(cls, kind: Ints, T_world_tool: Floats) -> Self:
        """Targets from arrays that are known to be right: kinds [T] and poses [T, 3, 4]. They become read-only."""
        targets = cls.__new__(cls)
        targets._set(kind, T_world_tool)
        return targets

    def __repr__(self) -> str:
        """In a line, however many there are."""
        counts = np.bincount(self.kind, minlength=len(KINDS)).tolist()
        kinds = ", ".join(f"{count} {kind}" for kind, count in zip(KINDS, counts, strict=True) if count)
        return f"<Targets: {kinds or 'none'}>"

    @property
    def p_world_tool(self) -> Floats:
        """Positions [T, 3] in m."""
        return self.T_world_tool[:, :, 3]

    @property
    def R_world_tool(self) -> Floats:
        """Orientations [T, 3, 3]; of an axis target only the last column is asked for, of a position target nothing."""
        return self.T_world_tool[:, :, :3]

    @property
    def axis_world_tool(self) -> Floats:
        """Directions asked of the tool's z axis [T, 3]."""
        return self.T_world_tool[:, :, 2]

    def take(self, rows: Ints | slice) -> Targets:
        """The targets of these rows, in this order."""
        return Targets.packed(self.kind[rows], self.T_world_tool[rows])

    def __len__(self) -> int:
        return len(self.kind)

    def __iter__(self) -> Iterator[Target]:
        return (self[row] for row in range(len(self)))

    @overload
    def __getitem__(self, index: int) -> Target: ...

    @overload
    def __getitem__(self, index: slice) -> Targets: ...

    def __getitem__(self, index: int | slice) -> Target | Targets:
        if isinstance(index, slice):
            return Targets.packed(self.kind[index], self.T_world_tool[index])
        return Target.packed(KINDS[self.kind[index]], self.T_world_tool[index].copy())

    def __reduce__(self) -> tuple:
        return Targets.packed, (self.kind, self.T_world_tool)  # arrays that travel arrive writable

    def _set(self, kind: Ints, T_world_tool: Floats) -> None:
        object.__setattr__(self, "kind", read_only(np.ascontiguousarray(kind)))
        object.__setattr__(self, "T_world_tool", read_only(np.ascontiguousarray(T_world_tool)))


Rows = tuple[()] | tuple[str]
"""What stands before the axes of one target: nothing, or the axis of the rows."""


def _read_orientation(R: ArrayLike | None, axis: ArrayLike | None, rows: Rows) -> tuple[int, Floats]:
    """Index into `KINDS`, and rotations [*rows, 3, 3]; one identity if nothing is asked for."""
    if R is not None and axis is not None:
        raise InputError(NOT_BOTH)
    if R is not None:
        return POSE, _read_rotations(R, rows)
    if axis is not None:
        return AXIS, rotation_with_z(_read_axes(axis, rows))
    return POSITION, np.eye(3)


def _read_rotations(values: ArrayLike, rows: Rows) -> Floats:
    """Rotations [*rows, 3, 3]."""
    R = _read(values, "R_world_tool", (*rows, 3, 3))
    with np.errstate(all="ignore"):
        good = np.isfinite(R).all(axis=(-2, -1)) & are_rotations(R)
    _refuse(good, "R_world_tool", lambda row: check_rotation(R[row]))
    return R


def _read_matrices(values: ArrayLike, rows: Rows) -> tuple[Floats, Floats]:
    """Rotations [*rows, 3, 3] and positions [*rows, 3] of homogeneous matrices."""
    T = _read(values, "T_world_tool", (*rows, 4, 4))
    good = np.all(np.abs(T[..., 3, :] - [0.0, 0.0, 0.0, 1.0]) <= TOLERANCE, axis=-1)
    _refuse(good, "T_world_tool", lambda row: f"expected the last row 0 0 0 1, got {T[row][3].tolist()}")
    return T[..., :3, :3], T[..., :3, 3]


def _rotation_from_quat(quat_wxyz: Floats, name: str) -> Floats:
    if not np.isfinite(quat_wxyz).all():
        raise InputError("expected finite numbers", (name,))
    try:
        return rotation_from_quat_wxyz(quat_wxyz)
    except InputError as error:
        raise InputError(error.message, (name,)) from None


def _read_axes(values: ArrayLike, rows: Rows) -> Floats:
    """Directions [*rows, 3] of vectors that have one."""
    axes = _read_vectors(values, "axis_world_tool", MAX_LENGTH, rows)
    lengths = length(axes)
    _refuse(lengths > MIN_LENGTH, "axis_world_tool", lambda row: NO_DIRECTION)
    return axes / lengths[..., None]


def _read_vectors(values: ArrayLike, name: str, largest: float, rows: Rows) -> Floats:
    """Vectors [*rows, 3] of finite numbers up to `largest`."""
    vectors = _read(values, name, (*rows, 3))
    good = np.all(np.abs(vectors) <= largest, axis=-1)  # False for NaN
    _refuse(good, name, lambda row: f"expected finite numbers up to {largest:g}, got {vectors[row].tolist()}")
    return vectors


def _read(values: ArrayLike, name: str, shape: tuple[int | str, ...]) -> Floats:
    """A copy as an array of this shape, where `T` stands for any count."""
    array = read_numbers(values, (name,))
    if array.ndim != len(shape) or any(n != m for n, m in zip(array.shape, shape, strict=True) if m != "T"):
        expected = ", ".join(map(str, shape))
        raise InputError(f"expected an array [{expected}], got shape {array.shape}", (name,))
    return array


def _refuse(good: NDArray[np.bool_], name: str, complain: Callable[[tuple[int, ...]], str | None]) -> None:
    """Raise `InputError` for the first row that is not good; a single target is no row."""
    if good.all():
        return
    row = (int(np.argmin(good)),) if good.ndim else ()
    try:
        message = complain(row)
    except InputError as error:
        message = error.message
    raise InputError(str(message), (name, *row))
