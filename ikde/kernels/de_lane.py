"""A whole solve by the papers' differential evolution: attempt after attempt until one meets its target and is free.

One lane a target.
"""

import numpy as np

from ikde.kernels.arrays import EVALUATIONS, REACHED
from ikde.kernels.attempt import finish_attempt, set_box
from ikde.kernels.evolution import compute_cost, evolve, make_workspace
from ikde.kernels.jit import kernel
from ikde.kernels.rng import seed_stream


@kernel
def solve_lane(
    robot, collision, target, index, search, seed, stream, attempts, out_q, out_score, out_counts, out_pairs
):
    """Run attempts number attempts[0] .. attempts[1]-1 on one target, up to the first that is reached.

    `REJECT` is the paper's rule: search on the pose error alone, test the best, start again until it is free
    [Qiao2021, section 5.3.3]. The outputs are those of `finish_attempt`.
    """
    joints = out_q.size
    work = make_workspace(robot, collision, joints, search.population)
    lower, upper = np.empty(joints), np.empty(joints)
    state = np.empty(1, dtype=np.uint64)
    for attempt in range(attempts[0], attempts[1]):
        set_box(search.ranges, search.first_box, attempt, lower, upper)
        seed_stream(seed, stream, attempt, state)
        best, meets, evaluations = evolve(robot, collision, target, index, search, lower, upper, state, work)
        out_counts[EVALUATIONS] += evaluations
        q = work.x[best]
        cost, _ = compute_cost(robot, target, index, search, q, work)
        if finish_attempt(collision, search, q, cost, meets, work, out_q, out_score, out_counts, out_pairs):
            return


@kernel
def solve_lanes(
    robot, collision, target, lanes, search, seed, streams, attempts, last, out_q, out_score, out_counts, out_pairs
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
        solve_lane(robot, collision, target, index, search, seed, streams[index], block, *outputs)
