"""Tasks of `ikde.velocity` as rows: what moves them, and how fast each should be."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ikde.errors import InputError, nearest, quoted
from ikde.kernels.arrays import Floats, Ints
from ikde.model.base_motion import find_planar_base
from ikde.model.robot import WORLD, Robot
from ikde.model.target import Target
from ikde.solver.jacobian import find_frame
from ikde.track.velocity_task import VelocityTask

ROTATION_M = 0.3
"""How many m a rad counts where rows of both kinds are weighed against each other: about the reach of a wrist."""


class TaskRows(NamedTuple):
    """One task at one configuration."""

    matrix: Floats
    """[m, N] by the joints, m or rad"""
    wanted: Floats
    """[m] m/s and rad/s"""
    weights: Floats
    """[m] what a unit of each row counts, in m"""
    error: Floats
    """[m] how far it is from where it should be, m and rad; 0 without a place."""


def make_rows(robot: Robot, q: Floats, task: VelocityTask, Ts_world: dict[str, Floats]) -> TaskRows:
    """The rows of a task at `q` [N] with its frames; raises `InputError` if it does not fit the robot."""
    if task.kind == "tool":
        return _make_tool_rows(robot, task, Ts_world)
    return _make_base_rows(robot, q, task) if task.kind == "base" else _make_joint_rows(robot, q, task)


def _make_tool_rows(robot: Robot, task: VelocityTask, Ts_world: dict[str, Floats]) -> TaskRows:
    frame = find_frame(robot, task.frame)
    T, target = Ts_world[frame], task.target
    J = _fill_jacobian(robot, Ts_world, frame)
    given = np.zeros(6)
    if task.velocity is not None:
        given[: len(task.velocity)] = task.velocity
    if target is None:
        count = 3 if task.velocity is None else len(task.velocity)
        J, given = J[:count], given[:count]
        error = np.zeros(count)
    else:
        error = np.concatenate([target.p_world_tool - T[:3, 3], _find_rotation(target, T[:3, :3])])
        if target.kind == "position":
            J, given, error = J[:3], given[:3], error[:3]
        elif target.kind == "axis":
            across = T[:3, :2].T
            J, given, error = (np.concatenate([part[:3], across @ part[3:]]) for part in (J, given, error))
    fastest = float(np.linalg.norm(error[:3])) if error[:3].any() else ROTATION_M * float(np.linalg.norm(error[3:]))
    weights = np.r_[np.ones(3), np.full(len(error) - 3, ROTATION_M)]
    return TaskRows(J, _limit(task, error, fastest) + given, weights, error)


def _find_rotation(target: Target, R: Floats) -> Floats:
    """The rotation vector [3] in the world that takes the frame to the target; 0 for a position."""
    if target.kind == "position":
        return np.zeros(3)
    if target.kind == "axis":
        axis = np.cross(R[:, 2], target.axis_world_tool)
        sine, cosine = float(np.linalg.norm(axis)), float(R[:, 2] @ target.axis_world_tool)
        if sine < 1e-12:
            return np.zeros(3) if cosine > 0.0 else np.pi * R[:, 0]
        return axis * (np.arctan2(sine, cosine) / sine)
    return rotation_vector(target.R_world_tool @ R.T)


def rotation_vector(R: Floats) -> Floats:
    """Axis times angle [3] of a rotation [3, 3], the angle in [0, pi]; exact near 0 and near half a turn."""
    skew = 0.5 * np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    sine, cosine = float(np.linalg.norm(skew)), 0.5 * (float(np.trace(R)) - 1.0)
    angle = np.arctan2(sine, cosine)
    if cosine > -0.9:
        return skew * (angle / sine if sine > 1e-12 else 1.0)
    symmetric = 0.5 * (R + R.T) - cosine * np.eye(3)  # (1 - cosine) axis axis^T
    column = symmetric[:, int(np.argmax(np.diagonal(symmetric)))]
    axis = column / np.linalg.norm(column)
    return angle * (axis if skew @ axis >= 0.0 else -axis)


def _fill_jacobian(robot: Robot, Ts_world: dict[str, Floats], frame: str) -> Floats:
    """Velocity and angular velocity [6, N] of a frame along the world's axes, by the joints."""
    chain = _list_chain(robot, frame)
    out = np.zeros((6, len(robot.joints)))
    if not chain.names:
        return out
    Ts = np.array([Ts_world[name] for name in chain.names])
    axes = (Ts[:, :3, :3] @ chain.axes[:, :, None])[:, :, 0]
    arms = Ts_world[frame][:3, 3] - Ts[:, :3, 3]
    prismatic = chain.is_prismatic[:, None]
    x, y, z = axes.T
    a, b, c = arms.T
    across = np.stack([y * c - z * b, z * a - x * c, x * b - y * a], axis=1)  # a third of the time of numpy's cross
    out[:3, chain.places] = np.where(prismatic, axes, across).T
    out[3:, chain.places] = np.where(prismatic, 0.0, axes).T
    return out


class _Chain(NamedTuple):
    names: tuple[str, ...]
    places: Ints
    axes: Floats
    is_prismatic: NDArray[np.bool_]


@lru_cache(maxsize=256)
def _list_chain(robot: Robot, frame: str) -> _Chain:
    """The moving frames from the world to this one."""
    known, joints = {own.name: own for own in robot.frames}, robot.joint_names
    found, at = [], frame
    while at != WORLD:
        own = known[at]
        if own.joint is not None and own.axis is not None:
            found.append((own.name, joints.index(own.joint), own.axis))
        at = own.parent
    names = tuple(name for name, _, _ in found)
    places = np.array([place for _, place, _ in found], dtype=np.int64)
    axes = np.array([axis for _, _, axis in found]).reshape(-1, 3)
    return _Chain(names, places, axes, robot.is_prismatic[places])


def _make_base_rows(robot: Robot, q: Floats, task: VelocityTask) -> TaskRows:
    base = find_planar_base(robot)
    if base[0] < 0:
        raise InputError(f"{robot.name} has no planar base (x, y, yaw) to move", ("base",))
    given = task.velocity if task.place is None else task.place
    count = 3 if given is None else len(given)
    matrix, error = np.zeros((count, len(q))), np.zeros(count)
    matrix[np.arange(count), base[:count]] = 1.0
    if task.place is not None:
        error = task.place - q[base[:count]]
        if count == 3 and robot.joints[base[2]].kind == "continuous":
            error[2] = np.pi - (np.pi - error[2]) % (2.0 * np.pi)
    fastest = float(np.linalg.norm(error[:2])) if error[:2].any() else ROTATION_M * float(np.abs(error[2:]).sum())
    wanted = _limit(task, error, fastest) + (0.0 if task.velocity is None else task.velocity)
    return TaskRows(matrix, wanted, np.array([1.0, 1.0, ROTATION_M])[:count], error)


def _make_joint_rows(robot: Robot, q: Floats, task: VelocityTask) -> TaskRows:
    names = tuple(dict.fromkeys([*task.values, *task.rates]))
    known = robot.joint_names
    for name in names:
        if name not in known:
            raise InputError(f"{robot.name} has no joint {quoted(name)}{nearest(str(name), known)}", ("joints",))
    places = [known.index(name) for name in names]
    matrix = np.zeros((len(names), len(q)))
    matrix[np.arange(len(names)), places] = 1.0
    error = np.array([task.values[name] - q[known.index(name)] if name in task.values else 0.0 for name in names])
    for row, place in enumerate(places):
        if robot.joints[place].kind == "continuous":
            error[row] = np.pi - (np.pi - error[row]) % (2.0 * np.pi)
    rates = np.array([task.rates.get(name, 0.0) for name in names])
    return TaskRows(matrix, _limit(task, error, float(np.abs(error).max())) + rates, np.ones(len(names)), error)


def _limit(task: VelocityTask, error: Floats, fastest: float) -> Floats:
    """The speeds that take an error away, shortened to the largest one that is wanted."""
    asked = task.gain * fastest
    share = 1.0 if task.max_speed is None or asked <= task.max_speed else task.max_speed / asked
    return share * task.gain * error
