"""Where a descent starts: the one of a few collision-free configurations whose tool is nearest to the target.

The pool holds configurations that are free of collision, with their tool poses, sorted by the cells of a grid over
those poses: what is near the target is found at once. Where the robot drives on a plane that it may turn on
(`SeedArrays.base`), the base does the rest: whatever the arm does, the base can bring the tool over the target and turn
it to the target's heading. Then only height and tilt count, and the base is set afterwards.
"""

import math

import numpy as np

from ikde.kernels.arrays import AXIS, POSE, POSITION
from ikde.kernels.jit import inline_kernel
from ikde.kernels.rng import next_index, next_uniform
from ikde.kernels.trig import angle_from_sides, sin_cos

# Columns of `SeedArrays.T_world_tool`: where the tool is, then its axes z, x and y.
X, Y, Z, Z_X, Z_Y, Z_Z, X_X, X_Y, X_Z, Y_X, Y_Y, Y_Z = range(12)
WINDOW = 32  # configurations around the target's cell that a seed is chosen from; doubled with every attempt
COMPARED = 16  # of the window, by their poses
LUCKY_ATTEMPTS = 6  # after as many failures the nearest ones are stuck: any configuration will do


@inline_kernel
def draw_seed(seeds, target, index, ranges, state, attempt, out_q):
    """Fill `out_q` [N] with the start of one attempt; every choice hangs on the random stream `state` alone."""
    if seeds.q.shape[0] == 0:
        draw_uniform(ranges, seeds.first_box, state, attempt, out_q)
        return
    drives = seeds.base[0] >= 0
    first, count = draw_window(seeds, target, index, state, attempt)
    best = (
        find_height_and_tilt(seeds, target, index, first, count)
        if drives
        else find_pose(seeds, target, index, first, count)
    )
    for k in range(out_q.size):
        out_q[k] = seeds.q[best, k]
    if drives:
        set_base(seeds, target, index, ranges, state, best, out_q)


@inline_kernel
def draw_window(seeds, target, index, state, attempt):
    """The first of the configurations to compare, and how many."""
    size = seeds.q.shape[0]
    if attempt >= LUCKY_ATTEMPTS:
        return next_index(state, size), 1
    cell = find_cell(seeds, target, index)
    first, last = seeds.cell_start[cell], seeds.cell_start[cell + 1]
    spare = (WINDOW << attempt) - (last - first)
    if spare > 0:
        first, last = first - spare // 2, last + spare // 2
    count = min(COMPARED, size)
    first += next_index(state, max(last - first - count, 0) + 1)
    return min(max(first, 0), size - count), count


@inline_kernel
def find_cell(seeds, target, index):
    """The cell of the grid that the target lies in, or the nearest one."""
    cell = 0
    for k in range(seeds.grid.shape[0]):
        entry, bins = seeds.grid[k, 0], seeds.grid[k, 1]
        value = (target.T_world_tool[index, entry // 4, entry % 4] - seeds.grid_scale[k, 0]) * seeds.grid_scale[k, 1]
        cell = cell * bins + min(max(np.int64(value), 0), bins - 1)
    return cell


@inline_kernel
def draw_uniform(ranges, first_box, state, attempt, out_q):
    """First ranges[2] itself, then uniform in a box about it that doubles with each attempt."""
    share = first_box
    for _ in range(attempt - 1):
        share = min(1.0, 2.0 * share)
    for k in range(out_q.size):
        lower, upper, near = ranges[0, k], ranges[1, k], ranges[2, k]
        low, high = max(lower, near - share * (upper - lower)), min(upper, near + share * (upper - lower))
        out_q[k] = near if attempt == 0 and first_box < 1.0 else low + next_uniform(state) * (high - low)


@inline_kernel
def find_height_and_tilt(seeds, target, index, first, count):
    """The one of `count` configurations from `first` on whose tool is nearest in height and lean to the target."""
    T, P, kind = target.T_world_tool[index], seeds.T_world_tool, target.kind[index]
    length = seeds.rotation_length * seeds.rotation_length
    best, smallest = first, np.inf
    for i in range(first, first + count):
        dz, tilt = P[i, Z] - T[2, 3], 0.0
        if kind != POSITION:
            lean = P[i, Z_Z] - T[2, 2]
            tilt = lean * lean  # not lean**2: Python rounds one in 1,000 of its powers otherwise
        if kind == POSE:
            lean_x, lean_y = P[i, X_Z] - T[2, 0], P[i, Y_Z] - T[2, 1]
            tilt += lean_x * lean_x + lean_y * lean_y
        distance = dz * dz + length * tilt
        if distance < smallest:
            best, smallest = i, distance
    return best


@inline_kernel
def find_pose(seeds, target, index, first, count):
    """The one of `count` configurations from `first` on whose tool is nearest to the target."""
    T, P, kind = target.T_world_tool[index], seeds.T_world_tool, target.kind[index]
    length = 2.0 * seeds.rotation_length * seeds.rotation_length
    best, smallest = first, np.inf
    for i in range(first, first + count):
        dx, dy, dz = P[i, X] - T[0, 3], P[i, Y] - T[1, 3], P[i, Z] - T[2, 3]
        likeness = 0.0
        if kind != POSITION:
            likeness = P[i, Z_X] * T[0, 2] + P[i, Z_Y] * T[1, 2] + P[i, Z_Z] * T[2, 2]
        if kind == POSE:
            likeness += P[i, X_X] * T[0, 0] + P[i, X_Y] * T[1, 0] + P[i, X_Z] * T[2, 0]
            likeness += P[i, Y_X] * T[0, 1] + P[i, Y_Y] * T[1, 1] + P[i, Y_Z] * T[2, 1]
        distance = dx * dx + dy * dy + dz * dz - length * likeness
        if distance < smallest:
            best, smallest = i, distance
    return best


@inline_kernel
def set_base(seeds, target, index, ranges, state, best, q):
    """Drive the base so that the tool stands over the target and heads as it does: the pool's own base is at zero."""
    T, P, kind = target.T_world_tool[index], seeds.T_world_tool, target.kind[index]
    x, y, turn = seeds.base[0], seeds.base[1], seeds.base[2]
    across, along = 0.0, 0.0  # sine and cosine of the heading to turn by, times a length
    if kind == AXIS:
        across, along = P[best, Z_X] * T[1, 2] - P[best, Z_Y] * T[0, 2], P[best, Z_X] * T[0, 2] + P[best, Z_Y] * T[1, 2]
    elif kind == POSE:
        for k, x_entry, y_entry in ((0, X_X, X_Y), (1, Y_X, Y_Y), (2, Z_X, Z_Y)):
            across += P[best, x_entry] * T[1, k] - P[best, y_entry] * T[0, k]
            along += P[best, x_entry] * T[0, k] + P[best, y_entry] * T[1, k]
    if across == 0.0 and along == 0.0:
        angle = ranges[0, turn] + next_uniform(state) * (ranges[1, turn] - ranges[0, turn])
    else:
        angle = math.copysign(angle_from_sides(abs(across), along), across)
        angle = min(max(angle, ranges[0, turn]), ranges[1, turn])
    s, c = sin_cos(angle)
    q[turn] = angle
    q[x] = min(max(T[0, 3] - c * P[best, X] + s * P[best, Y], ranges[0, x]), ranges[1, x])
    q[y] = min(max(T[1, 3] - s * P[best, X] - c * P[best, Y], ranges[0, y]), ranges[1, y])
