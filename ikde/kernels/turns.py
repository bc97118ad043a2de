"""Whole turns: a full turn of a revolute joint moves no body, so each joint is given in the turn that was meant."""

import math

import numpy as np

from ikde.kernels.jit import leaf_kernel

TURN = 2.0 * np.pi


@leaf_kernel
def unwind_far(lower, upper, is_revolute, centre, q):
    """Take several turns at once from what is more than one and a half away from its centre; all as in `unwind`."""
    for k in range(q.size):
        away = q[k] - centre[k]
        distance = abs(away)
        if not is_revolute[k] or not distance > 3.0 * np.pi:  # NaN stays
            continue
        side, room = (1.0, q[k] - lower[k]) if away > 0.0 else (-1.0, upper[k] - q[k])
        turns = min(np.ceil((distance - np.pi) / TURN), np.floor(room / TURN))
        while turns > 0.0:
            turned = q[k] - side * turns * TURN
            if lower[k] <= turned <= upper[k] and abs(turned - centre[k]) < distance:
                q[k] = turned
                break
            turns -= 1.0  # rounding took it across the bound


@leaf_kernel
def unwind(lower, upper, is_revolute, centre, q):
    """Take from `q` [N], in place, the whole turns that bring it nearest to `centre` [N] inside [lower, upper] [N].

    `is_revolute` [N]: 0 or 1. To the bit as it is stays a joint that is within half a turn of its centre, and one whose
    range holds no nearer turn.
    """
    is_far = False
    for k in range(q.size):  # without a branch, which nothing can predict: 17 ns a row of `ur5` for 94
        away = q[k] - centre[k]
        distance, turned = abs(away), q[k] - math.copysign(TURN, away)
        turns, is_near = is_revolute[k] != 0, distance <= 3.0 * np.pi
        nearer = (lower[k] <= turned) & (turned <= upper[k]) & (abs(turned - centre[k]) < distance)
        q[k] = turned if turns & is_near & nearer else q[k]
        is_far |= turns & (not is_near)
    if is_far:
        unwind_far(lower, upper, is_revolute, centre, q)


@leaf_kernel
def unwind_rows(lower, upper, is_revolute, centre, Q):
    """`unwind` of every row of `Q` [T, N], in place: the same bits."""
    for row in range(Q.shape[0]):
        unwind(lower, upper, is_revolute, centre, Q[row])
