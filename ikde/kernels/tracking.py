"""Along a path, sample by sample: the tool meets each target, and every step keeps the limits.

A sample begins with the step before it, continued, and is refined by Gauss-Newton steps until the tool is where it
should be. The first of them takes the preferred step into account; the others change as little as they can.
"""

import math
from typing import NamedTuple

import numpy as np

from ikde.kernels.arrays import MANIPULABILITY, POSITION, Floats
from ikde.kernels.constrained_step import System, factor, make_system, measure_travel, solve_step, weigh
from ikde.kernels.damped import compute_error, scale_rotation
from ikde.kernels.drive import fold_row, set_step_box, take_drive_step
from ikde.kernels.frames import compute_bodies, compute_jacobian, compute_tool
from ikde.kernels.jit import inline_kernel, kernel, leaf_kernel
from ikde.kernels.nullspace import (
    MANIPULABILITY_STIFFNESS,
    avoid_contacts,
    avoid_limits,
    limit_preferred,
    raise_manipulability,
    start_preferred,
)
from ikde.kernels.step_constraints import StepConstraints, constrain_pairs, constrain_step, make_step_constraints

STIFFNESS = 1e6  # of the tool's error, against the preferred step, if both are measured in largest steps
USUAL_ROUNDS, STIFFER, STIFFEST = 3, 4.0, 1e12  # then it grows: near singularities the preferred step damps too much
SLACK = -1e-9  # m: constraints are kept to it
STUCK_ROUNDS = 4  # after so many, a step that cannot meet all constraints is given up

REACHED, STUCK, INFEASIBLE, NO_STEP = range(4)  # how a sample ends; NO_STEP: the box itself is empty


class Sample(NamedTuple):
    """Room for one sample's numbers."""

    T_world_body: Floats  # [B, 3, 4]
    T_world_tool: Floats  # [3, 4]
    joint_jacobian: Floats  # [6, N]
    jacobian: Floats  # [6, D] m, and radians times the rotation length; of the largest steps
    raw: Floats  # [6, D] m and rad
    weighted: Floats  # [6, D]
    error: Floats  # [6]
    preferred: Floats  # [D]
    system: System
    constraints: StepConstraints


@kernel
def make_sample(robot, collision, joints, size):
    """Allocate the room for a robot and steps [size]."""
    return Sample(
        np.empty((robot.bodies.shape[0], 3, 4)),
        np.empty((3, 4)),
        np.empty((6, joints)),
        np.empty((6, size)),
        np.empty((6, size)),
        np.empty((6, size)),
        np.empty(6),
        np.empty(size),
        make_system(size),
        make_step_constraints(collision, joints, size),
    )


@leaf_kernel
def compute_poses(robot, q, T_world_body, T_world_tool):
    """Poses of bodies and tool at `q` [N]."""
    compute_bodies(robot, q, T_world_body)
    compute_tool(robot, T_world_body, T_world_tool)


@leaf_kernel
def fill_step_jacobian(robot, drive, track, target, index, q, step, work):
    """The tool's Jacobian by the step [6, D], at the poses of its end, scaled; returns how many rows count."""
    compute_jacobian(robot, work.T_world_body, work.T_world_tool, work.joint_jacobian)
    scale_rotation(target, index, track.rotation_length, work.T_world_tool, work.joint_jacobian)
    rows = 3 if target.kind[index] == POSITION else 6
    for i in range(rows):
        fold_row(drive, q, step, work.joint_jacobian[i], work.jacobian[i])
    return rows


@leaf_kernel
def add_manipulability_gradient(robot, drive, track, target, index, weights, q, still, work):
    """Add the gradient of manipulability at `q` [N], whose poses are known, to the preferred step."""
    compute_jacobian(robot, work.T_world_body, work.T_world_tool, work.joint_jacobian)
    for i in range(6):
        fold_row(drive, q, still, work.joint_jacobian[i], work.raw[i])
    rows = fill_step_jacobian(robot, drive, track, target, index, q, still, work)
    stiffness = MANIPULABILITY_STIFFNESS / measure_travel(work.jacobian, rows)
    factor(work.jacobian, rows, stiffness, work.system.matrix, work.system.inverse)
    weigh(work.jacobian, rows, work.system.inverse, work.weighted)
    for i in range(6):
        scale = stiffness if i < 3 else stiffness * track.rotation_length
        for k in range(work.preferred.size):
            work.weighted[i, k] *= scale
    raise_manipulability(drive, weights, work.raw, work.weighted, work.preferred)


@leaf_kernel
def set_preferred_step(robot, collision, drive, track, target, index, weights, q, last, still, work):
    """What the null space is used for in the step from `q` [N] after the step `last` [D]; `still` [D] is zero."""
    compute_poses(robot, q, work.T_world_body, work.T_world_tool)
    start_preferred(weights, work.preferred)
    avoid_limits(drive, track, weights, q, work.preferred)
    count = constrain_pairs(robot, collision, drive, track, work.T_world_body, q, still, work.constraints)
    avoid_contacts(track, weights, count, work.constraints, work.preferred)
    if weights[MANIPULABILITY] > 0.0:
        add_manipulability_gradient(robot, drive, track, target, index, weights, q, still, work)
    limit_preferred(drive, last, work.preferred)


@inline_kernel
def find_min_slack(constraints, count, pairs_only):
    """Smallest slack in m of the first rows, or of the pairs among them; inf if there are none."""
    least = math.inf
    for i in range(count):
        if constraints.pair[i] >= 0 or not pairs_only:
            least = min(least, constraints.slack[i])
    return least


@leaf_kernel
def track_sample(robot, collision, drive, track, target, index, weights, q, last, first_step, work, out_q, out_step):
    """Step from `q` [N] so that the tool meets a target, to `out_q` [N] by `out_step` [D], and how that ended.

    `last` [D] is the step before, `weights` [3 + D] what the null space is used for. Returns the status, the rounds,
    and what the nearest pair keeps beyond the margin, m (inf: beyond the reach). Unless it is reached, the step is that
    of the last round.
    """
    for k in range(out_step.size):
        out_step[k] = 0.0
    set_preferred_step(robot, collision, drive, track, target, index, weights, q, last, out_step, work)
    if not set_step_box(drive, track.ranges, q, last, first_step, work.system.lower, work.system.upper):
        return NO_STEP, 0, 0.0
    for k in range(out_step.size):
        out_step[k] = min(max(last[k], work.system.lower[k]), work.system.upper[k])
    is_near, least, pull = False, math.inf, STIFFNESS
    for round_ in range(track.max_rounds):
        take_drive_step(drive, q, out_step, out_q)
        compute_poses(robot, out_q, work.T_world_body, work.T_world_tool)
        position, orientation = compute_error(target, index, track.rotation_length, work.T_world_tool, work.error)
        count = constrain_step(
            robot, collision, drive, track, work.T_world_body, work.T_world_tool, q, out_q, out_step, work.constraints
        )
        is_free = find_min_slack(work.constraints, count, False) >= SLACK
        least = find_min_slack(work.constraints, count, True)
        if round_ > 0 and is_free and position <= track.position_goal and orientation <= track.orientation_goal:
            return REACHED, round_, least
        is_near = is_free and position <= track.position_tolerance and orientation <= track.orientation_tolerance
        if round_ == track.max_rounds - 1:
            break
        rows = fill_step_jacobian(robot, drive, track, target, index, q, out_step, work)
        if round_ >= USUAL_ROUNDS:
            pull = min(STIFFER * pull, STIFFEST)
        stiffness = pull / measure_travel(work.jacobian, rows)
        parts = (work.preferred, work.constraints.slack, work.constraints.slope, count, work.system, out_step)
        found = solve_step(work.jacobian, work.error, rows, stiffness, *parts)
        if not found and round_ >= STUCK_ROUNDS:
            return INFEASIBLE, round_, least
        for k in range(out_step.size):
            work.preferred[k] = out_step[k]
    return REACHED if is_near else STUCK, track.max_rounds, least


@leaf_kernel
def track_span(robot, collision, drive, track, target, first, last, weights, q, steps, work, out_rounds, out_least):
    """Samples first + 1 .. last, into `q` [K + 1, N] and `steps` [K + 1, D]; `weights` [K + 1, 3 + D].

    Returns the last sample that was reached, and how the one after it ended.
    """
    for k in range(first + 1, last + 1):
        status, out_rounds[k], out_least[k] = track_sample(
            robot,
            collision,
            drive,
            track,
            target,
            k,
            weights[k],
            q[k - 1],
            steps[k - 1],
            k == 1,
            work,
            q[k],
            steps[k],
        )
        if status != REACHED:
            return k - 1, status
    return last, REACHED
