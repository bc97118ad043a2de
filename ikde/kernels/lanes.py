"""A whole solve: attempt after attempt until one configuration meets the target and is free. One lane a target."""

import numpy as np

from ikde.kernels.arrays import ATTEMPTS, COLLIDING, EVALUATIONS, OUTSIDE, REACHED
from ikde.kernels.clearance import count_colliding_pairs
from ikde.kernels.evolution import IGNORE, compute_cost, compute_depth, evolve, make_workspace
from ikde.kernels.jit import kernel
from ikde.kernels.rng import seed_stream


@kernel
def set_box(ranges, first_box, attempt, out_lower, out_upper):
    """Ranges of one attempt: a box around `near` that doubles with each attempt, cut to the joint ranges [3, N]."""
    share = first_box
    for _ in range(attempt):
        share = min(1.0, 2.0 * share)
    for k in range(ranges.shape[1]):
        lower, upper, near = ranges[0, k], ranges[1, k], ranges[2, k]
        half_width = share * (upper - lower)
        out_lower[k] = max(lower, near - half_width)
        out_upper[k] = min(upper, near + half_width)


@kernel
def is_inside(ranges, q):
    """True if every joint of `q` [N] is inside its range."""
    outside = 0
    for k in range(q.size):
        outside += not ranges[0, k] <= q[k] <= ranges[1, k]
    return outside == 0


@kernel
def solve_lane(robot, detector, target, index, search, seed, stream, attempts, out_q, out_score, out_counts, out_pairs):
    """Run attempts number attempts[0] .. attempts[1]-1 on one target, up to the first that is reached.

    `REJECT` is the paper's rule: search on the pose error alone, test the best, start again until it is free
    [Qiao2021, section 5.3.3]. What is kept in `out_q` [N] is the best so far by `out_score` [2]: poses that were met
    (0, depth) before those that were not (1, cost), so `out_score` starts at (inf, inf). `out_counts` [COUNTS] and
    `out_pairs` [P], how often each pair blocked a pose that was met, are added to.
    """
    joints = out_q.size
    work = make_workspace(robot, detector, joints, search.population)
    lower, upper = np.empty(joints), np.empty(joints)
    state = np.empty(1, dtype=np.uint64)
    for attempt in range(attempts[0], attempts[1]):
        set_box(search.ranges, search.first_box, attempt, lower, upper)
        seed_stream(seed, stream, attempt, state)
        best, meets, evaluations = evolve(robot, detector, target, index, search, lower, upper, state, work)
        out_counts[ATTEMPTS] += 1
        out_counts[EVALUATIONS] += evaluations
        q = work.x[best]
        cost, _ = compute_cost(robot, target, index, search, q, work)
        depth = 0.0
        if search.collision_rule != IGNORE:
            depth = compute_depth(detector, work.T_world_body, work.bounds, work.centres)
        inside = is_inside(search.ranges, q)
        met = 0.0 if meets and inside else 1.0
        badness = depth if meets and inside else cost
        if met < out_score[0] or (met == out_score[0] and badness < out_score[1]):
            out_score[0], out_score[1] = met, badness
            for k in range(joints):
                out_q[k] = q[k]
        if meets and not inside:
            out_counts[OUTSIDE] += 1
        elif meets and depth > 0.0:
            out_counts[COLLIDING] += 1
            count_colliding_pairs(detector, work.centres, out_pairs)
        elif meets:
            out_counts[REACHED] = 1
            return


@kernel
def solve_lanes(
    robot, detector, target, lanes, search, seed, streams, attempts, last, out_q, out_score, out_counts, out_pairs
):
    """Run attempts attempts[0] .. attempts[1]-1 of the lanes lanes[0] .. lanes[1]-1 that are not reached yet.

    A call from Python costs as much as a short search: this one call serves many. `streams` [T]; `last` [T]: where the
    budget of each lane ends; the outputs are those of `solve_lane`, a row a lane.
    """
    block = np.empty(2, dtype=np.int64)
    for index in range(lanes[0], lanes[1]):
        if out_counts[index, REACHED]:
            continue
        block[0], block[1] = attempts[0], min(attempts[1], last[index])
        outputs = (out_q[index], out_score[index], out_counts[index], out_pairs[index])
        solve_lane(robot, detector, target, index, search, seed, streams[index], block, *outputs)
