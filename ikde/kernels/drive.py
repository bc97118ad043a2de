"""One step of a robot from sample to sample, and how the end of the step hangs on it.

A base with wheels drives the exact arc of a constant speed v along its heading and a constant yaw rate omega: with the
distance d and the angle a of one sample, its chord is d sin(a / 2) / (a / 2) at the heading in the middle. So it never
slips sideways [Qiao2022, eq. 5].
"""

import math

from ikde.kernels.jit import inline_kernel
from ikde.kernels.trig import sin_cos

SMALL = 1e-3  # rad: below it a series is exact to rounding
ROUNDING = 1e-12  # of a share


@inline_kernel
def chord_share(x):
    """Return sin(x) / x, and its derivative."""
    if abs(x) < SMALL:
        u = x * x
        return 1.0 - u / 6.0 * (1.0 - u / 20.0), x / 3.0 * (0.1 * u - 1.0)
    s, c = sin_cos(x)
    return s / x, (c - s / x) / x


@inline_kernel
def take_drive_step(drive, q, step, out_q):
    """Configuration `out_q` [N] at the end of a `step` [D] from `q` [N]."""
    first = step.size - drive.others.size
    for k in range(drive.others.size):
        out_q[drive.others[k]] = q[drive.others[k]] + drive.largest[first + k] * step[first + k]
    if first == 2:
        x, y, heading = drive.base[0], drive.base[1], drive.base[2]
        angle = drive.largest[1] * step[1]
        chord = drive.largest[0] * step[0] * chord_share(0.5 * angle)[0]
        s, c = sin_cos(q[heading] + 0.5 * angle)
        out_q[x] = q[x] + chord * c
        out_q[y] = q[y] + chord * s
        out_q[heading] = q[heading] + angle


@inline_kernel
def arc_is_inside(drive, ranges, q, step):
    """True unless the arc of a base with wheels, a `step` [D] from `q` [N], leaves the ranges of x or y on its way.

    Along x it is farthest out where the heading is along y, and along y where it is along x.
    """
    x, y, heading = drive.base[0], drive.base[1], q[drive.base[2]]
    distance, angle = drive.largest[0] * step[0], drive.largest[1] * step[1]
    for k in range(2):
        quarter = 0.5 if k == 0 else 0.0
        rotation = (math.ceil(heading / math.pi - quarter) + quarter) * math.pi - heading
        if angle < 0.0:
            rotation -= math.pi
        if abs(rotation) >= abs(angle):
            continue
        chord = distance * (rotation / angle) * chord_share(0.5 * rotation)[0]
        s, c = sin_cos(heading + 0.5 * rotation)
        place = q[x] + chord * c if k == 0 else q[y] + chord * s
        if not ranges[0, drive.base[k]] <= place <= ranges[1, drive.base[k]]:
            return False
    return True


@inline_kernel
def fold_row(drive, q, step, row, out):
    """Convert d/dq at the end of a step, `row` [N], into d/dstep, `out` [D]."""
    first = step.size - drive.others.size
    for k in range(drive.others.size):
        out[first + k] = drive.largest[first + k] * row[drive.others[k]]
    if first == 2:
        x, y, heading = row[drive.base[0]], row[drive.base[1]], row[drive.base[2]]
        distance, angle = drive.largest[0] * step[0], drive.largest[1] * step[1]
        share, slope = chord_share(0.5 * angle)
        s, c = sin_cos(q[drive.base[2]] + 0.5 * angle)
        along, across = x * c + y * s, y * c - x * s
        out[0] = drive.largest[0] * share * along
        out[1] = drive.largest[1] * (0.5 * distance * (slope * along + share * across) + heading)


@inline_kernel
def set_step_box(drive, ranges, q, last, first_step, out_lower, out_upper):
    """Bounds [D] of a step's shares: the largest step, the joint ranges, and the change from the `last` step [D].

    What may brake only so hard must begin in time: with steps that shrink by c, a step u needs u (u + c) / (2 c),
    and up to c / 8 more, to come to rest. The first step of all may be any. False if a joint cannot keep both.
    """
    first, is_possible = last.size - drive.others.size, True
    for k in range(last.size):
        largest, change = drive.largest[k], math.inf if first_step else drive.change[k]
        out_lower[k], out_upper[k] = -1.0, 1.0
        if largest == 0.0:
            continue
        lower, upper = max(-1.0, last[k] - change), min(1.0, last[k] + change)
        if k >= first or k == 1:
            coordinate = drive.others[k - first] if k >= first else drive.base[2]
            below = (q[coordinate] - ranges[0, coordinate]) / largest
            above = (ranges[1, coordinate] - q[coordinate]) / largest
            lower, upper = max(lower, -brake(below, drive.change[k])), min(upper, brake(above, drive.change[k]))
        is_possible = is_possible and lower <= upper + ROUNDING
        out_lower[k], out_upper[k] = min(lower, upper), upper
    return is_possible


@inline_kernel
def brake(room, change):
    """Largest step towards a bound that is `room` away, if steps shrink by `change` at most; all in shares."""
    if change == math.inf:
        return room
    short = max(room - 0.125 * change, 0.0)
    return min(room, 0.5 * (math.sqrt(change * change + 8.0 * change * short) - change))
