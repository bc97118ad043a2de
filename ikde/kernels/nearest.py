"""The nearest point of a polytope, by an active set on its dual [Goldfarb1983].

Walls are added one by one, the most violated first. While a new wall pulls the point onto itself, walls that no longer
push are dropped. If none can be dropped and the point cannot come nearer to the new wall, the polytope is empty.
"""

import math
from typing import NamedTuple

import numpy as np

from ikde.kernels.arrays import Floats, Ints
from ikde.kernels.damped import solve_symmetric
from ikde.kernels.jit import inline_kernel, kernel, leaf_kernel

VIOLATED = 1e-10  # of a wall with a unit normal
PARALLEL = 1e-12  # share of a normal's square that the active walls leave of it
MOST_ROUNDS = 100
EMPTY = -1


class Walls(NamedTuple):
    """The half spaces normal . y >= offset, and what the search for the nearest point needs."""

    normals: Floats  # [W, D] unit vectors
    offsets: Floats  # [W]
    active: Ints  # [D + 1] walls that push
    push: Floats  # [D + 1] how much
    gram: Floats  # [D + 1, D + 1] products of the active normals, then their factors
    right: Floats  # [D + 1] products with the new normal
    shift: Floats  # [D + 1] how the push of active walls falls as the new one's grows
    way: Floats  # [D] what the active walls leave of the new normal


@kernel
def make_walls(walls, size):
    """Room for so many walls in so many dimensions."""
    return Walls(
        np.empty((walls, size)),
        np.empty(walls),
        np.empty(size + 1, dtype=np.int64),
        np.empty(size + 1),
        np.empty((size + 1, size + 1)),
        np.empty(size + 1),
        np.empty(size + 1),
        np.empty(size),
    )


@inline_kernel
def find_worst(walls, count, y):
    """The most violated of the first `count` walls, or -1."""
    worst, least = -1, -VIOLATED
    for i in range(count):
        slack = -walls.offsets[i]
        for k in range(y.size):
            slack += walls.normals[i, k] * y[k]
        if slack < least:
            worst, least = i, slack
    return worst


@inline_kernel
def set_way(walls, used, new):
    """Part of the new normal that the active ones leave, into `way`; returns its square."""
    size = walls.way.size
    for a in range(used):
        for b in range(a + 1):
            total = 0.0
            for k in range(size):
                total += walls.normals[walls.active[a], k] * walls.normals[walls.active[b], k]
            walls.gram[a, b] = total
        walls.right[a] = 0.0
        for k in range(size):
            walls.right[a] += walls.normals[walls.active[a], k] * walls.normals[new, k]
    solve_symmetric(walls.gram, walls.right, used, walls.shift)
    square = 0.0
    for k in range(size):
        walls.way[k] = walls.normals[new, k]
        for a in range(used):
            walls.way[k] -= walls.shift[a] * walls.normals[walls.active[a], k]
        square += walls.way[k] * walls.way[k]
    return square


@inline_kernel
def find_blocking(walls, used):
    """How far the new wall's push can grow before an active one's is gone, and which; inf and -1 if none goes."""
    far, blocking = math.inf, -1
    for a in range(used):
        if walls.shift[a] > 0.0 and walls.push[a] < far * walls.shift[a]:
            far, blocking = walls.push[a] / walls.shift[a], a
    return far, blocking


@inline_kernel
def drop(walls, used, which):
    """Take one wall out of the active ones."""
    for a in range(which, used - 1):
        walls.active[a], walls.push[a] = walls.active[a + 1], walls.push[a + 1]


@inline_kernel
def add_wall(walls, used, new, y):
    """Bring `y` [D] onto the wall `new` and keep the active ones; returns how many there are then, or `EMPTY`."""
    pushed = 0.0
    while True:
        square = set_way(walls, used, new)
        far, blocking = find_blocking(walls, used)
        needed = math.inf
        if square > PARALLEL and used < y.size:
            slack = -walls.offsets[new]
            for k in range(y.size):
                slack += walls.normals[new, k] * y[k]
            needed = max(-slack / square, 0.0)
        size = min(far, needed)
        if size == math.inf:
            return EMPTY
        if needed < math.inf:
            for k in range(y.size):
                y[k] += size * walls.way[k]
        for a in range(used):
            walls.push[a] = max(walls.push[a] - size * walls.shift[a], 0.0)
        pushed += size
        if needed <= far:
            walls.active[used], walls.push[used] = new, pushed
            return used + 1
        drop(walls, used, blocking)
        used -= 1


@leaf_kernel
def find_nearest(walls, count, y):
    """Move `y` [D] to the nearest point behind the first `count` walls; False if there is none (`y` is then near)."""
    used = 0
    for _ in range(MOST_ROUNDS):
        worst = find_worst(walls, count, y)
        if worst < 0:
            return True
        used = add_wall(walls, used, worst, y)
        if used == EMPTY:
            return False
    return False
