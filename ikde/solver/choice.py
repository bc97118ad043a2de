"""Which engines answer a question, in which order, with how many attempts."""

from functools import lru_cache

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.closed_form import find_still_arm, find_ur_arm
from ikde.model.large_worlds import KEPT
from ikde.model.robot import Robot
from ikde.solver.engine_table import AUTO, ENGINES
from ikde.solver.problem import Problem
from ikde.solver.settings import SolveSettings

Budgets = tuple[tuple[str, int], ...]
"""Engines in their order, each with its attempts."""


def choose_engines(
    robot: Robot, settings: SolveSettings, kinds: set[str], *, inside: bool = True, free: set[int] | None = None
) -> list[str]:
    """Engines in the order in which they try; the later ones take over what the first leaves.

    `kinds` of the targets. `inside`: the joint ranges are within the limits. `free`: the joints that may move; by
    default those that the limits leave free.
    """
    if not inside:
        return [name for name in settings.engines if not ENGINES[name].stays_in_limits] or [AUTO[-1]]
    if len(settings.engines) == 1:
        return [*settings.engines]
    arm, free = find_ur_arm(robot), find_free(robot.lower, robot.upper) if free is None else free
    is_closed = arm is not None and free == set(arm.coordinates)
    rows = {name: ENGINES[name] for name in settings.engines}
    return [n for n, row in rows.items() if kinds <= {*row.target_kinds} and (is_closed or not row.is_closed_form)]


def find_free(lower: Floats, upper: Floats) -> set[int]:
    """Joints that may move: all but those that are frozen."""
    return set(np.flatnonzero(upper > lower).tolist())


@KEPT.add
@lru_cache(maxsize=64)
def choose_budgets(problem: Problem, kinds: tuple[str, ...], attempts: int | None) -> Budgets:
    """Engines, each with its attempts; an arm on a base that cannot move has shown all its branches after one."""
    robot, settings = problem.robot, problem.settings
    inside, free = is_inside(problem), find_free(problem.lower, problem.upper)
    names = choose_engines(robot, settings, {*kinds}, inside=inside, free=free)
    stands_still = find_still_arm(robot, problem.lower, problem.upper) is not None

    def budget(name: str) -> int:
        if stands_still and ENGINES[name].is_closed_form:
            return 1
        before_next = ENGINES[name].attempts_before_next if name != names[-1] else None
        return attempts or before_next or settings.budget(name)

    return tuple((name, budget(name)) for name in names)


def is_inside(problem: Problem) -> bool:
    """Whether its ranges are inside the robot's limits."""
    return bool((problem.lower >= problem.robot.lower).all() and (problem.upper <= problem.robot.upper).all())
