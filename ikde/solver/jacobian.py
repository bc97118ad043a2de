"""How fast a frame moves: its Jacobian by joints, by the twist of a base or by its wheels, in plain numpy."""

from typing import Literal, get_args

import numpy as np

from ikde.errors import InputError, nearest, quoted
from ikde.kernels.arrays import Floats
from ikde.model.actuators import By, speeds_by
from ikde.model.arguments import RobotLike, read_robot
from ikde.model.robot import TOOL, WORLD, Robot
from ikde.solver.joints import JointValues, read_joints
from ikde.solver.plain import compute_frames

Axes = Literal["world", "frame"]
ASKED_ROWS = {"free": 3, "axis": 5, "pose": 6}
"""How many directions of the tool a path asks for: its velocity, rotations of its axis, the rotation about its axis."""


def jacobian(
    robot: RobotLike,
    q: JointValues,
    *,
    frame: str = TOOL,
    axes: Axes = "world",
    by: By = "joints",
    convention: str | None = None,
) -> Floats:
    """Velocity and angular velocity of a frame, by the speed of each joint or actuator.

    Args:
        robot: the robot, its name or the path of its file.
        q: joint values [N] or [..., N] in the robot's order, or a mapping by joint name; m and rad.
        frame: whose motion: the tool, or a frame or a tool by its name; it is the velocity of its origin.
        axes: what the rows are along: the axes of the `world`, or those of the `frame` itself.
        by: what the columns are of. `joints`: all joints in the order of q; those that do not move the frame are 0.
            `twist`: of a planar base its speed forward, to the left (not of a differential base) and its turn to the
            left, then all other joints. `actuators`: its wheels, left and right, or front left, rear left, rear right
            and front right, then all other joints; of an omnidirectional base, whose wheels are not known, the twist.
            A robot without a planar base has the same columns in each case.
        convention: how `q` is counted; None for the robot's own.

    Returns:
        [..., 6, columns]: three rows in m and three in rad, a m (prismatic joints, twist) or a rad (other joints, the
        base's turn, wheels) of what the column is of.

    Raises:
        InputError: for a wrong `q` as in `forward`, an unknown frame or word, and for the actuators of a base with
            wheels that the robot's file does not describe.
    """
    robot = read_robot(robot)
    q = read_joints(robot, q, convention)
    if axes not in get_args(Axes):
        raise InputError(f"expected one of {', '.join(get_args(Axes))}, got {quoted(axes)}", ("axes",))
    return frame_jacobian(robot, q, find_frame(robot, frame), axes) @ speeds_by(robot, q, by)


def find_frame(robot: Robot, name: str) -> str:
    """The frame that is called so, the tool by any of its names; raises `InputError`, at `frame`, if none is."""
    known = {frame.name: frame.name for frame in robot.frames} | dict(robot.tools) | {TOOL: robot.tool}
    if name not in known:
        raise InputError(f"{robot.name} has no frame {quoted(name)}{nearest(str(name), known)}", ("frame",))
    return known[name]


def frame_jacobian(robot: Robot, q: Floats, frame: str, axes: Axes = "world") -> Floats:
    """The same of a frame by its own name, by all joints, for `q` [..., N]: [..., 6, N]."""
    Ts_world = compute_frames(robot, q)
    p, to_frame = Ts_world[frame][..., :3, 3], Ts_world[frame][..., :3, :3].mT
    out = np.zeros((*q.shape[:-1], 6, q.shape[-1]))
    moved_by = {own.name: own for own in robot.frames}
    for name in _chain(robot, frame):
        own = moved_by[name]
        if own.joint is None or own.axis is None:
            continue
        place = robot.joint_names.index(own.joint)
        axis = Ts_world[name][..., :3, :3] @ own.axis
        if robot.joints[place].kind == "prismatic":
            out[..., :3, place] = axis
        else:
            out[..., :3, place], out[..., 3:, place] = np.cross(axis, p - Ts_world[name][..., :3, 3]), axis
    return out if axes == "world" else np.concatenate([to_frame @ out[..., :3, :], to_frame @ out[..., 3:, :]], axis=-2)


def smallest_singular_values(
    robot: Robot, q: Floats, base_joints: tuple[str, ...] = (), orientation: str = "pose"
) -> Floats:
    """Of the tool's Jacobian in m and rad by the joints of the arm, for `q` [..., N]; 0 in a singularity.

    Its rows are what a path with this orientation asks for; an arm with fewer joints than that is always singular. The
    joints of a base are left out: with them a mobile robot is hardly ever singular.
    """
    rows = ASKED_ROWS[orientation]
    own = arm_jacobian(robot, q, base_joints)[..., :rows, :]
    if own.shape[-1] < rows or not own.size:
        return np.zeros(q.shape[:-1])
    return np.linalg.svd(own, compute_uv=False)[..., -1]  # type: ignore[return-value]


def arm_jacobian(robot: Robot, q: Floats, base_joints: tuple[str, ...] = ()) -> Floats:
    """Velocity and angular velocity of the tool in its own frame [..., 6, n], by the joints of the arm."""
    places = [place for place in find_chain(robot, robot.tool) if robot.joint_names[place] not in base_joints]
    return frame_jacobian(robot, q, robot.tool, "frame")[..., places]


def find_chain(robot: Robot, frame: str) -> list[int]:
    """Places in q of the joints that move a frame, from the world on."""
    joint_of = {own.name: own.joint for own in robot.frames}
    return [robot.joint_names.index(joint) for name in _chain(robot, frame) if (joint := joint_of[name])]


def _chain(robot: Robot, frame: str) -> list[str]:
    """Frames from the world to this one."""
    parents = {own.name: own.parent for own in robot.frames}
    chain = [frame]
    while parents[chain[-1]] != WORLD:
        chain.append(parents[chain[-1]])
    return chain[::-1]
