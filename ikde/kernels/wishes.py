"""What a robot would do with the freedom that the tool leaves it: a wished step [D], in shares of the largest.

Least motion is the wish to stand still. Beside it: away from contact, away from the joint ranges' ends, towards a more
agile arm, and a drift that a search may ask for. How much of each is one row of numbers (`kernels/arrays.py`).
"""

import math

from ikde.kernels.arrays import CLEARANCE, DRIFT, LIMITS, MANIPULABILITY
from ikde.kernels.jit import inline_kernel, leaf_kernel

LARGEST_WISH = 0.7
INERTIA = 0.8  # share of the step before in a wish
FREE_SHARE = 0.5  # of half a range, about its middle, where the ends are not minded
AGILE = 1e3  # a direction of the tool counts as free if the largest steps move it 1 / sqrt(AGILE) of the usual


@inline_kernel
def wish_middle(drive, track, weights, q, out_wish):
    """Away from the ends of the joint ranges, the harder the nearer."""
    first = out_wish.size - drive.others.size
    for k in range(drive.others.size):
        lower, upper = track.ranges[0, drive.others[k]], track.ranges[1, drive.others[k]]
        share = (2.0 * q[drive.others[k]] - lower - upper) / max(upper - lower, 1e-12)
        if abs(share) > FREE_SHARE:
            beyond = (share - math.copysign(FREE_SHARE, share)) / (1.0 - FREE_SHARE)
            out_wish[first + k] -= weights[LIMITS] * beyond


@inline_kernel
def wish_apart(track, weights, count, fences, out_wish):
    """Pairs apart, along the steepest way, the harder the nearer."""
    for i in range(count):
        square = 0.0
        for k in range(out_wish.size):
            square += fences.slope[i, k] * fences.slope[i, k]
        if square == 0.0:
            continue
        near = max(0.0, 1.0 - fences.slack[i] / (track.reach - track.margin))
        push = weights[CLEARANCE] * near * near / math.sqrt(square)
        for k in range(out_wish.size):
            out_wish[k] += push * fences.slope[i, k]


@inline_kernel
def turned(jacobian, other, k, i):
    """Product of column k of `other` with how column i of `jacobian` [6, D] changes by step k, that of a joint.

    A joint k nearer to the base turns column i as a whole, omega_k x; of the others the tool's motion alone changes,
    omega_i x v_k. Both hold for slides, whose omega is 0.
    """
    a, b = (k, i) if k <= i else (i, k)
    wx, wy, wz = jacobian[3, a], jacobian[4, a], jacobian[5, a]
    vx, vy, vz = jacobian[0, b], jacobian[1, b], jacobian[2, b]
    total = other[0, i] * (wy * vz - wz * vy) + other[1, i] * (wz * vx - wx * vz) + other[2, i] * (wx * vy - wy * vx)
    if k <= i:
        vx, vy, vz = jacobian[3, b], jacobian[4, b], jacobian[5, b]
        total += (
            other[3, i] * (wy * vz - wz * vy) + other[4, i] * (wz * vx - wx * vz) + other[5, i] * (wx * vy - wy * vx)
        )
    return total


@leaf_kernel
def wish_agile(drive, weights, jacobian, weighted, out_wish):
    """Up the gradient of log det(I + J^T J) / 2 by the joints' steps: `jacobian` [6, D], `weighted` J (I + J^T J)^-1.

    The rows of `jacobian` are m and rad; those of `weighted` carry the scales of J twice.
    """
    first = out_wish.size - drive.others.size
    for k in range(first, out_wish.size):
        slope = 0.0
        for i in range(out_wish.size):
            slope += turned(jacobian, weighted, k, i)
        out_wish[k] += weights[MANIPULABILITY] * slope


@inline_kernel
def start_wish(weights, out_wish):
    """The drift alone."""
    for k in range(out_wish.size):
        out_wish[k] = weights[DRIFT + k]


@inline_kernel
def finish_wish(drive, last, out_wish):
    """No wish is nearly as large as the largest step; it changes little from one sample to the next; the frozen rest.

    A pair may be equally near to two others, a push from either then answers the other: without inertia that chatters.
    """
    for k in range(out_wish.size):
        wish = min(max(out_wish[k], -LARGEST_WISH), LARGEST_WISH)
        wish += INERTIA * (last[k] - wish)
        out_wish[k] = wish if drive.largest[k] > 0.0 else 0.0
