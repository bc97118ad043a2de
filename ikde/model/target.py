"""What the tool is asked to do: a position, a position with a tool axis direction, or a full pose."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from ikde.errors import InputError
from ikde.kernels.arrays import Floats
from ikde.model.rotation import check_rotation, rotation_with_z

FARTHEST = 1e6  # m: beyond it, doubles hold less than a nanometre
LONGEST = 1e100  # of an axis, whose length says nothing
TargetKind = Literal["position", "axis", "pose"]


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
            raise InputError("a target has a rotation (R_world_tool) or an axis (axis_world_tool), not both")
        kind: TargetKind = "position"
        R = np.eye(3)
        if R_world_tool is not None:
            kind, R = "pose", _read(R_world_tool, "R_world_tool")
            check_rotation(R)
        elif axis_world_tool is not None:
            kind, R = "axis", rotation_with_z(_unit(_read_vector(axis_world_tool, "axis_world_tool", LONGEST)))
        object.__setattr__(self, "kind", kind)
        object.__setattr__(self, "p_world_tool", _read_vector(p_world_tool, "p_world_tool", FARTHEST))
        object.__setattr__(self, "R_world_tool", R)
        self.p_world_tool.setflags(write=False)
        self.R_world_tool.setflags(write=False)

    @property
    def axis_world_tool(self) -> Floats:
        """Direction asked of the tool's z axis [3]."""
        return self.R_world_tool[:, 2]


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


def _unit(axis: Floats) -> Floats:
    length = np.linalg.norm(axis)
    if not length > 1e-12:
        raise InputError("an axis of length 0 has no direction", ("axis_world_tool",))
    return axis / length
