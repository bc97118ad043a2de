"""Secondary objectives projected into the null space: a preferred step [D], in shares of the largest.

The preferred step of least motion is 0. To it are added: away from contact, away from the ends of the joint ranges, up
the gradient of manipulability, and a drift that a search may ask for. The weights of all are one row of numbers
(`kernels/arrays.py`).
"""

import math

from ikde.kernels.arrays import CLEARANCE, DRIFT, LIMITS, MANIPULABILITY
from ikde.kernels.jit import inline_kernel, leaf_kernel

MAX_SHARE = 0.7  # of a largest step
INERTIA = 0.8  # share of the step before in a preferred step
FREE_SHARE = 0.5  # of half a range, about its middle, within which the ends have no effect
MANIPULABILITY_STIFFNESS = 1e3  # a direction counts as free if the largest steps move it 1 / sqrt(1e3) of the usual


@inline_kernel
def avoid_limits(drive, track, weights, q, out_preferred):
    """Away from the ends of the joint ranges, the harder the nearer."""
    first = out_preferred.size - drive.others.size
    for k in range(drive.others.size):
        lower, upper = track.ranges[0, drive.others[k]], track.ranges[1, drive.others[k]]
        share = (2.0 * q[drive.others[k]] - lower - upper) / max(upper - lower, 1e-12)
        if abs(share) > FREE_SHARE:
            beyond = (share - math.copysign(FREE_SHARE, share)) / (1.0 - FREE_SHARE)
            out_preferred[first + k] -= weights[LIMITS] * beyond


@inline_kernel
def avoid_contacts(track, weights, count, constraints, out_preferred):
    """Pairs apart, along the gradients of their gaps, the harder the nearer."""
    for i in range(count):
        square = 0.0
        for k in range(out_preferred.size):
            square += constraints.slope[i, k] * constraints.slope[i, k]
        if square == 0.0:
            continue
        near = max(0.0, 1.0 - constraints.slack[i] / (track.reach - track.margin))
        scale = weights[CLEARANCE] * near * near / math.sqrt(square)
        for k in range(out_preferred.size):
            out_preferred[k] += scale * constraints.slope[i, k]


@inline_kernel
def differentiate_column(jacobian, other, k, i):
    """Product of column k of `other` with how column i of `jacobian` [6, D] changes by step k, that of a joint.

    A joint k nearer to the base rotates column i as a whole, omega_k x; of the others the tool's motion alone changes,
    omega_i x v_k. Both hold for prismatic joints, whose omega is 0.
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
def raise_manipulability(drive, weights, jacobian, weighted, out_preferred):
    """Up the gradient of log det(I + J^T J) / 2 by the joints' steps: `jacobian` [6, D], `weighted` J (I + J^T J)^-1.

    The rows of `jacobian` are m and rad; those of `weighted` carry the scales of J twice.
    """
    first = out_preferred.size - drive.others.size
    for k in range(first, out_preferred.size):
        slope = 0.0
        for i in range(out_preferred.size):
            slope += differentiate_column(jacobian, weighted, k, i)
        out_preferred[k] += weights[MANIPULABILITY] * slope


@inline_kernel
def start_preferred(weights, out_preferred):
    """The drift alone."""
    for k in range(out_preferred.size):
        out_preferred[k] = weights[DRIFT + k]


@inline_kernel
def limit_preferred(drive, last, out_preferred):
    """Keep it well below the largest step, change it little from one sample to the next, and let frozen joints rest.

    A pair may be equally near to two others, so that each step away from one is followed by one away from the other:
    without inertia that chatters.
    """
    for k in range(out_preferred.size):
        share = min(max(out_preferred[k], -MAX_SHARE), MAX_SHARE)
        share += INERTIA * (last[k] - share)
        out_preferred[k] = share if drive.largest[k] > 0.0 else 0.0
