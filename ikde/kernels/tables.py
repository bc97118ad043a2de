"""What the engine `lm` asks of a robot, read from its tables: the twin of what `model/generate` writes."""

from typing import NamedTuple

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.kernels.clearance import find_colliding_pair
from ikde.kernels.damped import DescentWorkspace, make_descent_workspace
from ikde.kernels.damped import take_step as take_damped_step
from ikde.kernels.frames import compute_bodies
from ikde.kernels.jit import kernel
from ikde.kernels.spheres import compute_bounds, compute_centres

LANES = 16
TASK_ROWS = 6  # rows of the tool's Jacobian


class Buffers(NamedTuple):
    """Room for one lane's numbers."""

    step: DescentWorkspace
    centres: Floats  # [3, S] m
    bounds: Floats  # [C, 3] m


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
    """Index of the first pair within the safe distance at `q` [N], or -1."""
    T_world_body = buffers.step.T_world_body
    compute_bodies(robot, q, T_world_body)
    compute_bounds(collision, T_world_body, buffers.bounds)
    compute_centres(collision, T_world_body, buffers.centres)
    return find_colliding_pair(collision, buffers.bounds, buffers.centres)
