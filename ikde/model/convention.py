"""Joint conventions: the same configuration, counted from other zero angles.

qiao2021 keeps q in the key-point convention of Table 1(b); Table 5 of the paper prints the classical one, where q5
is larger by pi. A shifted joint is brought to (-pi, pi], so both directions give one answer.
"""

import numpy as np

from ikde.errors import InputError
from ikde.kernels.arrays import Floats
from ikde.model.arguments import RobotLike, read_robot
from ikde.model.robot import Robot


def convention_offsets(robot: Robot, convention: str | None) -> Floats:
    """Offsets [N] in rad with q_convention = q + offset; all 0 for the robot's own convention (or None)."""
    if convention is None or convention == robot.convention:
        return np.zeros(len(robot.joints))
    if convention not in robot.conventions:
        known = ", ".join([robot.convention, *robot.conventions])
        raise InputError(f"{robot.name} has no convention {convention!r}; it has {known}")
    offsets = robot.conventions[convention]
    return np.array([offsets.get(name, 0.0) for name in robot.joint_names])


def from_convention(robot: RobotLike, q: Floats, convention: str | None) -> Floats:
    """From the named convention to the robot's own, inside the limits where a full turn allows it.

    Args:
        robot: the robot, its name or the path of its file.
        q: joint values [..., N] in the named convention, m and rad.
        convention: its name; None or the robot's own leaves `q` as it is.

    Returns:
        Joint values [..., N] in the robot's own convention.

    Raises:
        InputError: for an unknown convention.
    """
    robot = read_robot(robot)
    if convention is None or convention == robot.convention:
        return q
    offsets = convention_offsets(robot, convention)
    own = _wrap(q - offsets)
    for turn in (-2.0 * np.pi, 2.0 * np.pi):
        inside = (own >= robot.lower) & (own <= robot.upper)
        fits = (own + turn >= robot.lower) & (own + turn <= robot.upper)
        own = np.where(~inside & fits, own + turn, own)
    return np.where(offsets == 0.0, q, own)


def to_convention(robot: RobotLike, q: Floats, convention: str | None) -> Floats:
    """From the robot's own convention to the named one; a shifted joint comes out in (-pi, pi].

    Args:
        robot: the robot, its name or the path of its file.
        q: joint values [..., N] in the robot's own convention, m and rad.
        convention: the wanted one; None or the robot's own leaves `q` as it is.

    Returns:
        Joint values [..., N] in the named convention.

    Raises:
        InputError: for an unknown convention.
    """
    robot = read_robot(robot)
    offsets = convention_offsets(robot, convention)
    return np.where(offsets == 0.0, q, _wrap(q + offsets))


def _wrap(angle_rad: Floats) -> Floats:
    """Bring angles to (-pi, pi]."""
    return angle_rad - 2.0 * np.pi * np.ceil((angle_rad - np.pi) / (2.0 * np.pi))
