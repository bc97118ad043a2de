"""Tasks of `ikde.velocity` as levels of least squares over the speeds that are sought."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ikde.kernels.arrays import Floats, Ints
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
    known = _list_columns(robot)
    mapping = known.mapping
    if known.base[0] >= 0:
        mapping, (x, y, heading) = mapping.copy(), known.base
        cos, sin = np.cos(q[heading]), np.sin(q[heading])
        mapping[x] = cos * known.mapping[x] - sin * known.mapping[y]
        mapping[y] = sin * known.mapping[x] + cos * known.mapping[y]
    free = known.is_free
    if limits.speed is not None and not limits.speed.all():
        free = free & ((limits.speed != 0.0)[known.joints] | known.is_twist)
    if free.all():
        return Way(mapping, weights[known.joints])
    return Way(mapping[:, free], weights[known.joints][free])


class _Columns(NamedTuple):
    """What stays of a robot's speeds, at heading 0."""

    base: Ints
    mapping: Floats
    joints: Ints
    """The joint that each column is of, or counts like."""
    is_twist: NDArray[np.bool_]
    is_free: NDArray[np.bool_]


@lru_cache(maxsize=64)
def _list_columns(robot: Robot) -> _Columns:
    base, still = find_planar_base(robot), np.zeros(len(robot.joints))
    mapping = speeds_by(robot, still, "twist")
    others = [place for place in range(len(still)) if base[0] < 0 or place not in base]
    count = mapping.shape[1] - len(others)
    of_twist = {0: base[:0], 2: base[[0, 2]], 3: base}[count]
    joints, is_twist = np.array([*of_twist, *others], dtype=np.int64), np.arange(mapping.shape[1]) < count
    return _Columns(base, mapping, joints, is_twist, is_twist | (robot.lower < robot.upper)[joints])


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
        made = [Level(row.weights[:, None] * (row.matrix @ mapping), row.weights * row.wanted) for row in there]
        if len(made) != 1:
            empty = Level(np.empty((0, len(weights))), np.empty(0))
            made = [Level(*(np.concatenate(parts) for parts in zip(empty, *made, strict=True)))]
        levels += made
    bounds = problem.bounds and problem.bounds._replace(rows=problem.bounds.rows / weights)
    speeds = solve_levels(levels, bounds, problem.softest)
    return speeds._replace(x=mapping @ speeds.x)
