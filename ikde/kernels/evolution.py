"""Differential evolution: one attempt, from a random population to a member that meets the target or to the last
generation [Storn1997; Qiao2022, section 3.1]."""

from typing import NamedTuple

import numpy as np

from ikde.kernels.arrays import Floats, Ints
from ikde.kernels.clearance import collides, compute_clearance
from ikde.kernels.frames import compute_bodies, compute_frame
from ikde.kernels.jit import kernel
from ikde.kernels.mutation import LARGEST_DRAW, draw_members, mutate, repair_bound
from ikde.kernels.pose_error import compute_orientation_error, compute_position_error
from ikde.kernels.rng import next_index, next_uniform
from ikde.kernels.spheres import compute_bounds, compute_centres

IGNORE, REJECT, FEASIBILITY = range(3)
SMALLEST_DEPTH = 1e-12  # m: spheres that touch exactly at the safe distance collide, with this depth


class Workspace(NamedTuple):
    """The buffers of one lane, so that no inner loop allocates."""

    x: Floats  # [NP, N] the population
    cost: Floats  # [NP] m
    depth: Floats  # [NP] m, penetration beyond the safe distance; 0 is free
    next_x: Floats  # [NP, N] the next generation
    next_cost: Floats  # [NP]
    next_depth: Floats  # [NP]
    trial: Floats  # [N]
    drawn: Ints  # [5]
    R_world_body: Floats  # [B, 3, 3]
    p_world_body: Floats  # [B, 3]
    R_world_tool: Floats  # [3, 3]
    p_world_tool: Floats  # [3]
    centres: Floats  # [S, 3]
    bounds: Floats  # [C, 3]


@kernel
def make_workspace(robot, detector, population):
    """Allocate the buffers for a robot, a detector and a population size."""
    joints, bodies = robot.lower.size, robot.body_parent.size
    return Workspace(
        np.empty((population, joints)),
        np.empty(population),
        np.empty(population),
        np.empty((population, joints)),
        np.empty(population),
        np.empty(population),
        np.empty(joints),
        np.empty(LARGEST_DRAW, dtype=np.int64),
        np.empty((bodies, 3, 3)),
        np.empty((bodies, 3)),
        np.empty((3, 3)),
        np.empty(3),
        np.empty((detector.sphere_body.size, 3)),
        np.empty((detector.component_body.size, 3)),
    )


@kernel
def compute_cost(robot, target, index, search, q, work):
    """The search's objective in m, and whether `q` meets both tolerances; leaves the bodies' poses in `work`.

    cost = position error + orientation error * (position tolerance / orientation tolerance): both reach their
    tolerance together.
    """
    compute_bodies(robot, q, work.R_world_body, work.p_world_body)
    compute_frame(robot, robot.tool_frame[0], work.R_world_body, work.p_world_body, work.R_world_tool, work.p_world_tool)
    position = compute_position_error(target, index, work.p_world_tool)
    orientation = compute_orientation_error(target, index, work.R_world_tool)
    meets = position <= search.tolerance[0] and orientation <= search.tolerance[1]
    return position + orientation * (search.tolerance[0] / search.tolerance[1]), meets


@kernel
def compute_depth(detector, work):
    """Penetration beyond the safe distance in m, 0 if free; the bodies' poses are in `work`."""
    compute_bounds(detector, work.R_world_body, work.p_world_body, work.bounds)
    compute_centres(detector, work.R_world_body, work.p_world_body, work.centres)
    if not collides(detector, work.bounds, work.centres):
        return 0.0
    clearance, _ = compute_clearance(detector, work.bounds, work.centres)
    return max(detector.safe_distance[0] - clearance, SMALLEST_DEPTH)


@kernel
def is_better(cost, depth, other_cost, other_depth):
    """Deb's rules: free beats colliding, the shallower of two colliding wins, else the lower cost. Ties win.

    [Deb2000]; [Storn1997]'s selection where no depth is computed.
    """
    if depth == other_depth:
        return cost <= other_cost
    return depth < other_depth


@kernel
def find_best(work):
    """Index of the best member by Deb's rules."""
    best = 0
    for i in range(1, work.cost.size):
        if not is_better(work.cost[best], work.depth[best], work.cost[i], work.depth[i]):
            best = i
    return best


@kernel
def fill_trial(search, lower, upper, state, work, i, best):
    """Mutation, binomial crossover and bound repair: the trial that challenges member `i`."""
    joints = work.trial.size
    draw_members(state, search.population[0], i, work.drawn)
    forced = next_index(state, joints)
    for k in range(joints):
        if k == forced or next_uniform(state) < search.crossover[0]:
            donor = mutate(search.strategy[0], work.x, i, best, work.drawn, search.weight[0], k)
            work.trial[k] = repair_bound(search.repair[0], state, donor, work.x[i, k], lower[k], upper[k])
        else:
            work.trial[k] = work.x[i, k]


@kernel
def score_trial(robot, detector, target, index, search, work, i):
    """Cost, depth and `meets` of the trial; its collision is looked at only if it could still beat member `i`."""
    cost, meets = compute_cost(robot, target, index, search, work.trial, work)
    if search.collision_rule[0] != FEASIBILITY or (work.depth[i] == 0.0 and cost > work.cost[i]):
        return cost, 0.0, meets
    depth = compute_depth(detector, work)
    return cost, depth, meets and depth == 0.0


@kernel
def start_population(robot, detector, target, index, search, lower, upper, state, work):
    """Draw every member uniformly from its ranges. Returns the member that already meets the target, or -1."""
    for i in range(search.population[0]):
        for k in range(work.trial.size):
            work.x[i, k] = lower[k] + next_uniform(state) * (upper[k] - lower[k])
        work.cost[i], meets = compute_cost(robot, target, index, search, work.x[i], work)
        work.depth[i] = 0.0
        if search.collision_rule[0] == FEASIBILITY:
            work.depth[i] = compute_depth(detector, work)
        if meets and work.depth[i] == 0.0:
            return i
    return -1


@kernel
def keep_member(x, cost, depth, i, new_x, new_cost, new_depth):
    """Write one member into a population."""
    x[i] = new_x
    cost[i] = new_cost
    depth[i] = new_depth


@kernel
def evolve(robot, detector, target, index, search, lower, upper, state, work):
    """Evolve one population within [lower, upper]. Returns (best member, meets the target, evaluations).

    The best member is `work.x[best]`; under `FEASIBILITY` meeting the target includes being free of collision.
    """
    population = search.population[0]
    found = start_population(robot, detector, target, index, search, lower, upper, state, work)
    if found >= 0:
        return found, True, found + 1
    evaluations = population
    best = find_best(work)
    for _ in range(search.generations[0]):
        for i in range(population):
            fill_trial(search, lower, upper, state, work, i, best)
            cost, depth, meets = score_trial(robot, detector, target, index, search, work, i)
            evaluations += 1
            wins = is_better(cost, depth, work.cost[i], work.depth[i])
            if wins and (meets or search.in_place[0] == 1):
                keep_member(work.x, work.cost, work.depth, i, work.trial, cost, depth)
                if meets:
                    return i, True, evaluations
                if is_better(cost, depth, work.cost[best], work.depth[best]):
                    best = i
            elif wins:
                keep_member(work.next_x, work.next_cost, work.next_depth, i, work.trial, cost, depth)
            else:
                keep_member(work.next_x, work.next_cost, work.next_depth, i, work.x[i], work.cost[i], work.depth[i])
        if search.in_place[0] == 0:
            work.x[:] = work.next_x
            work.cost[:] = work.next_cost
            work.depth[:] = work.next_depth
            best = find_best(work)
    return best, False, evaluations
