"""Differential evolution's mutations and bound repairs, each as its formula.

Sources: [Storn1997] rand/1, best/1, rand/2, best/2; [Qiao2022, mutation equations below eq. 24] rand-to-best/1 and /2;
[Das2011] current-to-best/1 and /2, where /n counts the random differences. Qiao 2022 counts the difference to the
best as well, so what it prints as current2best/2 is current-to-best/1 here.
"""

import math
from typing import Literal, get_args

from ikde.kernels.jit import inline_kernel
from ikde.kernels.rng import next_index, next_uniform

Strategy = Literal[
    "rand/1",
    "best/1",
    "rand/2",
    "best/2",
    "rand-to-best/1",
    "rand-to-best/2",
    "current-to-best/1",
    "current-to-best/2",
]
STRATEGIES: tuple[Strategy, ...] = get_args(Strategy)
RAND_1, BEST_1, RAND_2, BEST_2, RAND_TO_BEST_1, RAND_TO_BEST_2, CURRENT_TO_BEST_1, CURRENT_TO_BEST_2 = range(8)
MAX_DRAWN = 5

Repair = Literal["redraw", "clip", "parent", "midpoint", "none"]
REPAIRS: tuple[Repair, ...] = get_args(Repair)
REDRAW, CLIP, PARENT, MIDPOINT, NONE = range(5)
MAX_VALUE = 1e5  # m or rad: where nothing is repaired a population may run away, and sines end here


@inline_kernel
def draw_members(state, population, current, out_r):
    """Draw distinct members of the population, none of them `current`, into `out_r` [5]."""
    for n in range(MAX_DRAWN):
        fresh = False
        while not fresh:
            out_r[n] = next_index(state, population)
            fresh = out_r[n] != current
            for m in range(n):
                fresh = fresh and out_r[m] != out_r[n]


@inline_kernel
def mutate(strategy, x, i, best, r, F, k):  # noqa: PLR0911 - a formula a line
    """Coordinate `k` of the donor v for member `i` of the population `x` [NP, N]."""
    if strategy == RAND_1:
        return x[r[0], k] + F * (x[r[1], k] - x[r[2], k])
    if strategy == BEST_1:
        return x[best, k] + F * (x[r[0], k] - x[r[1], k])
    if strategy == RAND_2:
        return x[r[0], k] + F * (x[r[1], k] - x[r[2], k]) + F * (x[r[3], k] - x[r[4], k])
    if strategy == BEST_2:
        return x[best, k] + F * (x[r[0], k] - x[r[1], k]) + F * (x[r[2], k] - x[r[3], k])
    if strategy == RAND_TO_BEST_1:
        return x[r[0], k] + F * (x[best, k] - x[r[1], k])
    if strategy == RAND_TO_BEST_2:
        return x[r[0], k] + F * (x[best, k] - x[r[1], k]) + F * (x[r[2], k] - x[r[3], k])
    if strategy == CURRENT_TO_BEST_1:
        return x[i, k] + F * (x[best, k] - x[i, k]) + F * (x[r[0], k] - x[r[1], k])
    if strategy == CURRENT_TO_BEST_2:
        return x[i, k] + F * (x[best, k] - x[i, k]) + F * (x[r[0], k] - x[r[1], k]) + F * (x[r[2], k] - x[r[3], k])
    return math.nan


@inline_kernel
def repair_bound(repair, state, value, parent, lower, upper):
    """Bring one coordinate of a donor back into [lower, upper]; `parent` is the member it would replace."""
    if lower <= value <= upper:
        return value
    if repair == NONE:
        return min(max(value, -MAX_VALUE), MAX_VALUE)
    if repair == REDRAW:
        return lower + next_uniform(state) * (upper - lower)
    bound = lower if value < lower else upper
    if repair == CLIP:
        return bound
    if repair == MIDPOINT:
        return 0.5 * (parent + bound)
    return parent
