"""Whole solves: attempt after attempt until one configuration meets the target and is free, one lane a target."""

import numpy as np
from numba import prange

from ikde.kernels.clearance import count_colliding_pairs
from ikde.kernels.evolution import IGNORE, compute_cost, compute_depth, evolve, make_workspace
from ikde.kernels.jit import kernel, parallel_kernel
from ikde.kernels.rng import seed_stream

# Columns of `out_counts`.
REACHED, ATTEMPTS, EVALUATIONS, COLLIDING, OUTSIDE = range(5)
COUNTS = 5


@kernel
def set_box(search, attempt, out_lower, out_upper):
    """Ranges of one attempt: a box around `near` that doubles with each attempt, cut to the joint ranges."""
    share = min(1.0, search.first_box[0] * 2.0 ** min(attempt, 60))
    for k in range(search.lower.size):
        half_width = share * (search.upper[k] - search.lower[k])
        out_lower[k] = max(search.lower[k], search.near[k] - half_width)
        out_upper[k] = min(search.upper[k], search.near[k] + half_width)


@kernel
def is_inside(search, q):
    """True if every joint is inside its range."""
    for k in range(q.size):
        if not search.lower[k] <= q[k] <= search.upper[k]:
            return False
    return True


@kernel
def solve_lane(robot, detector, target, index, search, seed, stream, attempts, out_q, out_score, out_counts, out_pairs):
    """Run attempts number attempts[0] .. attempts[1]-1 on one target, up to the first that is reached.

    `REJECT` is the paper's rule: search on the pose error alone, test the best, start again until it is free
    [Qiao2021, section 5.3.3]. What is kept in `out_q` [N] is the best so far by `out_score` [2]: poses that were met
    (0, depth) before those that were not (1, cost), so `out_score` starts at (inf, inf). `out_counts` [COUNTS] and
    `out_pairs` [P], how often each pair blocked a pose that was met, are added to.
    """
    work = make_workspace(robot, detector, search.population[0])
    lower, upper = np.empty(search.lower.size), np.empty(search.lower.size)
    state = np.empty(1, dtype=np.uint64)
    for attempt in range(attempts[0], attempts[1]):
        set_box(search, attempt, lower, upper)
        seed_stream(seed, stream, attempt, state)
        best, meets, evaluations = evolve(robot, detector, target, index, search, lower, upper, state, work)
        out_counts[ATTEMPTS] += 1
        out_counts[EVALUATIONS] += evaluations
        q = work.x[best]
        cost, _ = compute_cost(robot, target, index, search, q, work)
        depth = 0.0 if search.collision_rule[0] == IGNORE else compute_depth(detector, work)
        inside = is_inside(search, q)
        met = 0.0 if meets and inside else 1.0
        badness = depth if meets and inside else cost
        if met < out_score[0] or (met == out_score[0] and badness < out_score[1]):
            out_score[0], out_score[1] = met, badness
            out_q[:] = q
        if meets and not inside:
            out_counts[OUTSIDE] += 1
        elif meets and depth > 0.0:
            out_counts[COLLIDING] += 1
            count_colliding_pairs(detector, work.centres, out_pairs)
        elif meets:
            out_counts[REACHED] = 1
            return


@parallel_kernel
def solve_lanes(robot, detector, target, search, seed, streams, attempts, out_q, out_score, out_counts, out_pairs):
    """`solve_lane` for targets 0 .. T-1 on all threads; `streams` [T], `attempts` [T, 2], outputs a row a target."""
    for index in prange(streams.size):
        solve_lane(
            robot,
            detector,
            target,
            index,
            search,
            seed,
            streams[index],
            attempts[index],
            out_q[index],
            out_score[index],
            out_counts[index],
            out_pairs[index],
        )
