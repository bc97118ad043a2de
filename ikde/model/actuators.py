"""What moves a robot: its joints, the twist of its base and the arm's joints, or its wheels and the arm's joints."""

from typing import Literal, get_args

import numpy as np

from ikde.errors import InputError, quoted
from ikde.kernels.arrays import Floats
from ikde.model.base_motion import find_planar_base, usual_drive
from ikde.model.robot import Robot
from ikde.model.wheels import twist_by_wheels, wheel_names, wheels_by_twist

By = Literal["joints", "twist", "actuators"]
TWIST = ("base_forward", "base_left", "base_turn")
DEFAULT_SPEED = {"prismatic": 0.5, "revolute": 0.5 * np.pi, "continuous": 0.5 * np.pi}
"""m/s and rad/s where a robot gives none: the print's 10 as 10 mm in a sample of 20 ms [Qiao2022, section 4]."""


def actuator_names(robot: Robot, by: By) -> tuple[str, ...]:
    """What each speed is called, in order: of the base first, then of all other joints as in q.

    `joints`: the joints as they are. `twist`: `base_forward`, `base_left` and `base_turn` in place of the joints of a
    planar base; a differential base has no `base_left`. `actuators`: its wheels in place of them; of an omnidirectional
    base, whose wheels are not known, the twist. Without a planar base all three are the joints.

    Raises:
        InputError: for another word; for the actuators of a base with wheels that its file does not describe.
    """
    if by not in get_args(By):
        raise InputError(f"expected one of {', '.join(get_args(By))}, got {quoted(by)}", ("by",))
    base = find_planar_base(robot)
    if by == "joints" or base[0] < 0:
        return robot.joint_names
    others = tuple(name for place, name in enumerate(robot.joint_names) if place not in base)
    drive = usual_drive(robot)
    if by == "twist" or drive == "omnidirectional":
        return (*(TWIST[::2] if drive == "differential" else TWIST), *others)
    if robot.wheels is None:
        message = f"{robot.name} has a {drive} base without `wheels` in its file; expected joints or twist"
        raise InputError(message, ("by",))
    return (*wheel_names(robot.wheels), *others)


def speeds_by(robot: Robot, q: Floats, by: By) -> Floats:
    """The matrix [..., N, A] that makes speeds of the joints of speeds of actuators, at `q` [..., N].

    m/s and rad/s; wheels in rad/s. Columns and errors are those of `actuator_names`.
    """
    names, base = actuator_names(robot, by), find_planar_base(robot)
    if by == "joints" or base[0] < 0:
        return np.broadcast_to(np.eye(len(names)), (*q.shape[:-1], len(names), len(names))).copy()
    drive, wheels = usual_drive(robot), robot.wheels if by == "actuators" else None
    if wheels is not None and drive != "omnidirectional":
        twist = twist_by_wheels(wheels)
    else:
        twist = np.eye(3)[:, ::2] if drive == "differential" else np.eye(3)
    out = np.zeros((*q.shape[:-1], q.shape[-1], len(names)))
    cos, sin = np.cos(q[..., base[2], None]), np.sin(q[..., base[2], None])
    count = twist.shape[1]
    out[..., base[0], :count] = cos * twist[0] - sin * twist[1]
    out[..., base[1], :count] = sin * twist[0] + cos * twist[1]
    out[..., base[2], :count] = twist[2]
    for column, name in enumerate(names[count:], count):
        out[..., robot.joint_names.index(name), column] = 1.0
    return out


def joint_speeds(robot: Robot) -> Floats:
    """Speed limits [N] of the joints, m/s and rad/s; where the robot's file gives none, 0.5 m/s or pi/2 rad/s."""
    return np.array([joint.max_speed or DEFAULT_SPEED[joint.kind] for joint in robot.joints])


def speed_limits(robot: Robot, by: By) -> Floats:
    """Speed limits [A] of the actuators, m/s and rad/s; columns and errors are those of `actuator_names`.

    A base drives with the lower of the limits of its x and y; a wheel as fast as the limits of the base need at most.
    """
    names, base, joints = actuator_names(robot, by), find_planar_base(robot), joint_speeds(robot)
    if by == "joints" or base[0] < 0:
        return joints
    straight = min(joints[base[0]], joints[base[1]])
    twist = np.array([straight, straight, joints[base[2]]])
    others = [joints[robot.joint_names.index(name)] for name in names if name in robot.joint_names]
    drive = usual_drive(robot)
    if by == "actuators" and drive != "omnidirectional" and robot.wheels is not None:
        return np.array([*(np.abs(wheels_by_twist(robot.wheels)) @ twist), *others])
    return np.array([*(twist[::2] if drive == "differential" else twist), *others])
