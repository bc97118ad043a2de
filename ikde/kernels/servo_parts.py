"""What a step towards a target is made of: its preferred part, the pull of the target, what holds it, and its proof."""

import math

import numpy as np

from ikde.kernels.arrays import MANIPULABILITY, POSITION
from ikde.kernels.constrained_step import add_normal, factor, measure_travel, solve_step
from ikde.kernels.damped import compute_error
from ikde.kernels.drive import take_drive_step
from ikde.kernels.flat_arguments import unpack_world
from ikde.kernels.jit import counting_kernel, inline_kernel, leaf_kernel
from ikde.kernels.nullspace import MAX_SHARE, avoid_contacts, avoid_limits, limit_preferred, start_preferred
from ikde.kernels.obstacles import BOUND, OWNER
from ikde.kernels.obstacles import PLACE as PLACE_OF
from ikde.kernels.servo_room import BOX, HELD, HELD_BY, HELD_SIDE, HELD_WHY, MAX_KEPT, NOTHING, ROW
from ikde.kernels.servo_rows import set_wide_box
from ikde.kernels.stopping import (
    PROVED,
    gets_no_deeper,
    measure_kept,
    measure_way,
    place_way,
    prove_way,
    stays_in_ranges,
    stop_factor,
)
from ikde.kernels.tracking import STIFFNESS, add_manipulability_gradient, compute_poses, fill_step_jacobian
from ikde.kernels.trig import sin_cos

DAMPED_M = 1.0  # of the tool's error: so much counts as much as the tool's usual travel
FAR_TRUST = 5.0  # the tool's error is damped by so much less where the whole way to the target is looked for


@inline_kernel
def square_error(error, rows):
    """Sum of the squares of the first rows."""
    square = 0.0
    for i in range(rows):
        square += error[i] * error[i]
    return square


@leaf_kernel
def prefer(robot, collision, drive, track, target, weights, q, count, rows, work, servo):
    """What the null space is used for, of which nothing moves the tool, into `preferred`; poses are those at `q`.

    It is a share of how fast the robot moves: what stands at its target, or is held, comes to rest.
    """
    start_preferred(weights, work.preferred)
    avoid_limits(drive, track, weights, q, work.preferred)
    avoid_contacts(track, weights, count, work.constraints, work.preferred)
    if weights[MANIPULABILITY] > 0.0:
        add_manipulability_gradient(robot, drive, track, target, 0, weights, q, servo.step, work)
    moves = 0.0
    for k in range(servo.step.size):
        moves = max(moves, abs(servo.last[k]))
    for k in range(servo.step.size):
        work.preferred[k] = moves * min(max(work.preferred[k], -MAX_SHARE), MAX_SHARE)
    limit_preferred(drive, servo.last, work.preferred)
    system = work.system
    stiffness = STIFFNESS / measure_travel(work.jacobian, rows)
    factor(work.jacobian, rows, stiffness, system.matrix, system.inverse)
    for a in range(servo.step.size):
        system.y[a] = 0.0
        for k in range(a + 1):
            system.y[a] += system.inverse[a, k] * work.preferred[k]
    share = 1.0
    for k in range(servo.step.size):
        work.preferred[k] = 0.0
        for a in range(k, servo.step.size):
            work.preferred[k] += system.inverse[a, k] * system.y[a]
        most = max(drive.change[k], abs(servo.brake[k]))
        if abs(work.preferred[k]) > most:
            share = min(share, most / abs(work.preferred[k]))
    for k in range(servo.step.size):
        work.preferred[k] *= share


@leaf_kernel
def aim(robot, drive, track, target, q, q_end, step, work):
    """Error and Jacobian of the tool at `q_end` [N], where a step [D] ends; returns rows, and the errors."""
    compute_poses(robot, q_end, work.T_world_body, work.T_world_tool)
    position, orientation = compute_error(target, 0, track.rotation_length, work.T_world_tool, work.error)
    rows = fill_step_jacobian(robot, drive, track, target, 0, q, step, work)
    return rows, math.sqrt(square_error(work.error, rows)), position, orientation


@leaf_kernel
def pull(work, rows, error_m, count, step):
    """One damped, constrained improvement of `step` [D]; False if no step meets all constraints."""
    stiffness = min(STIFFNESS, DAMPED_M / max(error_m, 1e-12)) / measure_travel(work.jacobian, rows)
    parts = (work.preferred, work.constraints.slack, work.constraints.slope, count, work.system, step)
    return solve_step(work.jacobian, work.error, rows, stiffness, *parts)


@leaf_kernel
def measure_error(robot, drive, track, target, q, step, work, servo):
    """The tool's error at the end of a step [D], m, and of its position and orientation."""
    take_drive_step(drive, q, step, servo.q_end)
    compute_poses(robot, servo.q_end, work.T_world_body, work.T_world_tool)
    position, orientation = compute_error(target, 0, track.rotation_length, work.T_world_tool, work.error)
    rows = 3 if target.kind[0] == POSITION else 6
    return math.sqrt(square_error(work.error, rows)), position, orientation


@leaf_kernel
def name_active(work, servo, count, out_codes):
    """The constraint with the largest multiplier of the last step, into what the step gives."""
    system, size = work.system, servo.step.size
    at = np.int64(2 * size)
    for i in range(count):  # as `set_half_spaces` numbers them
        after = add_normal(system, work.constraints.slope[i], 0.0, at)
        if after > at:
            servo.row[at - 2 * size] = servo.row[i]
        at = after
    active, largest = np.int64(0), 0.0
    out_codes[HELD] = NOTHING
    while system.spaces.active[active] >= 0:
        number, force = system.spaces.active[active], system.spaces.multipliers[active]
        active += 1
        if force <= largest:
            continue
        largest = force
        if number < 2 * size:
            out_codes[HELD], out_codes[HELD_BY], out_codes[HELD_SIDE] = BOX, number // 2, number % 2
            out_codes[HELD_WHY] = servo.why[number % 2, number // 2]
        else:
            out_codes[HELD], out_codes[HELD_BY] = ROW, servo.row[number - 2 * size]


@inline_kernel
def name_worst(work, servo, count, out_codes):
    """The row that is farthest from being met, where no step meets all of them."""
    least = math.inf
    for i in range(count):
        if work.constraints.slack[i] < least:
            least = work.constraints.slack[i]
            out_codes[HELD], out_codes[HELD_BY] = ROW, servo.row[i]


@counting_kernel
def measure_place(collision, centres, place):
    """Distance of what stands at a place in the table of clearances, less what it asks for beyond the safe one, m."""
    world, pairs = unpack_world(collision.world), collision.pairs.shape[0]
    if place < pairs:
        return measure_kept(world, collision, centres, place)
    solids, obstacles, least = world.solids.shape[0], world.asked.shape[1], math.inf
    component, owner = (place - pairs) // obstacles, (place - pairs) % obstacles
    for s in range(solids):
        if int(world.solids[s, OWNER]) == owner:
            least = min(least, measure_kept(world, collision, centres, pairs + component * solids + s))
    return least + collision.safe_distance


@inline_kernel
def is_near(collision, way, component, x, y, z, reach):
    """Whether a point is within `reach` of the sphere about a component, in slot 0."""
    bounds = way.bounds[0]
    dx, dy, dz = bounds[component, 0] - x, bounds[component, 1] - y, bounds[component, 2] - z
    limit = collision.bounds[component, 3] + reach
    return dx * dx + dy * dy + dz * dz <= limit * limit


@counting_kernel
def find_kept(robot, collision, world, has_world, drive, q, way, servo):
    """What is in contact at `q` [N], as the proof names it; returns how many."""
    kept, pairs, solids = np.int64(0), collision.pairs.shape[0], world.solids.shape[0]
    place_way(robot, collision, drive, q, servo.brake, 0.0, 0, way)
    for pair in range(pairs):
        a, b = collision.pairs[pair, 0], collision.pairs[pair, 1]
        x, y, z = way.bounds[0, b, 0], way.bounds[0, b, 1], way.bounds[0, b, 2]
        reach = collision.bounds[b, 3] + collision.safe_distance
        if kept == MAX_KEPT or not is_near(collision, way, a, x, y, z, reach):
            continue
        if measure_kept(world, collision, way.centres[0], pair) <= collision.safe_distance:
            way.kept[kept] = pair
            kept += 1
    for component in range(collision.components.shape[0] if has_world else 0):
        for s in range(solids):
            asked = world.asked[component, int(world.solids[s, OWNER])]
            x, y, z = world.solids[s, PLACE_OF], world.solids[s, PLACE_OF + 1], world.solids[s, PLACE_OF + 2]
            if asked == -math.inf or kept == MAX_KEPT:
                continue
            if not is_near(collision, way, component, x, y, z, world.solids[s, BOUND] + asked):
                continue
            key = pairs + component * solids + s
            if measure_kept(world, collision, way.centres[0], key) <= 0.0:
                way.kept[kept] = key
                kept += 1
    return kept


@inline_kernel
def place_of(collision, world, key):
    """The place in the table of clearances of what the proof names."""
    pairs, solids = collision.pairs.shape[0], world.solids.shape[0]
    if key < pairs:
        return np.int64(key)
    component, s = (key - pairs) // solids, (key - pairs) % solids
    return np.int64(pairs + component * world.asked.shape[1] + int(world.solids[s, OWNER]))


@counting_kernel
def try_step(robot, collision, world, has_world, drive, track, radii, q, step, kept, way, servo):
    """What is not proved of the way of a step [D] to its stop (`PROVED`: all is), and if it stays in the ranges."""
    far, _ = stop_factor(drive, step)
    for k in range(step.size):
        servo.goal[k] = far * step[k]
    take_drive_step(drive, q, servo.goal, servo.q_end)
    is_inside = stays_in_ranges(drive, track.ranges, q, servo.q_end, servo.goal)
    if track.reach == -math.inf:
        return np.int64(PROVED), is_inside
    rotation = measure_way(robot, drive, radii, step, far, way)
    if kept > 0 and not gets_no_deeper(robot, collision, world, drive, q, servo.goal, kept, way):
        return place_of(collision, world, way.kept[0]), is_inside
    return prove_way(robot, collision, world, has_world, drive, q, servo.goal, rotation, kept, way), is_inside


@counting_kernel
def find_goal(drive, track, q, rows, error_m, count, work, servo):
    """The whole way to the target, as if speeds had no limits, into `servo.goal`: with what is near, and without.

    Also the step by which the target moves on, into `servo.lead`; its way stands in `servo.moved` [6].
    """
    set_wide_box(drive, track.ranges, q, work)
    for k in range(servo.step.size):
        servo.goal[k] = servo.around[k] = servo.step[k]
        servo.lead[k] = 0.0
    pull(work, rows, error_m / FAR_TRUST, 0, servo.goal)
    if count > 0:
        pull(work, rows, error_m / FAR_TRUST, count, servo.around)
    far = math.sqrt(square_error(servo.moved, rows))
    if far > 0.0:
        for i in range(6):
            work.raw[i, 0] = work.error[i]
            work.error[i] = servo.moved[i]
        for k in range(servo.step.size):
            servo.tried[k], work.preferred[k] = work.preferred[k], 0.0
        pull(work, rows, far / FAR_TRUST, 0, servo.lead)
        for i in range(6):
            work.error[i] = work.raw[i, 0]
        for k in range(servo.step.size):
            work.preferred[k] = servo.tried[k]


@counting_kernel
def find_moved(target, track, dt, memory, out_memory, servo):
    """How far the target moves on in a step, into `servo.moved` [6]: the lesser of how fast it was and is.

    So a jump leads nowhere. `memory` [MEMORY]: its kind, pose and speed at the step before; it is written anew.
    """
    out_memory[:] = 0.0
    out_memory[0] = target.kind[0]
    for i in range(3):
        for j in range(4):
            out_memory[1 + 4 * i + j] = target.T_world_tool[0, i, j]
    if target.kind[0] < 0 or memory[0] != target.kind[0]:
        return
    compute_error(target, 0, track.rotation_length, memory[1:13].copy().reshape((3, 4)), servo.moved)
    for i in range(6):
        now, before = servo.moved[i] / dt, memory[13 + i]
        out_memory[13 + i] = now
        slower = min(abs(now), abs(before)) if now * before > 0.0 else 0.0
        servo.moved[i] = dt * math.copysign(slower, now)


@inline_kernel
def write_motion(drive, q, dt, servo, out):
    """Where the step leads, its speeds at its end, where it would stop, and the speeds of its entries."""
    joints, size, first = q.size, servo.step.size, servo.step.size - drive.others.size
    far, _ = stop_factor(drive, servo.step)
    take_drive_step(drive, q, servo.step, out[:joints])
    for k in range(size):
        out[3 * joints + k] = servo.step[k] * drive.largest[k] / dt
        servo.tried[k] = far * servo.step[k]
    take_drive_step(drive, q, servo.tried, out[2 * joints : 3 * joints])
    speeds = out[3 * joints : 3 * joints + size]
    for k in range(drive.others.size):
        out[joints + drive.others[k]] = speeds[first + k]
    if first == 2:
        s, c = sin_cos(out[drive.base[2]])
        out[joints + drive.base[0]], out[joints + drive.base[1]] = speeds[0] * c, speeds[0] * s
        out[joints + drive.base[2]] = speeds[1]
