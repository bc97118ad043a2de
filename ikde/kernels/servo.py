"""One step of a robot towards a target, inside the limits, with a stop behind it that is free.

The step is that of a path (`kernels/constrained_step.py`), with constraints where the robot would stand if it braked,
and with the tool's error damped by its own size: at the edge of reach the Jacobian does not say how fast it fades, the
error does. What is not proved to stop in time (`kernels/stopping.py`) is drawn nearer to braking.
"""

import math

import numpy as np

from ikde.kernels.arrays import DRIFT, CollisionArrays, DriveArrays, TargetArrays, TrackArrays
from ikde.kernels.clearance import compute_clearance
from ikde.kernels.drive import take_drive_step
from ikde.kernels.flat_arguments import unpack_models, unpack_world
from ikde.kernels.jit import counting_kernel, inline_kernel, inline_view_kernel, kernel
from ikde.kernels.servo_parts import (
    aim,
    find_goal,
    find_kept,
    find_moved,
    measure_error,
    measure_place,
    name_active,
    name_worst,
    prefer,
    pull,
    try_step,
    write_motion,
)
from ikde.kernels.servo_room import (
    CLEARANCE,
    DOUBT,
    ERROR,
    ERROR_BEFORE,
    HELD,
    HELD_BY,
    HELD_VALUE,
    IS_BRAKING,
    IS_FREE,
    IS_PROVED,
    MAX_KEPT,
    MEMORY,
    NEAREST,
    NOTHING,
    ORIENTATION_ERROR,
    PLACE,
    POSITION_ERROR,
    REACH,
    ROW,
    make_room,
    make_servo,
)
from ikde.kernels.servo_rows import add_cuts, constrain_stop, fit_ranges, keep_cuts, note_near, relax, set_box
from ikde.kernels.spheres import compute_bounds, compute_centres
from ikde.kernels.stopping import PROVED, brake_step, make_way, stop_factor

ROUNDS, SETTLED = 5, 1e-3  # of one step; shares by which a round may still change it
ENOUGH_M, LITTLE = 1e-8, 0.01  # of the tool's error, and a share of what was taken away of it: no further round
TRUSTED, GOOD, FAIR = 10.0, 0.3, 0.8  # where a round leaves a good share of the error, the next is damped less
HALVINGS = 3  # of what a step has beyond braking, until it is proved
STAYING = 0.999  # share of the error that a step leaves, above which nothing brings the tool nearer
WORSE_M = 1e-7  # by which a step may leave a larger error than braking: what the null space costs
FARTHER_M = 0.25  # what is near is looked for as far as the stop may be, at most
EASED = 0.9  # of what is kept above the safe distance, where nothing else is possible
# Entries of the numbers that stay from step to step.
P_REACH, P_MARGIN, P_LENGTH, P_HALF_TRACK, P_WHEEL, P_FAR, P_BODY, P_CENTRE, P_WEIGHTS = 0, 1, 2, 3, 4, 5, 6, 7, 10


@kernel
def make_drive(plan, base, rates, dt):
    """`DriveArrays` of steps of `dt` s; `rates` [3, D]: speeds, accelerations, the largest step of all."""
    size = rates.shape[1]
    largest, change = np.empty(size), np.full(size, np.inf)
    for k in range(size):
        largest[k] = min(rates[0, k] * dt, rates[2, k])
        if largest[k] > 0.0 and rates[1, k] < math.inf:
            change[k] = rates[1, k] * dt * dt / largest[k]
    wheel, centre = plan[P_WHEEL] * dt, plan[P_CENTRE : P_CENTRE + 3]
    return DriveArrays(
        base[:3], base[3:], largest, change, plan[P_HALF_TRACK], wheel, int(plan[P_BODY]), centre, plan[P_FAR]
    )


@kernel
def put_into(own, world):
    """The same collision model in a packed world."""
    return CollisionArrays(
        own.safe_distance,
        own.p_body_sphere,
        own.radius,
        own.components,
        own.bounds,
        own.pairs,
        own.rows,
        own.offset,
        world,
    )


@inline_view_kernel
def look_farther(track, reach):
    """The same settings with another reach."""
    return TrackArrays(
        track.ranges,
        reach,
        track.margin,
        track.rotation_length,
        track.position_goal,
        track.orientation_goal,
        track.position_tolerance,
        track.orientation_tolerance,
        track.max_rounds,
    )


@inline_view_kernel
def stretch(drive, largest, far):
    """The same drive with steps `far` times as long, in `largest` [D]."""
    for k in range(largest.size):
        largest[k] = far * drive.largest[k]
    return DriveArrays(
        drive.base,
        drive.others,
        largest,
        drive.change,
        drive.half_track,
        drive.wheel_travel,
        drive.centre_body,
        drive.p_body_centre,
        drive.max_distance,
    )


@inline_kernel
def find_far_reach(track, drive, radii, far, last):
    """How far what is near is looked for: as far as a step after `last` [D] may take anything to its stop, m."""
    if track.reach == -math.inf:
        return track.reach
    most, first = 0.0, last.size - drive.others.size
    for row in range(radii.shape[0]):
        total = 0.0
        for k in range(last.size):
            joint = drive.others[k - first] if k >= first else drive.base[2 * k]
            total += radii[row, joint] * drive.largest[k] * min(abs(last[k]) + drive.change[k], 1.0)
        most = max(most, total)
    return track.reach + min(far * most, FARTHER_M)


@inline_kernel
def has_change(drive):
    """Whether any entry may change by no more than so much."""
    least = math.inf
    for k in range(drive.change.size):
        least = min(least, drive.change[k])
    return least < math.inf


@counting_kernel
def search_step(robot, collision, drive, track, target, weights, q, radii, work, servo, out_codes):
    """The best step [D] into `servo.step`, and what holds it."""
    step, size = servo.step, servo.step.size
    has_goal = has_change(drive)
    far, entry = stop_factor(drive, servo.last)
    far = far + 0.5 if has_goal else far
    wide, entry = look_farther(track, find_far_reach(track, drive, radii, far, servo.last)), np.int64(-1)
    near, ease, is_met, wins, count = np.int64(0), 0.0, True, True, np.int64(0)
    trust, before, change, cuts, first_m = 1.0, math.inf, math.inf, np.int64(0), 0.0
    for round_ in range(ROUNDS):
        if round_ > 0:
            far, entry = stop_factor(drive, step)
        stop_drive = stretch(drive, servo.largest, far)
        take_drive_step(stop_drive, q, step, servo.q_end)
        near_by = wide if round_ < 2 else track
        count = constrain_stop(
            robot, collision, drive, stop_drive, near_by, q, servo.q_end, step, far, entry, work, servo
        )
        if round_ == 0:
            near = note_near(work, servo, count)
        take_drive_step(drive, q, step, servo.q_end)
        rows, error_m, _, _ = aim(robot, drive, track, target, q, servo.q_end, step, work)
        if round_ > 0:
            is_done = round_ > 1 and before - error_m < LITTLE * (first_m - error_m)
            if is_met and (error_m <= ENOUGH_M or change < SETTLED or is_done):
                break
            share = error_m / max(before, 1e-12)
            trust = TRUSTED * trust if share < GOOD else (trust if share < FAIR else 1.0)
        before = error_m
        if round_ == 0:
            first_m = error_m
            prefer(robot, collision, drive, track, target, weights, q, count, rows, work, servo)
            aim(robot, drive, track, target, q, servo.q_end, step, work)
            if has_goal:
                find_goal(drive, track, q, rows, error_m, count, work, servo)
        set_box(drive, track.ranges, q, far, has_goal, work, servo)
        relax(work, servo, count, near, wins, ease)
        found, count = count, add_cuts(work, servo, count, cuts)
        for k in range(size):
            servo.tried[k] = step[k]
        cuts = keep_cuts(work, servo, 0, found, cuts)
        is_met = pull(work, rows, error_m / trust, count, step)
        if is_met:
            name_active(work, servo, count, out_codes)
        else:
            name_worst(work, servo, found, out_codes)
            cuts, wins, ease = np.int64(0), False, EASED * (track.margin - collision.safe_distance)
        change = 0.0
        for k in range(size):
            change = max(change, abs(step[k] - servo.tried[k]))
            work.preferred[k] = step[k]
    far, _ = stop_factor(drive, step)
    fit_ranges(drive, track.ranges, q, far, servo)


@counting_kernel
def choose_step(robot, collision, world, has_world, drive, track, target, radii, q, kept, way, work, servo, out_codes):
    """Of the step that was found, and what lies between it and braking, the first that may be taken, into `step`."""
    is_worse, share = False, 1.0
    braked, _, _ = measure_error(robot, drive, track, target, q, servo.brake, work, servo)
    for _ in range(HALVINGS + 1):
        for k in range(servo.step.size):
            servo.tried[k] = servo.brake[k] + share * (servo.step[k] - servo.brake[k])
        share *= 0.5
        error_m, _, _ = measure_error(robot, drive, track, target, q, servo.tried, work, servo)
        if kept == 0 and error_m > braked + WORSE_M:
            is_worse = True
            continue
        doubt, is_inside = try_step(
            robot, collision, world, has_world, drive, track, radii, q, servo.tried, kept, way, servo
        )
        if doubt == PROVED and is_inside:
            for k in range(servo.step.size):
                servo.step[k] = servo.tried[k]
            out_codes[IS_PROVED] = 1
            return is_worse
        if doubt != PROVED and out_codes[DOUBT] == PROVED:
            out_codes[DOUBT] = doubt
    for k in range(servo.step.size):
        servo.step[k] = servo.brake[k]
    return is_worse


@counting_kernel
def find_step(robot, collision, drive, track, target, weights, radii, q, was_free, work, servo, out_codes):
    """The step [D] into `servo.step`, and why it is no better into `out_codes`."""
    world = unpack_world(collision.world)
    has_world = world.solids.shape[0] > 0
    way = make_way(robot, collision, q.size, servo.step.size, MAX_KEPT)
    kept, is_worse = np.int64(0), False
    if target.kind[0] >= 0:
        search_step(robot, collision, drive, track, target, weights, q, radii, work, servo, out_codes)
        kept = find_kept(robot, collision, world, has_world, drive, q, way, servo)
        is_worse = choose_step(
            robot, collision, world, has_world, drive, track, target, radii, q, kept, way, work, servo, out_codes
        )
    else:
        for k in range(servo.step.size):
            servo.step[k] = servo.brake[k]
    if out_codes[IS_PROVED] == 0:
        out_codes[IS_BRAKING] = 1
        doubt, is_inside = np.int64(PROVED), True  # braking goes along what the step before has proved
        if not was_free:
            doubt, is_inside = try_step(
                robot, collision, world, has_world, drive, track, radii, q, servo.brake, kept, way, servo
            )
        out_codes[IS_PROVED] = 1 if doubt == PROVED and is_inside else 0
        if out_codes[DOUBT] == PROVED:
            out_codes[DOUBT] = doubt
    if out_codes[DOUBT] != PROVED:
        out_codes[HELD], out_codes[HELD_BY] = PLACE, out_codes[DOUBT]
    elif is_worse and out_codes[HELD] == NOTHING:
        out_codes[HELD] = REACH


@kernel
def servo_step(
    numbers,
    whole,
    world,
    plan,
    base,
    ranges,
    rates,
    radii,
    T_world_tool,
    kind,
    dt,
    q,
    speeds,
    memory,
    out,
    out_numbers,
    out_codes,
):
    """Step from `q` [N] at `speeds` [D] (m/s, rad/s, of the step before) towards a target, in `dt` s.

    `numbers`, `whole`: the models, as `flatten_models` lays them out without a world; `world`: that. `plan`, `base`,
    `ranges` [2, N], `rates` [3, D], `radii` [P + C, N]: as `track/servo_plan.py` packs them. `kind`: -1 brakes.
    `memory` [MEMORY]: of its target before, as `find_moved` writes it. `out` [3 N + D + MEMORY]: the next
    configuration, its speeds by joint, where it would stop, the speeds of the step, and memory.
    """
    robot, own = unpack_models(numbers, whole)
    collision = put_into(own, world)
    drive, size = make_drive(plan, base, rates, dt), rates.shape[1]
    track = TrackArrays(ranges, plan[P_REACH], plan[P_MARGIN], plan[P_LENGTH], 0.0, 0.0, 0.0, 0.0, ROUNDS)
    target = TargetArrays(np.full(1, kind), T_world_tool.reshape((1, 3, 4)))
    weights = np.zeros(DRIFT + size)
    weights[:DRIFT] = plan[P_WEIGHTS : P_WEIGHTS + DRIFT]
    work, servo = make_room(robot, collision, q.size, size), make_servo(q.size, size)
    for k in range(size):
        servo.last[k] = speeds[k] * dt / drive.largest[k] if drive.largest[k] > 0.0 else 0.0
    brake_step(drive, servo.last, servo.brake)
    out_codes[:], out_numbers[:] = 0, 0.0
    out_codes[DOUBT] = PROVED
    find_moved(target, track, dt, memory, out[out.size - MEMORY :], servo)
    if kind >= 0:
        before, _, _ = measure_error(robot, drive, track, target, q, servo.step, work, servo)
        out_numbers[ERROR_BEFORE] = before
    find_step(robot, collision, drive, track, target, weights, radii, q, memory[IS_FREE] > 0.0, work, servo, out_codes)
    out[out.size - MEMORY + IS_FREE] = out_codes[IS_PROVED]
    write_motion(drive, q, dt, servo, out)
    error_m, position, orientation = measure_error(robot, drive, track, target, q, servo.step, work, servo)
    out_numbers[ERROR], out_numbers[POSITION_ERROR], out_numbers[ORIENTATION_ERROR] = error_m, position, orientation
    if out_codes[HELD] == NOTHING and error_m > STAYING * out_numbers[ERROR_BEFORE]:
        out_codes[HELD] = REACH
    contacts = work.constraints.contacts
    compute_bounds(collision, work.T_world_body, contacts.bounds)
    compute_centres(collision, work.T_world_body, contacts.centres)
    out_numbers[CLEARANCE], out_codes[NEAREST] = compute_clearance(collision, contacts.bounds, contacts.centres)
    if out_codes[HELD] == PLACE or (out_codes[HELD] == ROW and out_codes[HELD_BY] >= 0):
        out_numbers[HELD_VALUE] = measure_place(collision, contacts.centres, out_codes[HELD_BY])
