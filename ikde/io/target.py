"""A target as typed on the command line."""

from collections.abc import Sequence

import numpy as np

from ikde.errors import InputError
from ikde.formats.units import ANGLES_RAD, LENGTHS_M
from ikde.model.rotation import rotation_from_quat_wxyz, rotation_from_rpy
from ikde.model.target import Target

Numbers = Sequence[float]


def make_target(
    position: Numbers, quat_wxyz: Numbers | None, rpy: Numbers | None, axis: Numbers | None, unit: str, angles: str
) -> Target:
    """A target from a position in `unit` and at most one orientation; raises `InputError` for what makes none."""
    ways = {"--quat-wxyz": quat_wxyz, "--rpy": rpy, "--axis": axis}
    given = [name for name, value in ways.items() if value is not None]
    if len(given) > 1:
        raise InputError(f"{' and '.join(given)} both ask for an orientation; give one")
    for name, numbers in {"--position": position, **ways}.items():
        if numbers is not None and not np.all(np.isfinite(numbers)):
            raise InputError(f"expected finite numbers, got {' '.join(map(str, numbers))}", (name,))
    R = None
    if quat_wxyz is not None:
        R = rotation_from_quat_wxyz(np.array(quat_wxyz))
    elif rpy is not None:
        R = rotation_from_rpy(np.array(rpy) * ANGLES_RAD[angles])
    return Target(np.array(position) * LENGTHS_M[unit], R_world_tool=R, axis_world_tool=axis)
