"""The engine `analytic`: the closed form of a UR-type arm, whose base stands still or is drawn from the seeds.

An arm that stands still has at most eight branches, whole turns left aside: one attempt knows them all. `answer_pose`
makes it for one target, `solve_poses` for many: the same moves, the same bits.

`model/generate` writes this file once more for a robot, after `kernels/lm.py`, with its own collision check.
"""

import numpy as np

from ikde.kernels.answer import grade_row, open_row
from ikde.kernels.arrays import ATTEMPTS, COLLIDING, EVALUATIONS, REACHED, UNKNOWN_DEPTH, TargetArrays
from ikde.kernels.closed_form import ANGLES, BRANCHES, Room, solve_ur_arm
from ikde.kernels.flat_arguments import grades, unpack_answer, unpack_closed_form, unpack_models
from ikde.kernels.frames import compute_bodies
from ikde.kernels.jit import inline_kernel, kernel
from ikde.kernels.rng import next_index, seed_stream
from ikde.kernels.seeds import draw_seed
from ikde.kernels.tables import find_collision, make_buffers, unpack_used
from ikde.kernels.turns import unwind
from ikde.kernels.world import find_obstacle_at, find_obstacle_of, stands_in_world


@inline_kernel
def find_carried(T_world_carrier, T_world_tool, out_T):
    """T_carrier_tool [3, 4] of a tool pose in the world."""
    for i in range(3):
        a, b, c = T_world_carrier[0, i], T_world_carrier[1, i], T_world_carrier[2, i]
        for j in range(4):
            out_T[i, j] = a * T_world_tool[0, j] + b * T_world_tool[1, j] + c * T_world_tool[2, j]
        out_T[i, 3] -= a * T_world_carrier[0, 3] + b * T_world_carrier[1, 3] + c * T_world_carrier[2, 3]


@inline_kernel
def find_distance(ranges, q):
    """How far `q` is from ranges[2], each joint as a share of its range, squared."""
    total = 0.0
    for k in range(q.size):
        width = ranges[1, k] - ranges[0, k]
        share = (q[k] - ranges[2, k]) / width if width > 0.0 else 0.0
        total += share * share
    return total


@inline_kernel
def place_arm(arm, branch, solutions, out_q):
    """Put one solution of the closed form into a configuration."""
    for joint in range(6):
        out_q[arm.coordinates[joint]] = solutions[branch, joint]


@inline_kernel
def choose_branch(models, arm, ranges, nearest, first, count, solutions, q, buffers, out_counts, out_pairs):
    """A branch that is free of collision, the next from `first` on or the nearest to ranges[2]; -1 if all collide.

    `models`: what `find_collision` takes, then the tables of both, for a world.
    """
    chosen, smallest = -1, np.inf
    for turn in range(count):
        branch = (first + turn) % count
        place_arm(arm, branch, solutions, q)
        distance = find_distance(ranges, q) if nearest else 0.0
        if distance >= smallest:
            continue
        pair = find_collision(models[0], models[1], q, buffers)
        if pair < 0 and models[3].world.size > 0:
            pair = find_obstacle_of(models[2], models[3], q)
        if pair < 0:
            chosen, smallest = branch, distance
            if not nearest:
                break
        else:
            out_counts[COLLIDING] += 1
            out_pairs[pair] += 1
    return chosen


@kernel
def solve_branches(
    robot,
    collision,
    tables,
    arm,
    carrier,
    target,
    rows,
    ranges,
    seeds,
    seed,
    streams,
    attempts,
    out_q,
    out_score,
    out_counts,
    out_pairs,
):
    """All branches of the arm from base after base, for rows[0] .. rows[1] - 1; outputs as `lm.solve_targets`.

    `tables` are the whole collision model, `carrier` is the body that carries the arm. An attempt is one place of the
    base, an evaluation one branch that exists. An unreached target keeps its last colliding branch.
    """
    joints = out_q.shape[1]
    q, state, buffers = np.empty(joints), np.empty(1, dtype=np.uint64), make_buffers(robot, collision, joints)
    T_world_body, T_carrier_tool = np.empty((robot.bodies.shape[0], 3, 4)), np.empty((3, 4))
    work, solutions, codes = np.empty((2, ANGLES)), np.empty((BRANCHES, 6)), np.empty(BRANCHES, dtype=np.int64)
    for row in range(rows[0], rows[1]):
        for attempt in range(attempts[row - rows[0], 0], attempts[row - rows[0], 1]):
            seed_stream(seed, streams[row], attempt, state)
            draw_seed(seeds, target, row, ranges, state, attempt, q)
            compute_bodies(robot, q, T_world_body)
            find_carried(T_world_body[carrier], target.T_world_tool[row], T_carrier_tool)
            count = solve_ur_arm(arm, ranges, T_carrier_tool, work, solutions, codes)
            out_counts[row, ATTEMPTS] += 1
            out_counts[row, EVALUATIONS] += count
            if count == 0:
                continue
            nearest, tallies = seeds.first_box < 1.0, (out_counts[row], out_pairs[row])
            first = next_index(state, count)  # so that another stream shows another branch
            models = robot, collision, robot, tables
            chosen = choose_branch(
                models, arm, ranges, nearest, first, count, solutions, q, buffers, tallies[0], tallies[1]
            )
            place_arm(arm, max(chosen, 0), solutions, q)
            out_score[row, 0], out_score[row, 1] = 0.0, 0.0 if chosen >= 0 else UNKNOWN_DEPTH
            for k in range(joints):
                out_q[row, k] = q[k]
            if chosen >= 0:
                out_counts[row, REACHED] = 1
                break


@kernel
def make_room(numbers, whole, ranges, carrier):
    """Room for attempts; the carrier's pose and the joints that are frozen are in it already."""
    q, T_world_carrier = ranges[0].copy(), np.empty((3, 4))
    for i in range(3):  # in loops: numpy's `eye`, and its copying into slices, took 3 s to compile
        for j in range(4):
            T_world_carrier[i, j] = 1.0 if i == j else 0.0
    if carrier > 0:
        robot, _ = unpack_models(numbers[whole[2] :], whole[whole[3] :])
        T_world_body = np.empty((robot.bodies.shape[0], 3, 4))
        compute_bodies(robot, q, T_world_body)
        for i in range(3):
            for j in range(4):
                T_world_carrier[i, j] = T_world_body[carrier, i, j]
    return Room(
        T_world_carrier,
        np.empty((3, 4)),
        np.empty((2, ANGLES)),
        np.empty((BRANCHES, 6)),
        np.empty(BRANCHES, dtype=np.int64),
        np.empty(BRANCHES),
        q,
    )


@inline_kernel
def find_first(far, count):
    """The branch to be tried next: the least of the first `count` of `far`, the first of equals."""
    best = 0
    for branch in range(1, count):
        if far[branch] < far[best]:
            best = branch
    return best


@inline_kernel
def rank_branches(arm, ranges, seed, stream, attempt, count, solutions, state, out_far):
    """Attempt 0 begins with the branch of least motion from ranges[2], later ones with any: streams show others."""
    for branch in range(count):
        motion = 0.0
        for joint in range(6):
            way = arm.angles[2, joint] * (solutions[branch, joint] - ranges[2, arm.coordinates[joint]])
            motion += way * way
        out_far[branch] = motion
    if attempt > 0:
        seed_stream(seed, stream, attempt, state)
        first = next_index(state, count)
        for branch in range(count):
            out_far[branch] = np.float64((branch + count - first) % count)


@inline_kernel
def try_branches(block, models, arm, ranges, T_world_tool, seed, stream, attempt, room, state, buffers, outputs):
    """One attempt on one target [3, 4]: branch after branch, until one is free of collision.

    The outputs are those of `lm.solve_target`; an evaluation is one branch that exists inside the ranges. If all
    collide, the one that was tried first is kept.
    """
    q, far, (out_q, out_score, out_counts, out_pairs) = room.q, room.far, outputs
    find_carried(room.T_world_carrier, T_world_tool, room.T_carrier_tool)
    count = solve_ur_arm(arm, ranges, room.T_carrier_tool, room.sides, room.solutions, room.codes)
    out_counts[ATTEMPTS] += 1
    out_counts[EVALUATIONS] += count
    if count == 0:
        return
    rank_branches(arm, ranges, seed, stream, attempt, count, room.solutions, state, far)
    first = chosen = find_first(far, count)
    for _ in range(count):
        place_arm(arm, chosen, room.solutions, q)
        pair = find_collision(models[0], models[1], q, buffers)
        if pair < 0 and stands_in_world(block[1]):
            pair = find_obstacle_at(block[0], block[1], q)
        if pair < 0:
            out_counts[REACHED] = 1
            break
        out_counts[COLLIDING] += 1
        out_pairs[pair] += 1
        far[chosen] = np.inf
        chosen = find_first(far, count)
    is_free = out_counts[REACHED] == 1
    place_arm(arm, chosen if is_free else first, room.solutions, q)
    out_score[0], out_score[1] = 0.0, 0.0 if is_free else UNKNOWN_DEPTH
    for k in range(q.size):
        out_q[k] = q[k]


@kernel
def answer_pose(numbers, whole, T_world_tool, seed, stream, first, last, out):
    """All branches for one pose [3, 4], and the grade of the one that is free, from one call of Python.

    As `lm.answer_target`, but that one attempt, `first`, shows all there is. True if it is reached and accepted.
    """
    grader, terms, kinds, turns = unpack_answer(numbers, whole)
    out_q, is_met = find_branch(numbers, whole, T_world_tool, np.uint64(seed), stream, first, out)
    if not is_met:
        return False
    unwind(turns[0], turns[1], turns[2], turns[3], out_q)
    target = TargetArrays(kinds, T_world_tool.reshape((1, 3, 4)))
    return grades(whole) and grade_row(grader, terms, target, whole[0], out)


@kernel
def find_branch(numbers, whole, T_world_tool, seed, stream, attempt, out):
    """One attempt on one pose [3, 4] into a row; its q [N], and whether that meets the pose."""
    models, (ranges, arm, carrier) = unpack_used(numbers, whole), unpack_closed_form(numbers, whole)
    room, state = make_room(numbers, whole, ranges, carrier), np.empty(1, dtype=np.uint64)
    buffers, outputs = make_buffers(models[0], models[1], whole[0]), open_row(whole[0], attempt, out)
    block = numbers, whole
    try_branches(block, models, arm, ranges, T_world_tool, seed, stream, attempt, room, state, buffers, outputs)
    return outputs[0], outputs[1][0] == 0.0


@kernel
def solve_poses(numbers, whole, T_world_tool, rows, seed, streams, attempts, out_q, out_score, out_counts, out_pairs):
    """All branches for each of rows[0] .. rows[1] - 1: streams [T], attempts [rows, 2], outputs a row a target.

    `numbers` and `whole` are those of `unpack_closed_form`. Of several attempts the first shows all there is.
    """
    models, (ranges, arm, carrier) = unpack_used(numbers, whole), unpack_closed_form(numbers, whole)
    room, state = make_room(numbers, whole, ranges, carrier), np.empty(1, dtype=np.uint64)
    buffers = make_buffers(models[0], models[1], out_q.shape[1])
    for row in range(rows[0], rows[1]):
        first, last = attempts[row - rows[0], 0], attempts[row - rows[0], 1]
        if first < last:
            outputs = (out_q[row], out_score[row], out_counts[row], out_pairs[row])
            question = (T_world_tool[row], seed, streams[row], first)
            try_branches((numbers, whole), models, arm, ranges, *question, room, state, buffers, outputs)
