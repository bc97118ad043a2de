"""What the engine `lm` asks of a robot, read from its tables: the twin of what `model/generate` writes."""

from typing import NamedTuple

import numpy as np

from ikde.kernels.arrays import BODY, COORDINATE, FIRST, LAST, PARENT, PRISMATIC, Floats
from ikde.kernels.clearance import find_own_pair
from ikde.kernels.damped import DescentWorkspace, make_descent_workspace
from ikde.kernels.damped import take_step as take_damped_step
from ikde.kernels.flat_arguments import unpack_models
from ikde.kernels.jit import inline_kernel, kernel
from ikde.kernels.trig import sin_cos

LANES = 16
TASK_ROWS = 6  # rows of the tool's Jacobian


class Buffers(NamedTuple):
    """Room for one lane's numbers."""

    step: DescentWorkspace
    centres: Floats  # [3, S] m
    bounds: Floats  # [C, 3] m


def use_models(robot, collision):
    """What the kernels here take of both models: all of it."""
    return robot, collision


@kernel
def unpack_used(numbers, whole):
    """Both models out of the block of a search (`flatten_search`)."""
    return unpack_models(numbers[whole[2] :], whole[whole[3] :])


@kernel
def make_buffers(robot, collision, joints):
    """Allocate the buffers for a robot and a collision model."""
    return Buffers(
        make_descent_workspace(robot, joints, TASK_ROWS),
        np.empty((3, collision.radius.size)),
        np.empty((collision.components.shape[0], 3)),
    )


@kernel
def take_step(robot, target, index, ranges, descent, q, buffers):
    """One damped least-squares step on `q` [N] in place; returns the errors before it, m and rad."""
    return take_damped_step(robot, target, index, ranges, descent, q, buffers.step)


@kernel
def take_steps(robot, target, row, ranges, descent, q, T, errors, trial, buffers):
    """A step in every lane that has a target: `row` [LANES], `q` [N * LANES], `errors` [2 * LANES] in m and rad."""
    for lane in range(LANES):
        if row[lane] < 0:
            continue
        for k in range(trial.size):
            trial[k] = q[lane + k * LANES]
        errors[lane], errors[lane + LANES] = take_step(robot, target, row[lane], ranges, descent, trial, buffers)
        for k in range(trial.size):
            q[lane + k * LANES] = trial[k]


@kernel
def find_collision(robot, collision, q, buffers):
    """Index of the first of the robot's own pairs within the safe distance at `q` [N], or -1.

    What is written for a robot of many spheres searches by it, so it shares nothing with `grade_one` but sines.
    """
    T_world_body = buffers.step.T_world_body
    place_bodies(robot, q, T_world_body)
    place_spheres(collision, T_world_body, buffers.bounds, buffers.centres)
    return find_own_pair(collision, buffers.bounds, buffers.centres)


@inline_kernel
def place_bodies(robot, q, out_T):
    """Pose of every body in the world: T_world_parent @ T_parent_body @ (Rz(q) or Tz(q)). `out_T` [B, 3, 4]."""
    for i in range(3):
        for j in range(4):
            out_T[0, i, j] = 1.0 if i == j else 0.0
    for body in range(1, robot.bodies.shape[0]):
        T, parent = robot.T_parent_body[body], out_T[np.uint64(robot.bodies[body, PARENT])]
        value = q[robot.bodies[body, COORDINATE]]
        s, c = sin_cos(value)
        along = 0.0
        if robot.bodies[body, PRISMATIC] == 1:
            s, c, along = 0.0, 1.0, value
        for i in range(3):
            x, y = apply_row(parent, i, T[0, 0], T[1, 0], T[2, 0]), apply_row(parent, i, T[0, 1], T[1, 1], T[2, 1])
            z, p = apply_row(parent, i, T[0, 2], T[1, 2], T[2, 2]), apply_row(parent, i, T[0, 3], T[1, 3], T[2, 3])
            out_T[body, i, 0], out_T[body, i, 1] = x * c + y * s, y * c - x * s
            out_T[body, i, 2], out_T[body, i, 3] = z, parent[i, 3] + p + z * along


@inline_kernel
def place_spheres(collision, T_world_body, out_bounds, out_centres):
    """Middles [C, 3] of the components and centres [3, S] of their spheres in the world, m."""
    p = collision.p_body_sphere
    for component in range(collision.components.shape[0]):
        T, middle = T_world_body[collision.components[component, BODY]], collision.bounds[component]
        for i in range(3):
            out_bounds[component, i] = apply_row(T, i, middle[0], middle[1], middle[2]) + T[i, 3]
            a, b, c, d = T[i, 0], T[i, 1], T[i, 2], T[i, 3]
            for sphere in range(collision.components[component, FIRST], collision.components[component, LAST]):
                out_centres[i, sphere] = a * p[0, sphere] + b * p[1, sphere] + c * p[2, sphere] + d


@inline_kernel
def apply_row(T, i, x, y, z):
    """Entry `i` of the rotation of `T` [3, 4] times (x, y, z)."""
    return T[i, 0] * x + T[i, 1] * y + T[i, 2] * z
