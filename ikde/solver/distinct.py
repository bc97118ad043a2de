"""Several solutions of one target, far enough apart to be a choice, best first by a stated cost."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, Literal, TypedDict, Unpack, get_args

import numpy as np

from ikde.errors import InputError, quoted
from ikde.kernels.arrays import Floats
from ikde.kernels.seeds import LUCKY_ATTEMPTS
from ikde.model.arguments import RobotLike, read_robot, read_target
from ikde.model.collision_model import CollisionChoice
from ikde.model.region import GoalLike, Region
from ikde.model.robot import Robot
from ikde.model.target import Target
from ikde.solver.engine_table import ENGINES, Method
from ikde.solver.grade import confirm
from ikde.solver.joints import JointValues
from ikde.solver.motion import Weights, limit_margin
from ikde.solver.objectives import choose_measure, measure_manipulability
from ikde.solver.problem import Freeze, Problem, make_problem
from ikde.solver.regions import RegionQuestion, RegionSearch
from ikde.solver.result import SolveResult
from ikde.solver.results import solve_rows
from ikde.solver.settings import BulkOptions, SolveSettings, check_seed, choose_settings, describe_count, is_count
from ikde.solver.solve import solve

REVOLUTE_APART_RAD, PRISMATIC_APART_M = 0.1, 0.05  # what makes two solutions distinct
SAMPLES = 16  # solves for each solution that is wanted, to choose from
MAX_WANTED = 10_000  # solutions
ROUNDS = 4  # as often, if they were too much alike

NOTHING_ELSE: dict[str, Any] = {"collision": None, "near": None, "freeze": None}
UNEXPLAINED = BulkOptions(verify="all", explain=False)

Rank = Literal["motion", "clearance", "limits", "manipulability", "found"]


class DistinctResults(list[SolveResult]):
    """Solutions, best first; a list that a notebook shows in a line."""

    def __repr__(self) -> str:
        return f"<DistinctResults: {len(self)}, {sum(result.reached for result in self)} reached>"


class Question(TypedDict, total=False):
    """What `solve` is asked beside the target, too."""

    collision: CollisionChoice
    near: JointValues | None
    freeze: Freeze | None
    weights: Weights | None


def solve_distinct(
    robot: RobotLike,
    target: GoalLike,
    count: int,
    settings: SolveSettings | Mapping[str, Any] | None = None,
    *,
    rank: Rank = "motion",
    seed: int = 0,
    method: Method = "auto",
    **question: Unpack[Question],
) -> DistinctResults:
    """Up to `count` distinct solutions: any two differ by more than 0.1 rad or 50 mm in a joint.

    The list is shorter if no more are found; unreached, it holds one result with the reason. Plain numpy has graded
    each (`verified`). A timeout is that of the whole call.

    Args:
        robot: the robot, its name or the path of its file.
        target: what the tool is asked to do, as for `solve`; of a `Region` solutions may meet poses of their own.
        count: how many are wanted.
        settings: tolerances and search settings; None for the method's own.
        rank: what comes first, and what is kept of many: `"motion"`, the least from `near`, else home
            (`SolveResult.motion`); `"clearance"`, the most room between components, and to obstacles, beyond what is
            asked for (`SolveResult.room_m`); `"limits"`, the largest distance from the joint limits, of the joint
            that is nearest to one as a share of its range; `"manipulability"`, the largest of the whole robot's pose,
            scaled by speed limits (`solve`, `prefer`); `"found"`, in the order of the search, the first being that
            of `solve`. Without a detector there is no clearance to rank by.
        seed: same seed, same bits.
        method: the engine.
        question: `collision`, `near`, `freeze` and `weights`, as for `solve`. With `near` the first that is found is a
            local minimum of the motion; the others are as the search finds them, since few are.
    """
    if not is_count(1, MAX_WANTED)(count):
        raise InputError(f"expected {describe_count(1, MAX_WANTED)}, got {quoted(count)}", ("count",))
    check_rank(rank)
    robot = read_robot(robot)
    chosen = choose_settings(settings, method)
    problem = make_problem(robot, chosen, **{**NOTHING_ELSE, **question})
    if rank == "clearance" and not problem.collision.pairs:
        raise InputError("without a detector no clearance is known to rank by", ("rank",))
    if rank == "manipulability":
        choose_measure(robot)
    if isinstance(target, Region):
        return _solve_in_region(RegionQuestion(problem, target, check_seed(seed), 0), count, rank)
    target = read_target(target)
    options = {"bulk": UNEXPLAINED, "seed": check_seed(seed), "strict": True}
    first = confirm(robot, solve(robot, target, chosen, seed=seed, **question))
    if not first.reached or count == 1 or problem.is_fixed:
        return DistinctResults([first])
    look = _sample if ENGINES[chosen.engines[0]].starts_near else _go_on
    solutions = look(replace(problem, descends=False), target, count, first, options)
    return DistinctResults(sort_solutions(robot, solutions, rank)[:count])


def _solve_in_region(question: RegionQuestion, count: int, rank: Rank) -> DistinctResults:
    """Distinct solutions of a region: each of them meets an exact pose of its own."""
    robot, search_of = question.problem.robot, RegionSearch(question)
    solutions: list[SolveResult] = []
    for number, result in enumerate(search_of.answers(), 1):
        if all(are_distinct(robot, result.q, other.q) for other in solutions):
            solutions.append(result)
        if number >= SAMPLES * count or len(solutions) == count == 1:
            break
    if not solutions:
        return DistinctResults([search_of.give_up()])
    return DistinctResults(sort_solutions(robot, solutions, rank)[:count])


def check_rank(rank: str) -> None:
    """Raise `InputError` for an order that is none."""
    if rank not in get_args(Rank):
        raise InputError(f"expected one of {', '.join(get_args(Rank))}, got {rank!r}", ("rank",))


class Clock:
    """The time that solving takes after the first result, whose search is counted, too; without compiling."""

    def __init__(self, problem: Problem, first: SolveResult) -> None:
        self._started = time.perf_counter() - first.solve_seconds
        self._timeout_s = problem.settings.timeout_s

    def leave_out(self, seconds: float) -> None:
        """Do not count so much of it."""
        self._started += seconds

    @property
    def spent_s(self) -> float:
        """Seconds until now."""
        return time.perf_counter() - self._started

    @property
    def is_up(self) -> bool:
        """True if there is a timeout, and it has passed."""
        return self._timeout_s is not None and self.spent_s >= self._timeout_s


def sort_solutions(robot: Robot, solutions: list[SolveResult], rank: Rank) -> list[SolveResult]:
    """Best first; equals stay in the order in which they were found."""
    costs: dict[Rank, Callable[[SolveResult], float]] = {
        "motion": lambda result: result.motion,
        "clearance": lambda result: -(result.room_m or 0.0),
        "limits": lambda result: -float(limit_margin(robot.lower, robot.upper, result.q)),
        "manipulability": lambda result: -float(measure_manipulability(robot, result.q)),
        "found": lambda result: 0.0,
    }
    return sorted(solutions, key=costs[rank])


def _sample(
    problem: Problem, target: Target, count: int, first: SolveResult, options: dict[str, Any]
) -> list[SolveResult]:
    """Distinct solutions of many solves side by side, each on a stream of its own."""
    solutions, size, clock = [first], SAMPLES * count, Clock(problem, first)
    # Early attempts of `lm` begin near the target, where all find the same; with `near`, attempt 0 is `near` itself.
    begin = LUCKY_ATTEMPTS if problem.near is None else 1
    several = size if problem.settings.timeout_s is None else 1
    for stream in range(1, 1 + ROUNDS * size, several):
        where = {"first_stream": stream, "first_attempt": begin, "spent_s": clock.spent_s}
        rows = solve_rows(problem, [target] * several, **where, **options)
        for row in np.flatnonzero(rows.reached).tolist():
            if all(are_distinct(problem.robot, rows.q[row], other.q) for other in solutions):
                solutions.append(rows.row(row))
        clock.leave_out(rows.compile_seconds)
        is_round = (stream + several - 1) % size == 0
        if clock.is_up or (is_round and len(solutions) >= count):
            break
    return solutions


def _go_on(
    problem: Problem, target: Target, count: int, first: SolveResult, options: dict[str, Any]
) -> list[SolveResult]:
    """Distinct solutions of one stream: the search goes on where it has found one."""
    solutions, attempt, clock = [first], first.attempts, Clock(problem, first)
    most = count * problem.settings.budget(first.method)
    while len(solutions) < count and attempt < most and not clock.is_up:
        where = {"first_attempt": attempt, "spent_s": clock.spent_s}
        result = solve_rows(problem, [target], **where, **options).row(0)
        attempt += result.attempts
        clock.leave_out(result.compile_seconds)
        if not result.reached:
            break
        if all(are_distinct(problem.robot, result.q, other.q) for other in solutions):
            solutions.append(result)
    return solutions


def are_distinct(robot: Robot, q: Floats, other: Floats) -> bool:
    """True if a revolute joint differs by more than 0.1 rad (around the circle) or a prismatic one by 50 mm."""
    difference = np.abs(q - other)
    angles = difference[~robot.is_prismatic] % (2.0 * np.pi)
    rotated = np.minimum(angles, 2.0 * np.pi - angles) > REVOLUTE_APART_RAD
    return bool(np.any(rotated) or np.any(difference[robot.is_prismatic] > PRISMATIC_APART_M))
