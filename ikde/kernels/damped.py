"""Damped least squares: one step of the tool towards its target, inside the joint ranges.

[Wampler1986] for the damping, which shrinks with the squared error [Sugihara2011], so that the last steps are those of
Newton; the ranges are kept by an active set: a joint that stands at its bound and is pulled outwards is left out.
"""

import math
from typing import NamedTuple

import numpy as np

from ikde.kernels.arrays import AXIS, POSITION, Floats
from ikde.kernels.frames import compute_bodies, compute_jacobian, compute_tool
from ikde.kernels.jit import inline_kernel, kernel

AT_BOUND = 1e-12  # m or rad: a joint this near its bound stands at it
MIN_SQUARE = 1e-4  # of the cosine of half the angle: beyond 178.9 degrees the axis of rotation is lost
OPPOSITE = 2.0  # what the orientation error tends to at half a turn


class DescentWorkspace(NamedTuple):
    """The buffers of a step, so that no inner loop allocates."""

    T_world_body: Floats  # [B, 3, 4]
    T_world_tool: Floats  # [3, 4]
    jacobian: Floats  # [R, N] R >= 6 rows: m and, scaled by the rotation length, m
    error: Floats  # [R] m
    system: Floats  # [R, R] J J^T + lambda I, then its factors: L below the diagonal, D on it
    solution: Floats  # [R]
    step: Floats  # [N]


@kernel
def make_descent_workspace(robot, joints, rows):
    """Allocate the buffers for a robot of so many joints, and `rows` >= 6 rows: 6 for the tool, the rest for others."""
    return DescentWorkspace(
        np.empty((robot.bodies.shape[0], 3, 4)),
        np.empty((3, 4)),
        np.empty((rows, joints)),
        np.empty(rows),
        np.empty((rows, rows)),
        np.empty(rows),
        np.empty(joints),
    )


@inline_kernel
def compute_rotation(target, index, T_world_tool, out_v):
    """Rotation from tool to target as axis * 2 sin(angle / 2) in the world, [3]; returns the size of the error.

    For a pose from S = R_target R_tool^T: (S - S^T) / 2 is axis * sin(angle), (trace S + 1) / 4 is cos(angle / 2)^2.
    For an axis it is z_tool x z_target, axis * sin(angle). Both fade near half a turn; the size returned grows
    with the angle from 0 to 2 (`engine.measure_rotation` is its twin).
    """
    kind, R, T = target.kind[index], target.T_world_tool[index], T_world_tool
    out_v[0], out_v[1], out_v[2] = 0.0, 0.0, 0.0
    if kind == POSITION:
        return 0.0
    if kind == AXIS:
        out_v[0] = T[1, 2] * R[2, 2] - T[2, 2] * R[1, 2]
        out_v[1] = T[2, 2] * R[0, 2] - T[0, 2] * R[2, 2]
        out_v[2] = T[0, 2] * R[1, 2] - T[1, 2] * R[0, 2]
        size = math.sqrt(out_v[0] * out_v[0] + out_v[1] * out_v[1] + out_v[2] * out_v[2])
        cosine = T[0, 2] * R[0, 2] + T[1, 2] * R[1, 2] + T[2, 2] * R[2, 2]
        return OPPOSITE - size if cosine < 0.0 else size
    trace = 0.0
    for j in range(3):  # a column of both at a time: S = sum of r t^T, so vee(S - S^T) = sum of t x r
        trace += R[0, j] * T[0, j] + R[1, j] * T[1, j] + R[2, j] * T[2, j]
        out_v[0] += T[1, j] * R[2, j] - T[2, j] * R[1, j]
        out_v[1] += T[2, j] * R[0, j] - T[0, j] * R[2, j]
        out_v[2] += T[0, j] * R[1, j] - T[1, j] * R[0, j]
    square = 0.25 * (trace + 1.0)
    scale = 0.5 / math.sqrt(max(square, MIN_SQUARE))
    for i in range(3):
        out_v[i] *= scale
    size = math.sqrt(out_v[0] * out_v[0] + out_v[1] * out_v[1] + out_v[2] * out_v[2])
    return OPPOSITE if square < MIN_SQUARE else size


@inline_kernel
def compute_error(target, index, length, T_world_tool, out_error):
    """Error [6] from tool to target: metres, then the rotation times `length` in m. Returns both sizes, m and rad."""
    square = 0.0
    for i in range(3):
        out_error[i] = target.T_world_tool[index, i, 3] - T_world_tool[i, 3]
        square += out_error[i] * out_error[i]
    orientation = compute_rotation(target, index, T_world_tool, out_error[3:])
    for i in range(3, 6):
        out_error[i] *= length
    return math.sqrt(square), orientation


@inline_kernel
def scale_rotation(target, index, length, T_world_tool, out_jacobian):
    """Rotation rows of the Jacobian [6, N] times `length`; for an axis target without rotations about the tool's z."""
    for k in range(out_jacobian.shape[1]):
        along = 0.0
        if target.kind[index] == AXIS:
            for i in range(3):
                along += T_world_tool[i, 2] * out_jacobian[3 + i, k]
        for i in range(3):
            out_jacobian[3 + i, k] = length * (out_jacobian[3 + i, k] - along * T_world_tool[i, 2])


@inline_kernel
def hold_at_bounds(ranges, q, error, rows, out_jacobian):
    """Zero the columns of joints that stand at a bound and are pulled outwards, or have no room at all."""
    for k in range(q.size):
        pull = 0.0
        for i in range(rows):
            pull += out_jacobian[i, k] * error[i]
        at_lower, at_upper = q[k] <= ranges[0, k] + AT_BOUND, q[k] >= ranges[1, k] - AT_BOUND
        if (at_upper and pull >= 0.0) or (at_lower and pull <= 0.0):
            for i in range(rows):
                out_jacobian[i, k] = 0.0


@inline_kernel
def fill_system(jacobian, rows, damping, out_system):
    """Lower triangle of J J^T + damping I over the first `rows` rows of the Jacobian, into [R, R]."""
    for i in range(rows):
        for j in range(i + 1):
            total = 0.0
            for k in range(jacobian.shape[1]):
                total += jacobian[i, k] * jacobian[j, k]
            out_system[i, j] = total
        out_system[i, i] += damping


@inline_kernel
def solve_symmetric(system, right, rows, out_x):
    """Solve A x = right by A = L D L^T, A positive definite and given as lower triangle; it is overwritten by L, D."""
    for j in range(rows):
        for k in range(j):
            system[j, j] -= system[j, k] * system[j, k] * system[k, k]
        for i in range(j + 1, rows):
            for k in range(j):
                system[i, j] -= system[i, k] * system[j, k] * system[k, k]
            system[i, j] /= system[j, j]
    for i in range(rows):
        out_x[i] = right[i]
        for k in range(i):
            out_x[i] -= system[i, k] * out_x[k]
    for i in range(rows):
        out_x[i] /= system[i, i]
    for i in range(rows - 1, -1, -1):
        for k in range(i + 1, rows):
            out_x[i] -= system[k, i] * out_x[k]


@inline_kernel
def move(ranges, jacobian, solution, rows, largest_step, step, q):
    """Add J^T x to `q`, shortened so that no joint moves more than `largest_step` (m or rad), and cut to the ranges."""
    largest = 0.0
    for k in range(q.size):
        step[k] = 0.0
        for i in range(rows):
            step[k] += jacobian[i, k] * solution[i]
        largest = max(largest, abs(step[k]))
    scale = largest_step / largest if largest > largest_step else 1.0
    for k in range(q.size):
        q[k] = min(max(q[k] + scale * step[k], ranges[0, k]), ranges[1, k])


@inline_kernel
def fill_jacobian(robot, target, index, descent, work):
    """The tool's Jacobian at the poses in `work`, its rotation rows scaled. Returns how many rows the target needs."""
    compute_jacobian(robot, work.T_world_body, work.T_world_tool, work.jacobian)
    scale_rotation(target, index, descent.rotation_length, work.T_world_tool, work.jacobian)
    return 3 if target.kind[index] == POSITION else 6


@inline_kernel
def descend(ranges, descent, rows, q, work):
    """Move `q` by J^T (J J^T + lambda I)^-1 e over the first `rows` rows of those in `work`; returns |e|^2 in m^2."""
    square = 0.0
    for i in range(rows):
        square += work.error[i] * work.error[i]
    hold_at_bounds(ranges, q, work.error, rows, work.jacobian)
    fill_system(work.jacobian, rows, descent.damping * square + descent.least_damping, work.system)
    solve_symmetric(work.system, work.error, rows, work.solution)
    move(ranges, work.jacobian, work.solution, rows, descent.largest_step, work.step, q)
    return square


@inline_kernel
def take_step(robot, target, index, ranges, descent, q, work):
    """One damped least-squares step on `q` [N], in place: dq = J^T (J J^T + lambda I)^-1 e.

    Returns the errors before the step, (m, rad); the second is 2 sin(angle / 2), or sin(angle) for an axis target: the
    angle itself where it is small. If both are within the tolerances of `descent`, `q` stays. `ranges` [2 or 3, N]:
    lower, upper. Of `work`, a `DescentWorkspace`, only the buffers of these names are used.
    """
    compute_bodies(robot, q, work.T_world_body)
    compute_tool(robot, work.T_world_body, work.T_world_tool)
    position, orientation = compute_error(target, index, descent.rotation_length, work.T_world_tool, work.error)
    if position > descent.position_tolerance or orientation > descent.orientation_tolerance:
        descend(ranges, descent, fill_jacobian(robot, target, index, descent, work), q, work)
    return position, orientation
