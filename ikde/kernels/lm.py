"""The engine `lm`: damped least squares from collision-free seeds, started again until it ends free of collision.

`model/generate` writes this file once more for a robot, with functions of its own in place of those of
`kernels/tables.py`. One target is solved by `solve_target`; many by `solve_targets`, which advances a fixed number of
them side by side and gives a lane that has finished the next target. Both make the same moves: the same bits.
"""

import numpy as np

from ikde.kernels.answer import grade_row, open_row
from ikde.kernels.arrays import ATTEMPTS, COLLIDING, EVALUATIONS, REACHED, UNKNOWN_DEPTH, TargetArrays
from ikde.kernels.flat_arguments import grades, unpack_answer, unpack_search
from ikde.kernels.jit import inline_kernel, kernel
from ikde.kernels.rng import seed_stream
from ikde.kernels.seeds import draw_seed
from ikde.kernels.tables import LANES, find_collision, make_buffers, take_step, take_steps, unpack_used
from ikde.kernels.turns import unwind
from ikde.kernels.world import find_obstacle_at, stands_in_world

GO_ON, MET, GIVE_UP = range(3)


@inline_kernel
def judge_step(descent, steps, position, orientation):
    """What comes after a step: go on, look for collisions, or start again because it leads nowhere."""
    if position <= descent.position_tolerance and orientation <= descent.orientation_tolerance:
        return MET
    far = max(position, descent.rotation_length * orientation) > descent.hopeless
    return GIVE_UP if steps >= descent.most_steps or (far and steps >= descent.patience) else GO_ON


@inline_kernel
def record(descent, verdict, pair, position, orientation, q, out_q, out_score, out_counts, out_pairs):
    """Enter a finished attempt; True if it reached the target. Kept is the best so far, as in `finish_attempt`."""
    out_counts[ATTEMPTS] += 1
    met = 0.0 if verdict == MET else 1.0
    badness = position + descent.rotation_length * orientation
    if verdict == MET:
        badness = UNKNOWN_DEPTH if pair >= 0 else 0.0
    if met < out_score[0] or (met == out_score[0] and badness < out_score[1]):
        out_score[0], out_score[1] = met, badness
        for k in range(q.size):
            out_q[k] = q[k]
    if verdict != MET:
        return False
    if pair >= 0:
        out_counts[COLLIDING] += 1
        out_pairs[pair] += 1
        return False
    out_counts[REACHED] = 1
    return True


@kernel
def solve_target(
    numbers,
    whole,
    pool,
    pool_T,
    kinds,
    T_world_tool,
    index,
    seed,
    stream,
    first,
    last,
    out_q,
    out_score,
    out_counts,
    out_pairs,
):
    """Attempts number `first` .. `last` - 1 on one target, up to the first that is reached.

    First what stays, the block of `unpack_search`; then the target, row `index` of `TargetArrays`. The outputs
    are those of `attempt.finish_attempt`: out_q [N], out_score [2], out_counts [COUNTS], out_pairs [P], the pair found
    first in each collision.
    """
    target = TargetArrays(kinds, T_world_tool)
    robot, collision = unpack_used(numbers, whole)
    ranges, descent, seeds = unpack_search(numbers, whole, pool, pool_T)
    q, state, buffers = np.empty(out_q.size), np.empty(1, dtype=np.uint64), make_buffers(robot, collision, out_q.size)
    for attempt in range(first, last):
        seed_stream(seed, stream, attempt, state)
        draw_seed(seeds, target, index, ranges, state, attempt, q)
        steps, verdict, position, orientation = 0, GO_ON, 0.0, 0.0
        while verdict == GO_ON:
            position, orientation = take_step(robot, target, index, ranges, descent, q, buffers)
            steps += 1
            verdict = judge_step(descent, steps, position, orientation)
        out_counts[EVALUATIONS] += steps
        pair = find_collision(robot, collision, q, buffers) if verdict == MET else -1
        if verdict == MET and pair < 0 and stands_in_world(whole):
            pair = find_obstacle_at(numbers, whole, q)
        if record(descent, verdict, pair, position, orientation, q, out_q, out_score, out_counts, out_pairs):
            return


@kernel
def answer_target(numbers, whole, pool, pool_T, T_world_tool, seed, stream, first, last, out):
    """`solve_target` on one target [3, 4], turned back and graded, from one call of Python.

    `numbers` and `whole` are those of `unpack_answer`, `out` is the row of `kernels/answer.py`; with `first` above 0 it
    goes on with what stands there. Returns True if the target is reached and the grader accepts it; False, and no
    grade, where `descend_row` comes after it.
    """
    grader, terms, kinds, turns = unpack_answer(numbers, whole)
    target, joints = TargetArrays(kinds, T_world_tool.reshape((1, 3, 4))), whole[0]
    out_q, out_score, out_counts, out_pairs = open_row(joints, first, out)
    index = np.int64(0)  # a literal would be compiled into functions of its own
    asked = (target.kind, target.T_world_tool, index, np.uint64(seed), stream, first, last)
    solve_target(numbers, whole, pool, pool_T, *asked, out_q, out_score, out_counts, out_pairs)
    unwind(turns[0], turns[1], turns[2], turns[3], out_q)
    return grades(whole) and grade_row(grader, terms, target, joints, out)


@inline_kernel
def load(lane, target, index, ranges, seeds, seed, stream, attempt, state, trial, out_q, out_T):
    """Put one attempt on one target into a lane: seed into `out_q` [N * LANES], target into `out_T` [12 * LANES]."""
    seed_stream(seed, stream, attempt, state)
    draw_seed(seeds, target, index, ranges, state, attempt, trial)
    for k in range(trial.size):
        out_q[lane + k * LANES] = trial[k]
    for i in range(3):
        for j in range(4):
            out_T[lane + (4 * i + j) * LANES] = target.T_world_tool[index, i, j]


@inline_kernel
def find_work(attempts, first, row, last):
    """The first row from `row` on that has attempts to make, or `last`; attempts[0] belongs to row `first`."""
    while row < last and attempts[row - first, 0] >= attempts[row - first, 1]:
        row += 1
    return row


@kernel
def solve_targets(
    numbers,
    whole,
    pool,
    pool_T,
    kinds,
    T_world_tool,
    rows,
    seed,
    streams,
    attempts,
    out_q,
    out_score,
    out_counts,
    out_pairs,
):
    """`solve_target` for rows[0] .. rows[1] - 1 at once: streams [T], attempts [rows, 2], outputs a row a target."""
    target = TargetArrays(kinds, T_world_tool)
    robot, collision = unpack_used(numbers, whole)
    ranges, descent, seeds = unpack_search(numbers, whole, pool, pool_T)
    joints = out_q.shape[1]
    q, T, errors = np.empty(joints * LANES), np.empty(12 * LANES), np.empty(2 * LANES)
    trial, state, buffers = np.empty(joints), np.empty(1, dtype=np.uint64), make_buffers(robot, collision, joints)
    row, attempt, steps = (
        np.empty(LANES, dtype=np.int64),
        np.empty(LANES, dtype=np.int64),
        np.empty(LANES, dtype=np.int64),
    )
    for lane in range(LANES):
        row[lane] = -1
    next_row = rows[0]
    while True:
        busy = 0
        for lane in range(LANES):
            index, done = row[lane], row[lane] < 0
            if not done:
                steps[lane] += 1
                position, orientation = errors[lane], errors[lane + LANES]
                verdict = judge_step(descent, steps[lane], position, orientation)
                if verdict == GO_ON:
                    busy += 1
                    continue
                for k in range(joints):
                    trial[k] = q[lane + k * LANES]
                out_counts[index, EVALUATIONS] += steps[lane]
                pair = find_collision(robot, collision, trial, buffers) if verdict == MET else -1
                if verdict == MET and pair < 0 and stands_in_world(whole):
                    pair = find_obstacle_at(numbers, whole, trial)
                outputs = (out_q[index], out_score[index], out_counts[index], out_pairs[index])
                done = record(descent, verdict, pair, position, orientation, trial, *outputs)
                attempt[lane] += 1
                done = done or attempt[lane] >= attempts[index - rows[0], 1]
            if done:
                next_row = find_work(attempts, rows[0], next_row, rows[1])
                row[lane] = next_row if next_row < rows[1] else -1
                if row[lane] < 0:
                    continue
                index, attempt[lane] = next_row, attempts[next_row - rows[0], 0]
                next_row += 1
            busy += 1
            steps[lane] = 0
            load(lane, target, index, ranges, seeds, seed, streams[index], attempt[lane], state, trial, q, T)
        if busy == 0:
            return
        take_steps(robot, target, row, ranges, descent, q, T, errors, trial, buffers)
