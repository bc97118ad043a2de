"""Whole turns: a full turn of a revolute joint moves no body, so each joint is given in the turn that was meant."""

import numpy as np

from ikde.kernels.jit import leaf_kernel

TURN = 2.0 * np.pi


@leaf_kernel
def unwind(lower, upper, turning, centre, q):
    """Take from `q` [N], in place, the whole turns that bring it nearest to `centre` [N] inside [lower, upper] [N].

    `turning` [N] says which joints turn, 0 or 1. To the bit as it is stays a joint that is within half a turn of its
    centre, and one whose range holds no nearer turn.
    """
    for k in range(q.size):
        away = q[k] - centre[k]
        distance = abs(away)
        if not turning[k] or not distance > np.pi:  # NaN stays
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
def unwind_rows(lower, upper, turning, centre, Q):
    """`unwind` of every row of `Q` [T, N], in place: the same bits."""
    for row in range(Q.shape[0]):
        unwind(lower, upper, turning, centre, Q[row])
