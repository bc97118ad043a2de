"""Box and rows of a step towards a target: where it would stop, what is near is kept away from.

They are those of a path (`kernels/step_constraints.py`), with what is too near from the start, and rows of earlier
rounds: where another sphere of a component is the nearest from round to round, all of them count.
"""

import math

import numpy as np

from ikde.kernels.jit import inline_kernel, leaf_kernel
from ikde.kernels.servo_room import (
    ACCELERATION,
    APPROACH,
    BASE_ROW,
    CUTS,
    DISTANCE_ROW,
    MAX_KEPT,
    RANGE,
    SPEED,
    WHEEL_ROW,
)
from ikde.kernels.step_constraints import constrain_base, constrain_distance, constrain_pairs, constrain_wheels
from ikde.kernels.tracking import compute_poses

ATTAINABLE = 0.5  # of what a step could win of a depth: it shall
NEAR_M = 0.002  # of rows of earlier rounds: what is farther away is not held on to


@inline_kernel
def cap_step(room, change):
    """Largest step whose stop is no farther than `room`; all in shares."""
    room = max(room, 0.0)
    return room if change == math.inf else change * (math.sqrt(1.0 + 2.0 * room / change) - 1.0)


@inline_kernel
def approach(room, lead, change):
    """Largest step towards what is `room` away and moves on by `lead` a step, so as to stop relative to it."""
    ahead = max(lead, 0.0)
    return ahead + cap_step(room - ahead, change) if room > 0.0 else 0.0


@inline_kernel
def bound(work, servo, k, low, high, why):
    """Narrow the box of entry k, and note why."""
    if low > work.system.lower[k]:
        work.system.lower[k], servo.why[0, k] = low, why
    if high < work.system.upper[k]:
        work.system.upper[k], servo.why[1, k] = high, why


@leaf_kernel
def set_box(drive, ranges, q, far, has_goal, work, servo):
    """Bounds of the step's shares, and why each is where it is. Braking is always inside.

    `far`: how many times as long as the step the way to its stop is.
    """
    first = servo.last.size - drive.others.size
    for k in range(servo.last.size):
        largest, change, last, brake = drive.largest[k], drive.change[k], servo.last[k], servo.brake[k]
        work.system.lower[k], work.system.upper[k] = -1.0, 1.0
        servo.why[0, k], servo.why[1, k] = SPEED, SPEED
        if largest == 0.0:
            work.system.lower[k], work.system.upper[k] = 0.0, 0.0
            continue
        bound(work, servo, k, last - change, last + change, ACCELERATION)
        if has_goal and change < math.inf:
            low = approach(max(-servo.goal[k], -servo.around[k]), -servo.lead[k], change)
            high = approach(max(servo.goal[k], servo.around[k]), servo.lead[k], change)
            bound(work, servo, k, -max(low, change), max(high, change), APPROACH)
        if k >= first or k == 1:
            coordinate = drive.others[k - first] if k >= first else drive.base[2]
            below, above = q[coordinate] - ranges[0, coordinate], ranges[1, coordinate] - q[coordinate]
            low = min(cap_step(below / largest, change), max(below, 0.0) / (largest * far))
            high = min(cap_step(above / largest, change), max(above, 0.0) / (largest * far))
            bound(work, servo, k, -low, high, RANGE)
        if brake < work.system.lower[k]:
            work.system.lower[k], servo.why[0, k] = brake, ACCELERATION
        if brake > work.system.upper[k]:
            work.system.upper[k], servo.why[1, k] = brake, ACCELERATION


@leaf_kernel
def set_wide_box(drive, ranges, q, work):
    """Bounds of a step that may be of any speed: the ranges alone."""
    first = work.system.lower.size - drive.others.size
    for k in range(work.system.lower.size):
        largest = drive.largest[k]
        work.system.lower[k], work.system.upper[k] = -1e9, 1e9
        if largest == 0.0:
            work.system.lower[k], work.system.upper[k] = 0.0, 0.0
        elif k >= first or k == 1:
            coordinate = drive.others[k - first] if k >= first else drive.base[2]
            work.system.lower[k] = min((ranges[0, coordinate] - q[coordinate]) / largest, 0.0)
            work.system.upper[k] = max((ranges[1, coordinate] - q[coordinate]) / largest, 0.0)


@leaf_kernel
def constrain_stop(robot, collision, drive, stop_drive, track, q, q_stop, step, far, entry, work, servo):
    """Rows where a step [D] would stop, at `q_stop` [N]; returns how many.

    `stop_drive` is the drive with steps `far` times as long, `entry` the one that says how long, -1: none does.
    """
    rows, slope = work.constraints, work.constraints.slope
    compute_poses(robot, q_stop, work.T_world_body, work.T_world_tool)
    count = constrain_pairs(robot, collision, stop_drive, track, work.T_world_body, q, step, rows)
    for i in range(count):
        servo.row[i] = rows.pair[i]
    first = count
    if drive.base[0] >= 0:
        count = constrain_base(stop_drive, track, q, q_stop, step, count, rows)
    for i in range(first, count):
        servo.row[i] = BASE_ROW
    before = count
    count = constrain_distance(robot, stop_drive, work.T_world_body, work.T_world_tool, q, step, count, rows)
    if count > before:
        servo.row[before] = DISTANCE_ROW
    if entry >= 0:
        grows = (0.5 if step[entry] > 0.0 else -0.5) / drive.change[entry]
        for i in range(count):
            along = 0.0
            for k in range(step.size):
                along += slope[i, k] * step[k]
            slope[i, entry] += along / far * grows
    before = count
    if drive.base[0] >= 0:
        count = constrain_wheels(drive, step, count, rows)
    for i in range(before, count):
        servo.row[i] = WHEEL_ROW
    return count


@inline_kernel
def note_near(work, servo, count):
    """Rows at the start that are nearer than they may be, into `near` and `slack`; returns how many places."""
    used = np.int64(0)
    for i in range(count):
        if servo.row[i] < 0 or work.constraints.slack[i] >= 0.0:
            continue
        place = used
        for k in range(used):
            if servo.near[k] == servo.row[i]:
                place = np.int64(k)
        if place < MAX_KEPT:
            servo.near[place] = servo.row[i]
            known = servo.slack[place] if place < used else 0.0
            servo.slack[place] = min(known, work.constraints.slack[i])
            used = max(used, place + 1)
    return used


@inline_kernel
def relax(work, servo, count, near, wins, ease):
    """Let what is too near from the start be as near as it is, or a little less; `ease` (m) lets all be nearer."""
    rows = work.constraints
    for i in range(count):
        if servo.row[i] < 0:
            continue
        for k in range(near):
            if servo.near[k] == servo.row[i]:
                attainable = 0.0
                for j in range(servo.step.size):
                    slope = rows.slope[i, j]
                    attainable += slope * (work.system.upper[j] if slope > 0.0 else work.system.lower[j])
                gain = min(-servo.slack[k], ATTAINABLE * max(attainable, 0.0))
                rows.slack[i] -= servo.slack[k] + (gain if wins else 0.0)
        rows.slack[i] += ease


@inline_kernel
def add_cuts(work, servo, count, cuts):
    """Append rows of earlier rounds to those at the step in `servo.step` [D]; returns how many there are then."""
    rows, step = work.constraints, servo.step
    for i in range(cuts):
        rows.slack[count] = servo.cut_slack[i]
        for k in range(step.size):
            rows.slope[count, k] = servo.cut_slope[i, k]
            rows.slack[count] += servo.cut_slope[i, k] * step[k]
        servo.row[count] = servo.cut_row[i]
        count += 1
    return count


@inline_kernel
def keep_cuts(work, servo, first, count, cuts):
    """Hold on to rows first .. count - 1 of what is near; returns how many are held."""
    rows, step = work.constraints, servo.step
    for i in range(first, count):
        if servo.row[i] < 0 or rows.slack[i] > NEAR_M or cuts == CUTS:
            continue
        servo.cut_slack[cuts], servo.cut_row[cuts] = rows.slack[i], servo.row[i]
        for k in range(step.size):
            servo.cut_slope[cuts, k] = rows.slope[i, k]
            servo.cut_slack[cuts] -= rows.slope[i, k] * step[k]
        cuts += 1
    return cuts


@leaf_kernel
def fit_ranges(drive, ranges, q, far, servo):
    """Shorten entries of the step whose stop, `far` times as far, would leave their range; braking stays possible."""
    first = servo.step.size - drive.others.size
    for k in range(servo.step.size):
        if drive.largest[k] == 0.0 or (k < first and k != 1):
            continue
        coordinate = drive.others[k - first] if k >= first else drive.base[2]
        way = far * drive.largest[k]
        low = min((ranges[0, coordinate] - q[coordinate]) / way, servo.brake[k], 0.0)
        high = max((ranges[1, coordinate] - q[coordinate]) / way, servo.brake[k], 0.0)
        servo.step[k] = min(max(servo.step[k], low), high)
