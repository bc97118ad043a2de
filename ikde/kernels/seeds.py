"""Where a descent starts: the one of a few collision-free configurations whose tool is nearest to the target.

The pool holds configurations that are free of collision, with their tool poses, sorted by the cells of a grid over
those poses: what is near the target is found at once. Where the robot has a planar base (`SeedArrays.base`), the base
does the rest: whatever the arm does, the base can bring the tool over the target and to the target's heading. Then only
height and tilt count, and the base is set afterwards.
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
COMPARED_HELD = 128  # where joints of the base are frozen: height and tilt, which the pool is sorted by, say less then
LUCKY_ATTEMPTS = 6  # after as many failures the nearest ones are stuck: any configuration will do


@inline_kernel
def draw_seed(seeds, target, index, ranges, state, attempt, out_q):
    """Fill `out_q` [N] with the start of one attempt; every choice hangs on the random stream `state` alone."""
    if seeds.q.shape[0] == 0:
        draw_uniform(ranges, seeds.first_box, state, attempt, out_q)
        return
    drives, angle = seeds.base[0] >= 0, 0.0
    is_held = drives and holds_base(seeds, ranges)
    first, count = draw_window(seeds, target, index, state, attempt, COMPARED_HELD if is_held else COMPARED)
    if is_held:
        best, angle = find_held(seeds, target, index, ranges, state, first, count)
    elif drives:
        best = find_height_and_tilt(seeds, target, index, first, count)
        angle = find_angle(seeds, target, index, ranges, state, best)
    else:
        best = find_pose(seeds, target, index, first, count)
    for k in range(out_q.size):
        out_q[k] = seeds.q[best, k]
    if drives:
        set_base(seeds, target, index, ranges, best, angle, out_q)


@inline_kernel
def draw_window(seeds, target, index, state, attempt, compared):
    """The first of the configurations to compare, and how many."""
    size = seeds.q.shape[0]
    if attempt >= LUCKY_ATTEMPTS:
        return next_index(state, size), 1
    cell = find_cell(seeds, target, index)
    first, last = seeds.cell_start[cell], seeds.cell_start[cell + 1]
    spare = (WINDOW // COMPARED * compared << attempt) - (last - first)
    if spare > 0:
        first, last = first - spare // 2, last + spare // 2
    count = min(compared, size)
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
def set_base(seeds, target, index, ranges, best, angle, q):
    """Drive the base, rotated by `angle`, so that the tool stands over the target: the pool's own base is at zero."""
    T, P = target.T_world_tool[index], seeds.T_world_tool
    x, y, yaw = seeds.base[0], seeds.base[1], seeds.base[2]
    s, c = sin_cos(angle)
    q[yaw] = angle
    q[x] = min(max(T[0, 3] - c * P[best, X] + s * P[best, Y], ranges[0, x]), ranges[1, x])
    q[y] = min(max(T[1, 3] - s * P[best, X] - c * P[best, Y], ranges[0, y]), ranges[1, y])


@inline_kernel
def find_angle(seeds, target, index, ranges, state, best):
    """The angle of the base at which the tool heads as the target does; any one if the target has no heading."""
    yaw = seeds.base[2]
    across, along = find_heading(target.T_world_tool[index], seeds.T_world_tool, target.kind[index], best)
    if across == 0.0 and along == 0.0:
        return ranges[0, yaw] + next_uniform(state) * (ranges[1, yaw] - ranges[0, yaw])
    angle = math.copysign(angle_from_sides(abs(across), along), across)
    return min(max(angle, ranges[0, yaw]), ranges[1, yaw])


@inline_kernel
def find_heading(T, P, kind, i):
    """Sine and cosine, times a length, of the heading that rotates the tool of configuration `i` to the target's."""
    across, along = 0.0, 0.0
    if kind == AXIS:
        across, along = P[i, Z_X] * T[1, 2] - P[i, Z_Y] * T[0, 2], P[i, Z_X] * T[0, 2] + P[i, Z_Y] * T[1, 2]
    elif kind == POSE:
        for k, x_entry, y_entry in ((0, X_X, X_Y), (1, Y_X, Y_Y), (2, Z_X, Z_Y)):
            across += P[i, x_entry] * T[1, k] - P[i, y_entry] * T[0, k]
            along += P[i, x_entry] * T[0, k] + P[i, y_entry] * T[1, k]
    return across, along


# ---- a base of which joints are frozen


@inline_kernel
def holds_base(seeds, ranges):
    """True if a joint of the base that is set for each target cannot move."""
    x, y, yaw = seeds.base[0], seeds.base[1], seeds.base[2]
    return ranges[0, x] == ranges[1, x] or ranges[0, y] == ranges[1, y] or ranges[0, yaw] == ranges[1, yaw]


@inline_kernel
def find_held(seeds, target, index, ranges, state, first, count):
    """The one of `count` configurations whose tool comes nearest to the target by what the base still can.

    Returns the angle of the base, too.
    """
    T, P, kind = target.T_world_tool[index], seeds.T_world_tool, target.kind[index]
    x, y, yaw = seeds.base[0], seeds.base[1], seeds.base[2]
    is_fixed = ranges[0, yaw] == ranges[1, yaw]
    side = 1.0 if next_uniform(state) < 0.5 else -1.0
    s, c = sin_cos(ranges[0, yaw])
    length = 2.0 * seeds.rotation_length * seeds.rotation_length
    best, smallest, best_s, best_c = first, np.inf, s, c
    for i in range(first, first + count):
        across, along = find_heading(T, P, kind, i)
        if not is_fixed:
            s, c = rotate_held_base(T, P, ranges, x, y, i, 0.5 * length, across, along, side)
        dx, dy = T[0, 3] - c * P[i, X] + s * P[i, Y], T[1, 3] - s * P[i, X] - c * P[i, Y]
        dx -= min(max(dx, ranges[0, x]), ranges[1, x])
        dy -= min(max(dy, ranges[0, y]), ranges[1, y])
        dz, likeness = T[2, 3] - P[i, Z], c * along + s * across
        if kind != POSITION:
            likeness += P[i, Z_Z] * T[2, 2]
        if kind == POSE:
            likeness += P[i, X_Z] * T[2, 0] + P[i, Y_Z] * T[2, 1]
        distance = dx * dx + dy * dy + dz * dz - length * likeness
        if distance < smallest:
            best, smallest, best_s, best_c = i, distance, s, c
    angle = ranges[0, yaw] if is_fixed else math.copysign(angle_from_sides(abs(best_s), best_c), best_s)
    return best, min(max(angle, ranges[0, yaw]), ranges[1, yaw])


@inline_kernel
def rotate_held_base(T, P, ranges, x, y, i, weight, across, along, side):
    """Sine and cosine of a base's heading whose x or y is frozen.

    Both frozen: the best for place and heading, a radian counting as the root of `weight`. One: the target's heading,
    or if it has none one of the two that bring the tool over it, one to each `side`, 1 or -1.
    """
    dx, dy = T[0, 3] - ranges[0, x], T[1, 3] - ranges[0, y]
    moves_x, moves_y = ranges[0, x] < ranges[1, x], ranges[0, y] < ranges[1, y]
    if moves_x or moves_y:
        if across == 0.0 and along == 0.0:
            square = P[i, X] * P[i, X] + P[i, Y] * P[i, Y]
            if moves_x:
                dx = side * math.sqrt(max(square - dy * dy, 0.0))
            else:
                dy = side * math.sqrt(max(square - dx * dx, 0.0))
        else:
            dx, dy = 0.0, 0.0
    across = weight * across + P[i, X] * dy - P[i, Y] * dx
    along = weight * along + P[i, X] * dx + P[i, Y] * dy
    size = math.sqrt(across * across + along * along)
    if size == 0.0:
        return 0.0, 1.0
    return across / size, along / size
