"""One constrained Gauss-Newton step: the tool's error first, the preferred step second, no constraint violated.

It minimises |step - preferred|^2 + stiffness |error - J change|^2 over the steps in the box that meet all constraints.
The stiffness makes the tool's error a million times as dear as the preferred step, which damps where J fades.
With H = I + stiffness J^T J = L L^T and y = L^T step this is the nearest point of a polytope
(`kernels/dual_active_set.py`).
"""

import math
from typing import NamedTuple

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.kernels.dual_active_set import HalfSpaces, find_nearest_point, make_half_spaces
from ikde.kernels.jit import inline_kernel, kernel, leaf_kernel
from ikde.kernels.step_constraints import MAX_CONSTRAINTS

MIN_SLOPE = 1e-12  # below it no step changes a constraint


class System(NamedTuple):
    """The numbers of one such step of D entries."""

    lower: Floats  # [D] the box, in shares of the largest step
    upper: Floats  # [D]
    matrix: Floats  # [D, D] H, then L
    inverse: Floats  # [D, D] of L
    right: Floats  # [D]
    residual: Floats  # [6]
    y: Floats  # [D]
    spaces: HalfSpaces


@kernel
def make_system(size):
    """Room for steps of this size."""
    return System(
        np.empty(size),
        np.empty(size),
        np.empty((size, size)),
        np.empty((size, size)),
        np.empty(size),
        np.empty(6),
        np.empty(size),
        make_half_spaces(2 * size + MAX_CONSTRAINTS, size),
    )


@inline_kernel
def measure_travel(jacobian, rows):
    """Mean square of how far the largest steps move the tool, m^2 (and what a rotation counts); never 0."""
    square = 0.0
    for i in range(rows):
        for k in range(jacobian.shape[1]):
            square += jacobian[i, k] * jacobian[i, k]
    return max(square / rows, 1e-24)


@leaf_kernel
def factor(jacobian, rows, stiffness, matrix, inverse):
    """L of I + stiffness J^T J = L L^T over the first rows, into `matrix` [D, D], and its inverse."""
    size = matrix.shape[0]
    for a in range(size):
        for b in range(a + 1):
            total = 0.0
            for i in range(rows):
                total += jacobian[i, a] * jacobian[i, b]
            total = stiffness * total + (1.0 if a == b else 0.0)
            for k in range(b):
                total -= matrix[a, k] * matrix[b, k]
            matrix[a, b] = math.sqrt(max(total, 1e-300)) if a == b else total / matrix[b, b]
    for column in range(size):
        for a in range(column):
            inverse[a, column] = 0.0
        inverse[column, column] = 1.0 / matrix[column, column]
        for a in range(column + 1, size):
            total = 0.0
            for k in range(column, a):
                total -= matrix[a, k] * inverse[k, column]
            inverse[a, column] = total / matrix[a, a]


@inline_kernel
def weigh(jacobian, rows, inverse, out_weighted):
    """J H^-1 over the first rows, from the inverse of L, into [6, D]; the other rows are 0."""
    size = inverse.shape[0]
    for i in range(6):
        for k in range(size):
            out_weighted[i, k] = 0.0
    for i in range(rows):
        for a in range(size):
            total = 0.0
            for b in range(a + 1):
                total += inverse[a, b] * jacobian[i, b]
            for k in range(a + 1):
                out_weighted[i, k] += total * inverse[a, k]


@inline_kernel
def set_free_point(jacobian, error, rows, stiffness, preferred, step, system):
    """The minimum without box and constraints, as y = L^-1 (preferred + stiffness J^T (error + J step))."""
    size = step.size
    for i in range(rows):
        system.residual[i] = error[i]
        for k in range(size):
            system.residual[i] += jacobian[i, k] * step[k]
    for k in range(size):
        total = 0.0
        for i in range(rows):
            total += jacobian[i, k] * system.residual[i]
        system.right[k] = preferred[k] + stiffness * total
    for a in range(size):
        system.y[a] = 0.0
        for k in range(a + 1):
            system.y[a] += system.inverse[a, k] * system.right[k]


@inline_kernel
def add_normal(system, slope, offset, at):
    """Write the half space slope . step >= offset as number `at`; returns how many there are then."""
    spaces, size, square = system.spaces, slope.size, 0.0
    for a in range(size):
        total = 0.0
        for k in range(a + 1):
            total += system.inverse[a, k] * slope[k]
        spaces.normals[at, a] = total
        square += total * total
    length = math.sqrt(square)
    if length < MIN_SLOPE:
        return at
    for a in range(size):
        spaces.normals[at, a] /= length
    spaces.offsets[at] = offset / length
    return at + 1


@inline_kernel
def set_half_spaces(slack, slope, count, step, system):
    """Box and constraints as half spaces of y; returns how many."""
    spaces, at = system.spaces, 0
    for k in range(step.size):
        square = 0.0
        for a in range(k, step.size):
            square += system.inverse[a, k] * system.inverse[a, k]
        scale = 1.0 / math.sqrt(square)
        for a in range(step.size):
            spaces.normals[at, a] = scale * system.inverse[a, k]
            spaces.normals[at + 1, a] = -spaces.normals[at, a]
        spaces.offsets[at], spaces.offsets[at + 1] = scale * system.lower[k], -scale * system.upper[k]
        at += 2
    for i in range(count):
        offset = -slack[i]
        for k in range(step.size):
            offset += slope[i, k] * step[k]
        at = add_normal(system, slope[i], offset, at)
    return at


@leaf_kernel
def solve_step(jacobian, error, rows, stiffness, preferred, slack, slope, count, system, step):
    """Improve `step` [D] in place; False if no step meets all constraints: the step is then inside the box alone.

    `jacobian` [6, D] and `error` [6] of the tool, and `slack` and `slope` of the constraints, are those at the
    step that is given.
    """
    factor(jacobian, rows, stiffness, system.matrix, system.inverse)
    set_free_point(jacobian, error, rows, stiffness, preferred, step, system)
    is_possible = find_nearest_point(system.spaces, set_half_spaces(slack, slope, count, step, system), system.y)
    for k in range(step.size):
        total = 0.0
        for a in range(k, step.size):
            total += system.inverse[a, k] * system.y[a]
        step[k] = min(max(total, system.lower[k]), system.upper[k])
    return is_possible
