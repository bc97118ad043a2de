"""One step along a path by differential evolution inside the speed limits [Qiao2022, section 3.2].

A member is a step [D] in shares of the largest (`kernels/drive.py`), so the speed limits are -1 and 1, whatever the
drive; those that joint ranges leave are the box. Coordinates outside are drawn again in the box: (30), (32) and (33).
"""

import math
from typing import NamedTuple

import numpy as np

from ikde.kernels.arrays import Floats, Indices, Ints
from ikde.kernels.attempt import is_inside
from ikde.kernels.clearance import find_colliding_pair
from ikde.kernels.drive import arc_is_inside, set_step_box, take_drive_step
from ikde.kernels.frames import compute_bodies, compute_tool
from ikde.kernels.jit import inline_kernel, kernel
from ikde.kernels.mutation import MAX_DRAWN, REDRAW, draw_members, mutate, repair_bound
from ikde.kernels.pose_error import compute_orientation_error
from ikde.kernels.rng import next_index, next_uniform, seed_stream
from ikde.kernels.spheres import compute_bounds, compute_centres

SOLVED, COLLIDES, LIMITED, MISSED, NO_BOX = range(5)  # verdicts, the best first; NO_BOX: no step keeps all limits
NO_PAIR = np.int64(-1)


class StepWorkspace(NamedTuple):
    """Room for one sample's population."""

    x: Floats  # [2 NP, D] members, and behind them at first their opposites
    fitness: Floats  # [2 NP]
    next_x: Floats  # [NP, D]
    next_fitness: Floats  # [NP]
    trial: Floats  # [D]
    lower: Floats  # [D]
    upper: Floats  # [D]
    drawn: Ints  # [5] members drawn for a mutation
    state: Indices  # [1] of the random numbers
    q: Floats  # [N] the end of the step evaluated last
    T_world_body: Floats  # [B, 3, 4]
    T_world_tool: Floats  # [3, 4]
    centres: Floats  # [3, S] m
    bounds: Floats  # [C, 3] m


@kernel
def make_step_workspace(robot, collision, joints, size, population):
    """Allocate the room for a robot, steps [size] and a population."""
    return StepWorkspace(
        np.empty((2 * population, size)),
        np.empty(2 * population),
        np.empty((population, size)),
        np.empty(population),
        np.empty(size),
        np.empty(size),
        np.empty(size),
        np.empty(MAX_DRAWN, dtype=np.int64),
        np.empty(1, dtype=np.uint64),
        np.empty(joints),
        np.empty((robot.bodies.shape[0], 3, 4)),
        np.empty((3, 4)),
        np.empty((3, collision.radius.size)),
        np.empty((collision.components.shape[0], 3)),
    )


@inline_kernel
def compute_fitness(robot, drive, target, index, search, q, step, work):
    """Weighted motion and error (34) of a step from `q` [N]; leaves its end and the poses there in `work`."""
    take_drive_step(drive, q, step, work.q)
    compute_bodies(robot, work.q, work.T_world_body)
    compute_tool(robot, work.T_world_body, work.T_world_tool)
    error, motion = 0.0, 0.0
    for i in range(3):
        error += abs(work.T_world_tool[i, 3] - target.T_world_tool[index, i, 3])
    for k in range(q.size):
        change = work.q[k] - q[k]
        motion += search.motion[k] * change * change
    angle = compute_orientation_error(target, index, work.T_world_tool)
    return motion + search.position_weight * error + search.orientation_weight * angle


@inline_kernel
def keeps_rest(drive, track, q, step, work):
    """True if a step from `q` [N] keeps what the box does not: base's place, both wheels, the tool's distance (18)."""
    if drive.base[0] >= 0:
        rolled = abs(drive.largest[0] * step[0]) + abs(drive.half_track * drive.largest[1] * step[1])
        if rolled > drive.wheel_travel or not arc_is_inside(drive, track.ranges, q, step):
            return False
    square = 0.0
    for i in range(3):
        centre = work.T_world_body[drive.centre_body, i, 3]
        for j in range(3):
            centre += work.T_world_body[drive.centre_body, i, j] * drive.p_body_centre[j]
        square += (work.T_world_tool[i, 3] - centre) ** 2
    return square <= drive.max_distance * drive.max_distance and is_inside(track.ranges, work.q)


@kernel
def judge_step(robot, collision, drive, track, target, index, search, q, step, work):
    """The termination (35): whether a step meets the target, keeps all limits and is free. Returns verdict and pair."""
    compute_fitness(robot, drive, target, index, search, q, step, work)
    for i in range(3):
        if abs(work.T_world_tool[i, 3] - target.T_world_tool[index, i, 3]) > search.position_tolerance:
            return MISSED, NO_PAIR
    if compute_orientation_error(target, index, work.T_world_tool) > search.orientation_tolerance:
        return MISSED, NO_PAIR
    if not keeps_rest(drive, track, q, step, work):
        return LIMITED, NO_PAIR
    compute_bounds(collision, work.T_world_body, work.bounds)
    compute_centres(collision, work.T_world_body, work.centres)
    pair = find_colliding_pair(collision, work.bounds, work.centres)
    return SOLVED if pair < 0 else COLLIDES, pair


@inline_kernel
def swap_members(work, i, j):
    """Exchange two members."""
    work.fitness[i], work.fitness[j] = work.fitness[j], work.fitness[i]
    for k in range(work.trial.size):
        work.x[i, k], work.x[j, k] = work.x[j, k], work.x[i, k]


@kernel
def draw_population(robot, drive, target, index, search, q, work):
    """Members drawn in the box (28), their opposites in the speed range (29, 30), and of both the best, sorted."""
    population = search.population
    for i in range(population):
        for k in range(work.trial.size):
            lower, upper = work.lower[k], work.upper[k]
            work.x[i, k] = lower + next_uniform(work.state) * (upper - lower)
            opposite = -work.x[i, k]
            work.x[population + i, k] = repair_bound(REDRAW, work.state, opposite, opposite, lower, upper)
    for i in range(2 * population):
        work.fitness[i] = compute_fitness(robot, drive, target, index, search, q, work.x[i], work)
    for i in range(population):
        best = i
        for j in range(i + 1, 2 * population):
            if work.fitness[j] < work.fitness[best]:
                best = j
        swap_members(work, i, best)


@kernel
def breed_steps(robot, drive, target, index, search, strategy, best, q, work):
    """One generation: mutation (31), repair (32, 33), crossover (26), selection (27). Returns the best member."""
    for i in range(search.population):
        draw_members(work.state, search.population, i, work.drawn)
        forced = next_index(work.state, work.trial.size)
        for k in range(work.trial.size):
            work.trial[k] = work.x[i, k]
            if k == forced or next_uniform(work.state) < search.crossover:
                donor = mutate(strategy, work.x, i, best, work.drawn, search.weight, k)
                work.trial[k] = repair_bound(REDRAW, work.state, donor, donor, work.lower[k], work.upper[k])
        fitness = compute_fitness(robot, drive, target, index, search, q, work.trial, work)
        wins = fitness <= work.fitness[i]
        work.next_fitness[i] = fitness if wins else work.fitness[i]
        for k in range(work.trial.size):
            work.next_x[i, k] = work.trial[k] if wins else work.x[i, k]
    best = np.int64(0)
    for i in range(search.population):
        work.fitness[i] = work.next_fitness[i]
        for k in range(work.trial.size):
            work.x[i, k] = work.next_x[i, k]
        if work.fitness[i] < work.fitness[best]:
            best = i
    return best


@kernel
def evolve_steps(robot, collision, drive, track, target, index, search, q, work):
    """Evolve one population until its best is solved. Returns (best member, verdict, pair, evaluations)."""
    draw_population(robot, drive, target, index, search, q, work)
    best, evaluations, judged = np.int64(0), 2 * search.population, math.inf
    verdict, pair = MISSED, NO_PAIR
    for generation in range(1, search.generations + 2):
        if work.fitness[best] < judged:
            judged = work.fitness[best]
            verdict, pair = judge_step(robot, collision, drive, track, target, index, search, q, work.x[best], work)
        if verdict == SOLVED or generation > search.generations:
            break
        strategy = search.even if generation % 2 == 0 else search.odd
        best = breed_steps(robot, drive, target, index, search, strategy, best, q, work)
        evaluations += search.population
    return best, verdict, pair, evaluations


@kernel
def evolve_sample(
    robot, collision, drive, track, target, index, search, seed, q, last, first_step, work, out_q, out_step
):
    """Population after population until one is solved: the success index. `out_q` [N], `out_step` [D]: the best.

    `last` [D] is the step before, for what limits its change. Random numbers hang on (seed, sample, attempt). Returns
    (verdict, pair that collides or -1, populations, evaluations).
    """
    kept, kept_pair, kept_fitness, evaluations = NO_BOX, NO_PAIR, math.inf, 0
    if not set_step_box(drive, track.ranges, q, last, first_step, work.lower, work.upper):
        return kept, kept_pair, 0, evaluations
    for attempt in range(search.attempts):
        seed_stream(seed, index, attempt, work.state)
        best, verdict, pair, spent = evolve_steps(robot, collision, drive, track, target, index, search, q, work)
        evaluations += spent
        if verdict < kept or (verdict == kept and work.fitness[best] < kept_fitness):
            kept, kept_pair, kept_fitness = verdict, pair, work.fitness[best]
            for k in range(out_step.size):
                out_step[k] = work.x[best, k]
            take_drive_step(drive, q, out_step, out_q)
        if kept == SOLVED:
            return kept, kept_pair, attempt + 1, evaluations
    return kept, kept_pair, search.attempts, evaluations
