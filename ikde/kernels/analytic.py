"""The engine `analytic`: the closed form of a UR-type arm, its base drawn from the seeds until a branch is free.

`model/generate` writes this file once more for a robot, after `kernels/lm.py`, with its own collision check.
"""

import numpy as np

from ikde.kernels.arrays import ATTEMPTS, COLLIDING, EVALUATIONS, REACHED, UNKNOWN_DEPTH
from ikde.kernels.closed_form import ANGLES, BRANCHES, solve_ur_arm
from ikde.kernels.frames import compute_bodies
from ikde.kernels.jit import inline_kernel, kernel
from ikde.kernels.rng import next_index, seed_stream
from ikde.kernels.seeds import draw_seed
from ikde.kernels.tables import find_collision, make_buffers


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
def choose_branch(robot, collision, arm, ranges, nearest, first, count, solutions, q, buffers, out_counts, out_pairs):
    """A branch that is free of collision, the next from `first` on or the nearest to ranges[2]; -1 if all collide."""
    chosen, smallest = -1, np.inf
    for turn in range(count):
        branch = (first + turn) % count
        place_arm(arm, branch, solutions, q)
        distance = find_distance(ranges, q) if nearest else 0.0
        if distance >= smallest:
            continue
        pair = find_collision(robot, collision, q, buffers)
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

    `carrier` is the body that carries the arm. An attempt is one place of the base, an evaluation one branch that
    exists. An unreached target keeps its last colliding branch.
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
            chosen = choose_branch(
                robot, collision, arm, ranges, nearest, first, count, solutions, q, buffers, tallies[0], tallies[1]
            )
            place_arm(arm, max(chosen, 0), solutions, q)
            out_score[row, 0], out_score[row, 1] = 0.0, 0.0 if chosen >= 0 else UNKNOWN_DEPTH
            for k in range(joints):
                out_q[row, k] = q[k]
            if chosen >= 0:
                out_counts[row, REACHED] = 1
                break
