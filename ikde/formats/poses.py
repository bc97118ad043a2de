"""Positions and orientations as users write them: to metres and rotations."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from ikde.errors import InputError
from ikde.formats.entries import OrientationEntry, OrientationKind, UnitsEntry, chosen_orientation
from ikde.kernels.arrays import Floats
from ikde.model.rotation import rotation_from_quat_wxyz, rotation_from_rpy
from ikde.model.target import Target, Targets

Orientation = Mapping[str, Floats]
"""Keyword of `Target` -> its value; empty for a position target."""


def read_position(key: str | int, values: ArrayLike, units: UnitsEntry) -> Floats:
    """A point in m that a target can stand at."""
    try:
        return Target(np.array(values) * units.length_m).p_world_tool
    except InputError as error:
        raise InputError(f"{error.message} (in m)", (key,)) from None


def read_orientation(entry: OrientationEntry, units: UnitsEntry) -> Orientation:
    """What `Target` takes, checked once for all targets that share it."""
    kind = chosen_orientation(entry)
    if kind is None:
        return {}
    values = np.array(getattr(entry, kind)) * (units.angle_rad if kind == "rpy" else 1.0)
    try:
        orientation = make_orientation(kind, values)
        Target((0.0, 0.0, 0.0), **orientation)
    except InputError as error:
        raise InputError(error.message, (kind,)) from None
    return orientation


def make_orientation(kind: OrientationKind, values: Floats) -> dict[str, Floats]:
    """What `Target` and `Targets` take, from axes [..., 3], roll, pitch, yaw [..., 3] in rad, or quaternions [..., 4].

    Raises `InputError` for a quaternion of length 0.
    """
    if kind == "axis":
        return {"axis_world_tool": np.asarray(values)}
    rotate = rotation_from_rpy if kind == "rpy" else rotation_from_quat_wxyz
    return {"R_world_tool": rotate(np.asarray(values))}


def join_poses(kind: int, p_world_tool: Floats, R_world_tool: Floats) -> Targets:
    """Targets of one kind from positions [T, 3] and rotations [T, 3, 3] or [3, 3] that are known to be right."""
    T_world_tool = np.empty((len(p_world_tool), 3, 4))
    T_world_tool[:, :, :3] = R_world_tool
    T_world_tool[:, :, 3] = p_world_tool
    return Targets.packed(np.full(len(p_world_tool), kind, dtype=np.int64), T_world_tool)
