"""What the tool is asked to do: a position, a position with a tool axis direction, or a full pose; once or often."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Literal, Self, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ikde.errors import InputError
from ikde.kernels.arrays import Floats, Ints
from ikde.model.rotation import are_rotations, check_rotation, length, rotation_with_z

FARTHEST = 1e6  # m: beyond it, doubles hold less than a nanometre
LONGEST = 1e100  # of an axis, whose length says nothing
SHORTEST = 1e-12
TargetKind = Literal["position", "axis", "pose"]
KINDS: tuple[TargetKind, ...] = ("position", "axis", "pose")  # in the order of their numbers in `Targets.kind`
POSITION, AXIS, POSE = range(3)
NO_DIRECTION = "an axis of length 0 has no direction"
NOT_BOTH = "a target has a rotation (R_world_tool) or an axis (axis_world_tool), not both"


@dataclass(frozen=True, slots=True, init=False, eq=False)
class Target:
    """Where the tool should be, in the world frame.

    Args:
        p_world_tool: position of the tool's origin [3], m.
        R_world_tool: orientation of the tool [3, 3], for a full pose.
        axis_world_tool: direction of the tool's z axis [3], any length; the rotation about it stays free.

    Raises:
        InputError: for a wrong shape, NaN, infinity, a matrix that is no rotation, an axis of length 0, or both.
    """

    kind: TargetKind
    p_world_tool: Floats
    R_world_tool: Floats
    """[3, 3]: the pose asked for; of an axis target only the last column; of a position target nothing."""

    def __init__(
        self,
        p_world_tool: ArrayLike,
        R_world_tool: ArrayLike | None = None,
        axis_world_tool: ArrayLike | None = None,
    ) -> None:
        if R_world_tool is not None and axis_world_tool is not None:
            raise InputError(NOT_BOTH)
        kind: TargetKind = "position"
        R = np.eye(3)
        if R_world_tool is not None:
            kind, R = "pose", _read(R_world_tool, "R_world_tool")
            check_rotation(R)
        elif axis_world_tool is not None:
            kind, R = "axis", rotation_with_z(_unit(_read_vector(axis_world_tool, "axis_world_tool", LONGEST)))
        self._set(kind, _read_vector(p_world_tool, "p_world_tool", FARTHEST), R)

    @property
    def axis_world_tool(self) -> Floats:
        """Direction asked of the tool's z axis [3]."""
        return self.R_world_tool[:, 2]

    def _set(self, kind: TargetKind, p_world_tool: Floats, R_world_tool: Floats) -> None:
        p_world_tool.setflags(write=False)
        R_world_tool.setflags(write=False)
        object.__setattr__(self, "kind", kind)
        object.__setattr__(self, "p_world_tool", p_world_tool)
        object.__setattr__(self, "R_world_tool", R_world_tool)


@dataclass(frozen=True, slots=True, init=False, eq=False)
class Targets:
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
        if R_world_tool is not None and axis_world_tool is not None:
            raise InputError(NOT_BOTH)
        p = _read_rows(p_world_tool, "p_world_tool", (3,), FARTHEST)
        kind, R = POSITION, np.broadcast_to(np.eye(3), (len(p), 3, 3))
        if R_world_tool is not None:
            kind, R = POSE, _read_rotations(R_world_tool)
        elif axis_world_tool is not None:
            axes = _read_rows(axis_world_tool, "axis_world_tool", (3,), LONGEST)
            _refuse_row(length(axes) > SHORTEST, "axis_world_tool", lambda row: NO_DIRECTION)
            kind, R = AXIS, rotation_with_z(_unit(axes))
        if len(R) != len(p):
            name = "R_world_tool" if kind == POSE else "axis_world_tool"
            raise InputError(f"expected {len(p)} rows, as many as positions, got {len(R)}", (name,))
        self._set(np.full(len(p), kind, dtype=np.int64), np.concatenate([R, p[:, :, None]], axis=2))

    @classmethod
    def of(cls, targets: "Targets | Sequence[Target]") -> "Targets":
        """Targets of any kinds from a sequence of `Target`; `Targets` are given back as they are."""
        if isinstance(targets, Targets):
            return targets
        T_world_tool = np.empty((len(targets), 3, 4))
        for row, target in zip(T_world_tool, targets, strict=True):
            row[:, :3] = target.R_world_tool
            row[:, 3] = target.p_world_tool
        return cls.packed(np.array([KINDS.index(target.kind) for target in targets], dtype=np.int64), T_world_tool)

    @classmethod
    def packed(cls, kind: Ints, T_world_tool: Floats) -> Self:
        """Targets from arrays that are known to be right: kinds [T] and poses [T, 3, 4]. They become read-only."""
        targets = cls.__new__(cls)
        targets._set(np.ascontiguousarray(kind), np.ascontiguousarray(T_world_tool))
        return targets

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

    def take(self, rows: Ints) -> "Targets":
        """The targets of these rows, in this order."""
        return Targets.packed(self.kind[rows], self.T_world_tool[rows])

    def __len__(self) -> int:
        return len(self.kind)

    def __iter__(self) -> Iterator[Target]:
        return (self[row] for row in range(len(self)))

    @overload
    def __getitem__(self, index: int) -> Target: ...

    @overload
    def __getitem__(self, index: slice) -> "Targets": ...

    def __getitem__(self, index: int | slice) -> "Target | Targets":
        if isinstance(index, slice):
            return Targets.packed(self.kind[index], self.T_world_tool[index])
        T, target = self.T_world_tool[index], Target.__new__(Target)
        target._set(KINDS[self.kind[index]], T[:, 3].copy(), T[:, :3].copy())
        return target

    def __reduce__(self) -> tuple:
        return Targets.packed, (self.kind, self.T_world_tool)  # arrays that travel arrive writable

    def _set(self, kind: Ints, T_world_tool: Floats) -> None:
        kind.setflags(write=False)
        T_world_tool.setflags(write=False)
        object.__setattr__(self, "kind", kind)
        object.__setattr__(self, "T_world_tool", T_world_tool)


def _read(values: ArrayLike, name: str) -> Floats:
    try:
        return np.array(values, dtype=float)
    except (TypeError, ValueError):
        raise InputError(f"expected numbers, got {values!r}", (name,)) from None


def _read_vector(values: ArrayLike, name: str, farthest: float) -> Floats:
    vector = _read(values, name)
    if vector.shape != (3,):
        raise InputError(
            f"expected 3 numbers, got {'shape ' + str(vector.shape) if vector.ndim != 1 else vector.size}", (name,)
        )
    if not np.all(np.abs(vector) <= farthest):  # False for NaN
        raise InputError(f"expected finite numbers up to {farthest:g}, got {vector.tolist()}", (name,))
    return vector


def _unit(axes: Floats) -> Floats:
    """Directions [..., 3] of vectors that have one."""
    lengths = length(axes)
    if not np.all(lengths > SHORTEST):
        raise InputError(NO_DIRECTION, ("axis_world_tool",))
    return axes / lengths[..., None]


def _read_rows(values: ArrayLike, name: str, shape: tuple[int, ...], farthest: float) -> Floats:
    """Arrays [T, *shape] of finite numbers up to `farthest`."""
    rows = _read(values, name)
    if rows.shape[1:] != shape or rows.ndim != len(shape) + 1:
        expected = ", ".join(["T", *map(str, shape)])
        raise InputError(f"expected an array [{expected}], got shape {rows.shape}", (name,))
    good = np.all(np.abs(rows) <= farthest, axis=tuple(range(1, rows.ndim)))  # False for NaN
    _refuse_row(good, name, lambda row: f"expected finite numbers up to {farthest:g}, got {rows[row].tolist()}")
    return rows


def _read_rotations(values: ArrayLike) -> Floats:
    R = _read(values, "R_world_tool")
    if R.shape[1:] != (3, 3):
        raise InputError(f"expected an array [T, 3, 3], got shape {R.shape}", ("R_world_tool",))
    with np.errstate(all="ignore"):
        good = np.isfinite(R).all(axis=(1, 2)) & are_rotations(R)
    _refuse_row(good, "R_world_tool", lambda row: check_rotation(R[row]))
    return R


def _refuse_row(good: NDArray[np.bool_], name: str, complain: Callable[[int], str | None]) -> None:
    """Raise `InputError` for the first row that is not good."""
    if good.all():
        return
    row = int(np.argmin(good))
    try:
        message = complain(row)
    except InputError as error:
        message = error.message
    raise InputError(str(message), (name, row))
