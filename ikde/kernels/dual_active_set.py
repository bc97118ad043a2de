"""The nearest point of a polytope, by an active set on its dual [Goldfarb1983].

Constraints become active one by one, the most violated first. While the point moves onto a new one, active constraints
whose multipliers fall to 0 are dropped. If none can be dropped and the point comes no nearer, the polytope is empty.
"""

import math
from typing import NamedTuple

import numpy as np

from ikde.kernels.arrays import Floats, Ints
from ikde.kernels.damped import solve_symmetric
from ikde.kernels.jit import inline_kernel, kernel, leaf_kernel

VIOLATED = 1e-10  # of a constraint with a unit normal
PARALLEL = 1e-12  # share of a normal's square that the active ones leave of it
MAX_ROUNDS = 100
EMPTY = -1


class HalfSpaces(NamedTuple):
    """The half spaces normal . y >= offset, and what the search for the nearest point needs."""

    normals: Floats  # [W, D] unit vectors
    offsets: Floats  # [W]
    active: Ints  # [D + 1] active constraints
    multipliers: Floats  # [D + 1] theirs
    gram: Floats  # [D + 1, D + 1] products of the active normals, then their factors
    right: Floats  # [D + 1] products with the new normal
    decrease: Floats  # [D + 1] of the multipliers, for each unit by which the new constraint's grows
    direction: Floats  # [D] what the active normals leave of the new one


@kernel
def make_half_spaces(count, size):
    """Room for so many half spaces in so many dimensions."""
    return HalfSpaces(
        np.empty((count, size)),
        np.empty(count),
        np.empty(size + 1, dtype=np.int64),
        np.empty(size + 1),
        np.empty((size + 1, size + 1)),
        np.empty(size + 1),
        np.empty(size + 1),
        np.empty(size),
    )


@inline_kernel
def find_most_violated(spaces, count, y):
    """The most violated of the first `count` constraints, or -1."""
    worst, least = -1, -VIOLATED
    for i in range(count):
        slack = -spaces.offsets[i]
        for k in range(y.size):
            slack += spaces.normals[i, k] * y[k]
        if slack < least:
            worst, least = i, slack
    return worst


@inline_kernel
def set_direction(spaces, used, new):
    """Part of the new normal that the active ones leave, into `direction`; returns its square."""
    size = spaces.direction.size
    for a in range(used):
        for b in range(a + 1):
            total = 0.0
            for k in range(size):
                total += spaces.normals[spaces.active[a], k] * spaces.normals[spaces.active[b], k]
            spaces.gram[a, b] = total
        spaces.right[a] = 0.0
        for k in range(size):
            spaces.right[a] += spaces.normals[spaces.active[a], k] * spaces.normals[new, k]
    solve_symmetric(spaces.gram, spaces.right, used, spaces.decrease)
    square = 0.0
    for k in range(size):
        spaces.direction[k] = spaces.normals[new, k]
        for a in range(used):
            spaces.direction[k] -= spaces.decrease[a] * spaces.normals[spaces.active[a], k]
        square += spaces.direction[k] * spaces.direction[k]
    return square


@inline_kernel
def find_blocking(spaces, used):
    """How far the new multiplier can grow before an active one is 0, and which; inf and -1 if none comes to 0."""
    far, blocking = math.inf, -1
    for a in range(used):
        if spaces.decrease[a] > 0.0 and spaces.multipliers[a] < far * spaces.decrease[a]:
            far, blocking = spaces.multipliers[a] / spaces.decrease[a], a
    return far, blocking


@inline_kernel
def drop(spaces, used, which):
    """Take one constraint out of the active set."""
    for a in range(which, used - 1):
        spaces.active[a], spaces.multipliers[a] = spaces.active[a + 1], spaces.multipliers[a + 1]


@inline_kernel
def add_half_space(spaces, used, new, y):
    """Bring `y` [D] onto the constraint `new` and keep the active ones; returns how many there are then, or `EMPTY`."""
    multiplier = 0.0
    while True:
        square = set_direction(spaces, used, new)
        far, blocking = find_blocking(spaces, used)
        needed = math.inf
        if square > PARALLEL and used < y.size:
            slack = -spaces.offsets[new]
            for k in range(y.size):
                slack += spaces.normals[new, k] * y[k]
            needed = max(-slack / square, 0.0)
        size = min(far, needed)
        if size == math.inf:
            return EMPTY
        if needed < math.inf:
            for k in range(y.size):
                y[k] += size * spaces.direction[k]
        for a in range(used):
            spaces.multipliers[a] = max(spaces.multipliers[a] - size * spaces.decrease[a], 0.0)
        multiplier += size
        if needed <= far:
            spaces.active[used], spaces.multipliers[used] = new, multiplier
            return used + 1
        drop(spaces, used, blocking)
        used -= 1


@leaf_kernel
def find_nearest_point(spaces, count, y):
    """Move `y` [D] to the nearest point in the first `count` half spaces; False if there is none (`y` is then near).

    It moves by the sum of the active normals times their multipliers; behind them stands -1 in `active`.
    """
    used = np.int64(0)  # a literal would be compiled into functions of its own
    for _ in range(MAX_ROUNDS):
        worst = find_most_violated(spaces, count, y)
        if worst < 0:
            spaces.active[used] = -1
            return True
        used = add_half_space(spaces, used, worst, y)
        if used == EMPTY:
            return False
    return False
