"""The papers' differential evolution: one attempt, from a random population to a member that meets the target or to the
last generation [Storn1997; Qiao2022, section 3.1]; and a whole solve, attempt after attempt, one lane a target."""

from typing import NamedTuple

import numpy as np

from ikde.kernels.arrays import EVALUATIONS, FEASIBILITY, REACHED, Floats, Ints
from ikde.kernels.attempt import finish_attempt, set_box
from ikde.kernels.clearance import compute_depth
from ikde.kernels.frames import compute_bodies, compute_tool
from ikde.kernels.jit import inline_kernel, kernel
from ikde.kernels.mutation import MAX_DRAWN, draw_members, mutate, repair_bound
from ikde.kernels.pose_error import compute_orientation_error, compute_position_error
from ikde.kernels.rng import next_index, next_uniform, seed_stream


class Workspace(NamedTuple):
    """The buffers of one lane, so that no inner loop allocates."""

    x: Floats  # [NP, N] the population
    score: Floats  # [NP, 2] cost in m, and penetration beyond the safe distance in m (0 is free)
    next_x: Floats  # [NP, N] the next generation
    next_score: Floats  # [NP, 2]
    trial: Floats  # [N]
    drawn: Ints  # [5] members drawn for a mutation
    T_world_body: Floats  # [B, 3, 4]
    T_world_tool: Floats  # [3, 4]
    centres: Floats  # [3, S] m
    bounds: Floats  # [C, 3] m


@kernel
def make_workspace(robot, collision, joints, population):
    """Allocate the buffers for a robot, a collision model and a population size."""
    return Workspace(
        np.empty((population, joints)),
        np.empty((population, 2)),
        np.empty((population, joints)),
        np.empty((population, 2)),
        np.empty(joints),
        np.empty(MAX_DRAWN, dtype=np.int64),
        np.empty((robot.bodies.shape[0], 3, 4)),
        np.empty((3, 4)),
        np.empty((3, collision.radius.size)),
        np.empty((collision.components.shape[0], 3)),
    )


@inline_kernel
def compute_cost(robot, target, index, search, q, work):
    """The search's objective in m, and whether `q` meets both tolerances; leaves the bodies' poses in `work`.

    cost = position error + orientation error * (position tolerance / orientation tolerance): both reach their
    tolerance together.
    """
    compute_bodies(robot, q, work.T_world_body)
    compute_tool(robot, work.T_world_body, work.T_world_tool)
    position = compute_position_error(target, index, work.T_world_tool)
    orientation = compute_orientation_error(target, index, work.T_world_tool)
    meets = position <= search.position_tolerance and orientation <= search.orientation_tolerance
    return position + orientation * (search.position_tolerance / search.orientation_tolerance), meets


@inline_kernel
def is_better(cost, depth, other):
    """Deb's rules: free beats colliding, the shallower of two colliding wins, else the lower cost. Ties win.

    [Deb2000]; [Storn1997]'s selection where no depth is computed. `other` [2]: cost and depth.
    """
    if depth == other[1]:
        return cost <= other[0]
    return depth < other[1]


@inline_kernel
def find_best(score):
    """Index of the best member by Deb's rules. `score` [NP, 2]."""
    best = np.int64(0)
    for i in range(1, score.shape[0]):
        if not is_better(score[best, 0], score[best, 1], score[i]):
            best = i
    return best


@inline_kernel
def fill_start(search, lower, upper, state, work, i):
    """Member `i` of the first population, drawn uniformly about the middle of the ranges; the first is any `near`."""
    if i == 0 and search.first_box < 1.0:
        for k in range(work.trial.size):
            work.trial[k] = search.ranges[2, k]
        return
    for k in range(work.trial.size):
        width = search.start_share * (upper[k] - lower[k])
        margin = 0.5 * (1.0 - search.start_share) * (upper[k] - lower[k])
        work.trial[k] = lower[k] + margin + next_uniform(state) * width


@inline_kernel
def fill_trial(search, lower, upper, state, work, i, best):
    """Mutation, binomial crossover and bound repair: the trial that challenges member `i`."""
    joints = work.trial.size
    draw_members(state, search.population, i, work.drawn)
    forced = next_index(state, joints)
    for k in range(joints):
        if k == forced or next_uniform(state) < search.crossover:
            donor = mutate(search.strategy, work.x, i, best, work.drawn, search.weight, k)
            work.trial[k] = repair_bound(search.repair, state, donor, work.x[i, k], lower[k], upper[k])
        else:
            work.trial[k] = work.x[i, k]


@inline_kernel
def score_point(robot, collision, target, index, search, q, work, rival):
    """Cost, depth and `meets` of `q`; whether it collides is checked only if it could still beat `rival` [2]."""
    cost, meets = compute_cost(robot, target, index, search, q, work)
    if search.collision_rule != FEASIBILITY or (rival[1] == 0.0 and cost > rival[0]):
        return cost, 0.0, meets
    depth = compute_depth(collision, work.T_world_body, work.bounds, work.centres)
    return cost, depth, meets and depth == 0.0


@inline_kernel
def keep(x, score, i, q, cost, depth):
    """Write one member into a population."""
    for k in range(q.size):
        x[i, k] = q[k]
    score[i, 0], score[i, 1] = cost, depth


@kernel
def evolve(robot, collision, target, index, search, lower, upper, state, work):
    """Evolve one population within [lower, upper]. Returns (best member, meets the target, evaluations).

    The best member is `work.x[best]`; under `FEASIBILITY` meeting the target includes being free of collision. The
    first population is drawn uniformly and challenges no one; every later trial challenges member i.
    """
    population, evaluations, best = search.population, 0, np.int64(0)
    for i in range(population):
        work.score[i, 0], work.score[i, 1] = np.inf, np.inf
    for generation in range(search.generations + 1):
        for i in range(population):
            if generation == 0:
                fill_start(search, lower, upper, state, work, i)
            else:
                fill_trial(search, lower, upper, state, work, i, best)
            cost, depth, meets = score_point(robot, collision, target, index, search, work.trial, work, work.score[i])
            evaluations += 1
            wins = is_better(cost, depth, work.score[i])
            if wins and (meets or search.in_place):
                keep(work.x, work.score, i, work.trial, cost, depth)
                if meets:
                    return i, True, evaluations
                if is_better(cost, depth, work.score[best]):
                    best = i
            elif wins:
                keep(work.next_x, work.next_score, i, work.trial, cost, depth)
            else:
                keep(work.next_x, work.next_score, i, work.x[i], work.score[i, 0], work.score[i, 1])
        if not search.in_place:
            for i in range(population):
                keep(work.x, work.score, i, work.next_x[i], work.next_score[i, 0], work.next_score[i, 1])
            best = find_best(work.score)
    return best, False, evaluations


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


@kernel
def evolve_alone(robot, collision, target, index, search, lower, upper, seed, work, out_q):
    """The best of one population within [lower, upper] into `out_q` [N]; returns whether it meets, and evaluations.

    One sample of a path, `index` of a stream, as if it stood alone [Qiao2022, section 3.1].
    """
    state = np.empty(1, dtype=np.uint64)
    seed_stream(seed, index, np.int64(0), state)
    best, meets, evaluations = evolve(robot, collision, target, index, search, lower, upper, state, work)
    for k in range(out_q.size):
        out_q[k] = work.x[best, k]
    return meets, evaluations
