"""Joint values as users give them: an array in the robot's order, or a mapping by joint name."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from ikde.errors import InputError, nearest, quoted
from ikde.kernels.arrays import Floats
from ikde.model.convention import from_convention
from ikde.model.numbers import read_numbers
from ikde.model.robot import MAX_MAGNITUDE, Robot

JointValues = ArrayLike | Mapping[str, float]


def read_joints(
    robot: Robot, q: JointValues, convention: str | None = None, *, default: Floats | None = None, argument: str = "q"
) -> Floats:
    """Return q [..., N] in the robot's own convention, m and rad.

    A mapping may leave joints out only if `default` [N] is given. Raises `InputError`, with the name of the argument,
    for a wrong count, an unknown joint, NaN or infinity.
    """
    if isinstance(q, Mapping):
        full = _fill(robot, q, default, argument)
        given = from_convention(robot, _from_array(robot, full, argument), convention)
        return given if default is None else _keep(robot, q, given, default)
    return from_convention(robot, _from_array(robot, q, argument), convention)


def read_configuration(robot: Robot, q: JointValues, convention: str | None = None) -> Floats:
    """Like `read_joints`, for exactly one configuration [N]."""
    values = read_joints(robot, q, convention)
    if values.ndim != 1:
        raise InputError(f"expected one configuration, got shape {values.shape}", ("q",))
    return values


def _from_array(robot: Robot, q: ArrayLike, argument: str) -> Floats:
    values = read_numbers(q, (argument,))
    names = robot.joint_names
    if values.ndim == 0 or values.shape[-1] != len(names):
        count = values.shape[-1] if values.ndim else 1
        raise InputError(f"expected {len(names)} joint values ({', '.join(names)}), got {count}", (argument,))
    if not (np.abs(values) <= MAX_MAGNITUDE).all():  # False for NaN
        raise InputError(f"expected finite joint values below {MAX_MAGNITUDE:g}, got {values.tolist()}", (argument,))
    return values


def _fill(robot: Robot, q: Mapping[str, float], default: Floats | None, argument: str) -> list[float]:
    """The values by joint, 0 where there is none; raises `InputError` unless they may be left out."""
    names = robot.joint_names
    for name in q:
        if name not in names:
            unknown = f"{robot.name} has no joint {quoted(name)}{nearest(str(name), names)}"
            raise InputError(unknown, (argument, str(name)))
    missing = [name for name in names if name not in q]
    if missing and default is None:
        raise InputError(f"no value for {', '.join(missing)}", (argument,))
    return [q.get(name, 0.0) for name in names]


def _keep(robot: Robot, q: Mapping[str, float], given: Floats, default: Floats) -> Floats:
    return np.array([given[i] if name in q else default[i] for i, name in enumerate(robot.joint_names)])


def joints_outside(robot: Robot, q: Floats) -> tuple[str, ...]:
    """Names of the joints of `q` [N] outside their limits; exactly on a limit is inside."""
    pairs = zip(robot.joints, q, strict=True)
    return tuple(joint.name for joint, value in pairs if not joint.lower <= value <= joint.upper)
