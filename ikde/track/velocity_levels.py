"""Tasks of `ikde.velocity` as levels of least squares over the speeds that are sought."""

from typing import NamedTuple

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.actuators import speeds_by
from ikde.model.base_motion import find_planar_base
from ikde.model.robot import Robot
from ikde.solver.priority import Bounds, Level, Speeds, solve_levels
from ikde.track.limits import MotionLimits
from ikde.track.task_rows import TaskRows


class Way(NamedTuple):
    """The n speeds that are sought: of the base's twist first, then of the other joints that are not held."""

    mapping: Floats
    """[N, n]: speeds of all joints of those."""
    weights: Floats
    """[n]: what a unit of each counts where the least are sought."""


class Problem(NamedTuple):
    """Everything but which tasks are there."""

    rows: list[TaskRows]
    levels: list[list[int]]
    """Which tasks stand on each level, the first first."""
    way: Way
    bounds: Bounds | None
    """Of the speeds sought as they are; None without any."""
    softest: float


def find_way(robot: Robot, q: Floats, limits: MotionLimits, weights: Floats) -> Way:
    """What may move at `q` [N], with weights [N] by joint: those of x and y count for forward and left."""
    mapping, base = speeds_by(robot, q, "twist"), find_planar_base(robot)
    others = [place for place in range(len(q)) if base[0] < 0 or place not in base]
    count = mapping.shape[1] - len(others)
    of_twist = {0: base[:0], 2: base[[0, 2]], 3: base}[count]
    is_held = robot.lower >= robot.upper
    if limits.speed is not None:
        is_held |= limits.speed == 0.0
    free = [*range(count), *(count + k for k, place in enumerate(others) if not is_held[place])]
    return Way(mapping[:, free], weights[[*of_twist, *others]][free])


def solve_tasks(problem: Problem, shares: list[float]) -> Speeds:
    """Speeds of the joints [N] for tasks with these shares.

    A task that is there in part asks for a value between its own and what would be without it [Lee2012].
    """
    part = next((k for k, share in enumerate(shares) if 0.0 < share < 1.0), None)
    if part is None:
        return _solve_whole(problem, shares)
    without = solve_tasks(problem, [0.0 if k == part else share for k, share in enumerate(shares)])
    rows, share = problem.rows[part], shares[part]
    wanted = share * rows.wanted + (1.0 - share) * (rows.matrix @ without.x)
    blended = [rows._replace(wanted=wanted) if k == part else own for k, own in enumerate(problem.rows)]
    return solve_tasks(problem._replace(rows=blended), [1.0 if k == part else own for k, own in enumerate(shares)])


def _solve_whole(problem: Problem, shares: list[float]) -> Speeds:
    """The same where each task is there or is not."""
    mapping, weights = problem.way.mapping / problem.way.weights, problem.way.weights
    levels = []
    for level in problem.levels:
        there = [problem.rows[k] for k in level if shares[k] > 0.0]
        matrix = [row.weights[:, None] * (row.matrix @ mapping) for row in there]
        wanted = [row.weights * row.wanted for row in there]
        levels.append(Level(np.vstack([np.empty((0, len(weights))), *matrix]), np.concatenate([np.empty(0), *wanted])))
    bounds = problem.bounds and problem.bounds._replace(rows=problem.bounds.rows / weights)
    speeds = solve_levels(levels, bounds, problem.softest)
    return speeds._replace(x=mapping @ speeds.x)
