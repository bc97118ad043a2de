"""One step of Gauss and Newton behind fences: the tool's error first, the wished step second, never a bound broken.

It minimises |step - wish|^2 + stiffness |error - J change|^2 over the steps inside the box and behind the fences. The
stiffness makes the tool's error a million times as dear as the wish; where the Jacobian fades, the wish is what damps.
With H = I + stiffness J^T J = L L^T and y = L^T step this is the nearest point of a polytope (`kernels/nearest.py`).
"""

import math
from typing import NamedTuple

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.kernels.fences import MOST_FENCES
from ikde.kernels.jit import inline_kernel, kernel, leaf_kernel
from ikde.kernels.nearest import Walls, find_nearest, make_walls

SMALLEST_SLOPE = 1e-12  # a fence that no step moves


class System(NamedTuple):
    """The numbers of one such step of D entries."""

    lower: Floats  # [D] the box, in shares of the largest step
    upper: Floats  # [D]
    matrix: Floats  # [D, D] H, then L
    inverse: Floats  # [D, D] of L
    right: Floats  # [D]
    residual: Floats  # [6]
    y: Floats  # [D]
    walls: Walls


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
        make_walls(2 * size + MOST_FENCES, size),
    )


@inline_kernel
def measure_travel(jacobian, rows):
    """Mean square of how far the largest steps move the tool, m^2 (and what a turn counts); never 0."""
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
def set_free_point(jacobian, error, rows, stiffness, wish, step, system):
    """The minimum without box and fences, as y = L^-1 (wish + stiffness J^T (error + J step))."""
    size = step.size
    for i in range(rows):
        system.residual[i] = error[i]
        for k in range(size):
            system.residual[i] += jacobian[i, k] * step[k]
    for k in range(size):
        total = 0.0
        for i in range(rows):
            total += jacobian[i, k] * system.residual[i]
        system.right[k] = wish[k] + stiffness * total
    for a in range(size):
        system.y[a] = 0.0
        for k in range(a + 1):
            system.y[a] += system.inverse[a, k] * system.right[k]


@inline_kernel
def add_normal(system, slope, offset, at):
    """Write the half space slope . step >= offset as number `at`; returns how many there are then."""
    walls, size, square = system.walls, slope.size, 0.0
    for a in range(size):
        total = 0.0
        for k in range(a + 1):
            total += system.inverse[a, k] * slope[k]
        walls.normals[at, a] = total
        square += total * total
    length = math.sqrt(square)
    if length < SMALLEST_SLOPE:
        return at
    for a in range(size):
        walls.normals[at, a] /= length
    walls.offsets[at] = offset / length
    return at + 1


@inline_kernel
def set_walls(fences, count, step, system):
    """Box and fences as half spaces of y; returns how many."""
    walls, at = system.walls, 0
    for k in range(step.size):
        square = 0.0
        for a in range(k, step.size):
            square += system.inverse[a, k] * system.inverse[a, k]
        scale = 1.0 / math.sqrt(square)
        for a in range(step.size):
            walls.normals[at, a] = scale * system.inverse[a, k]
            walls.normals[at + 1, a] = -walls.normals[at, a]
        walls.offsets[at], walls.offsets[at + 1] = scale * system.lower[k], -scale * system.upper[k]
        at += 2
    for i in range(count):
        offset = -fences.slack[i]
        for k in range(step.size):
            offset += fences.slope[i, k] * step[k]
        at = add_normal(system, fences.slope[i], offset, at)
    return at


@leaf_kernel
def solve_step(jacobian, error, rows, stiffness, wish, fences, count, system, step):
    """Improve `step` [D] in place; False if no step is behind all fences: the step is then inside the box alone.

    `jacobian` [6, D] and `error` [6] of the tool, and the fences, are those at the step that is given.
    """
    factor(jacobian, rows, stiffness, system.matrix, system.inverse)
    set_free_point(jacobian, error, rows, stiffness, wish, step, system)
    is_possible = find_nearest(system.walls, set_walls(fences, count, step, system), system.y)
    for k in range(step.size):
        total = 0.0
        for a in range(k, step.size):
            total += system.inverse[a, k] * system.y[a]
        step[k] = min(max(total, system.lower[k]), system.upper[k])
    return is_possible
