"""Differential evolution: one attempt, from a random population to a member that meets the target or to the last
generation [Storn1997; Qiao2022, section 3.1]."""

from typing import NamedTuple

import numpy as np

from ikde.kernels.arrays import Floats, Ints
from ikde.kernels.clearance import collides, compute_clearance
from ikde.kernels.frames import compute_bodies, compute_tool
from ikde.kernels.jit import inline_kernel, kernel
from ikde.kernels.mutation import LARGEST_DRAW, draw_members, mutate, repair_bound
from ikde.kernels.pose_error import compute_orientation_error, compute_position_error
from ikde.kernels.rng import next_index, next_uniform, seed_stream
from ikde.kernels.spheres import compute_bounds, compute_centres

IGNORE, REJECT, FEASIBILITY = range(3)
DEPTH_STEP = 1e-9  # m: depths are whole steps, at least one, so that rounding noise cannot decide between equals


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
def make_workspace(robot, detector, joints, population):
    """Allocate the buffers for a robot, a detector and a population size."""
    return Workspace(
        np.empty((population, joints)),
        np.empty((population, 2)),
        np.empty((population, joints)),
        np.empty((population, 2)),
        np.empty(joints),
        np.empty(LARGEST_DRAW, dtype=np.int64),
        np.empty((robot.bodies.shape[0], 3, 4)),
        np.empty((3, 4)),
        np.empty((3, detector.radius.size)),
        np.empty((detector.components.shape[0], 3)),
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


@kernel
def compute_depth(detector, T_world_body, bounds, centres):
    """Penetration beyond the safe distance in m, 0 if free. `bounds` [C, 3] and `centres` [3, S] are buffers."""
    compute_bounds(detector, T_world_body, bounds)
    compute_centres(detector, T_world_body, centres)
    if not collides(detector, bounds, centres):
        return 0.0
    clearance, _ = compute_clearance(detector, bounds, centres)
    return max(np.rint((detector.safe_distance - clearance) / DEPTH_STEP), 1.0) * DEPTH_STEP


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
def score_point(robot, detector, target, index, search, q, work, rival):
    """Cost, depth and `meets` of `q`; whether it collides is looked at only if it could still beat `rival` [2]."""
    cost, meets = compute_cost(robot, target, index, search, q, work)
    if search.collision_rule != FEASIBILITY or (rival[1] == 0.0 and cost > rival[0]):
        return cost, 0.0, meets
    depth = compute_depth(detector, work.T_world_body, work.bounds, work.centres)
    return cost, depth, meets and depth == 0.0


@inline_kernel
def keep(x, score, i, q, cost, depth):
    """Write one member into a population."""
    for k in range(q.size):
        x[i, k] = q[k]
    score[i, 0], score[i, 1] = cost, depth


@kernel
def evolve(robot, detector, target, index, search, lower, upper, state, work):
    """Evolve one population within [lower, upper]. Returns (best member, meets the target, evaluations).

    The best member is `work.x[best]`; under `FEASIBILITY` meeting the target includes being free of collision. The
    first population is drawn uniformly and challenges nobody; every later trial challenges member i.
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
            cost, depth, meets = score_point(robot, detector, target, index, search, work.trial, work, work.score[i])
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
def evolve_alone(robot, detector, target, index, search, lower, upper, seed, work, out_q):
    """The best of one population within [lower, upper] into `out_q` [N]; returns whether it meets, and evaluations.

    One sample of a path, `index` of a stream, as if it stood alone [Qiao2022, section 3.1].
    """
    state = np.empty(1, dtype=np.uint64)
    seed_stream(seed, index, np.int64(0), state)
    best, meets, evaluations = evolve(robot, detector, target, index, search, lower, upper, state, work)
    for k in range(out_q.size):
        out_q[k] = work.x[best, k]
    return meets, evaluations
