"""What the engine `lm` asks of a robot, read from its tables: the twin of what `model/generate` writes."""

from typing import NamedTuple

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.kernels.damped import DescentWorkspace, make_descent_workspace
from ikde.kernels.damped import take_step as take_damped_step
from ikde.kernels.flat_arguments import unpack_models
from ikde.kernels.jit import kernel, leaf_kernel
from ikde.kernels.placing import place_bodies, place_bounds
from ikde.kernels.world import find_placed_obstacle, find_placed_pair

LANES = 16
TASK_ROWS = 6  # rows of the tool's Jacobian


class Buffers(NamedTuple):
    """Room for one lane's numbers."""

    step: DescentWorkspace
    centres: Floats  # [3, S] m
    bounds: Floats  # [C, 4] m, and whether a component's spheres are placed


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
        np.empty((collision.components.shape[0], 4)),
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


@leaf_kernel
def find_collision(robot, collision, q, buffers):
    """Index of the first of the robot's own pairs within the safe distance at `q` [N], or -1.

    What is written for a robot of many spheres searches by it, so it shares nothing with `grade_one` but sines.
    """
    T_world_body, bounds = buffers.step.T_world_body, buffers.bounds
    place_bodies(robot, q, T_world_body)
    place_bounds(collision, T_world_body, bounds)
    return find_placed_pair(collision, T_world_body, bounds, buffers.centres, 0)


@leaf_kernel
def find_around(block, robot, collision, q, buffers, room):
    """What of a world is too near, as `world.find_obstacle_at`; where everything is, `find_collision` has found."""
    return find_placed_obstacle(collision, buffers.step.T_world_body, buffers.bounds, buffers.centres)
