"""`solve` and `solve_many`: search, grade, explain."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from importlib import import_module
from time import perf_counter
from typing import Any

from ikde.errors import InputError
from ikde.kernels.arrays import read_only
from ikde.model.arguments import RobotLike, read_robot, read_target
from ikde.model.collision_model import CollisionChoice, CollisionModel
from ikde.model.large_worlds import KEPT
from ikde.model.region import GoalLike, GoalsLike, Region, read_goals
from ikde.model.robot import Robot
from ikde.model.target import Target, Targets
from ikde.solver.asker import find_asker
from ikde.solver.background import choose_way
from ikde.solver.engine_table import Method
from ikde.solver.joints import JointValues
from ikde.solver.motion import Weights
from ikde.solver.preferred import Prefer
from ikde.solver.problem import Freeze, Problem, make_problem
from ikde.solver.quick import Quick, find_quick
from ikde.solver.region_rows import solve_goals
from ikde.solver.regions import RegionQuestion, solve_region
from ikde.solver.result import SolveResult, change_result
from ikde.solver.results import SolveResults, solve_rows
from ikde.solver.settings import BulkOptions, SolveSettings, check_seed, check_stream, choose_settings

USUAL = BulkOptions()


def solve(
    robot: RobotLike,
    target: GoalLike,
    settings: SolveSettings | Mapping[str, Any] | None = None,
    *,
    seed: int = 0,
    stream: int = 0,
    method: Method = "auto",
    collision: CollisionChoice = None,
    near: JointValues | None = None,
    freeze: Freeze | None = None,
    weights: Weights | None = None,
    prefer: Prefer | None = None,
) -> SolveResult:
    """Find a configuration that meets the target, inside all limits and free of self-collision.

    Args:
        robot: the robot, its name or the path of its file.
        target: what the tool is asked to do: a `Target`, a position [3] in m, or a pose [4, 4], also that
            of another library (`.homogeneous`, `.A`, `.as_matrix()`); or a `Region`, of which any pose will do: exact
            ones are drawn, its centre first, and the first that is reached is the `target` of the result.
        settings: tolerances and search settings, or a mapping of some; others are the method's own
            (`SolveSettings.for_method`).
        seed: same seed, same bits. 0 <= seed < 2^64.
        stream: which random stream of the seed; `solve_many` gives its target k stream k.
        method: the engine (`SolveSettings.method`); `"auto"` is ikde's choice.
        collision: what is checked: a detector's name, a `Detector`, a `CollisionModel`, `"none"` (self-collision is not
            checked), or None for the robot's default.
        near: joint values to stay close to, brought inside the ranges: they are searched in growing boxes around them,
            and what is found is moved to a local minimum of the motion from there. `near` itself is the answer, to
            the bit, if it meets the target.
        freeze: joints that must not move, with their value in m or rad (None: from `near`, else home).
        weights: of joints, by name, in the motion sqrt(sum (w_j dq_j)^2), per m or rad, 1e-6 to 1e6; left out: 1 /
            range, 1 / (2 pi) for a joint without limits, and 1 / m for a planar base.
        prefer: what the answer is moved for where the target leaves it free: it stays on its target, inside the limits
            and free, and ends at a local optimum (`SolveResult.preferred`) of `"manipulability"`, of the whole robot's
            pose, scaled by speed limits; `"clearance"`, beyond what is asked for; `"limits"`, the smallest share of its
            range that a joint is from its limits; or `"motion"`, the least from `near`, else home. Not for a `Region`.

    Returns:
        The solution, or the best configuration found with the reason, graded by the kernels' grader. `verified` is None
        where plain numpy was not asked: of what written kernels of `lm` or the closed form reach. `result.grade`
        asks it. docs/design.md tells what each grader shares with the search.

    Raises:
        InputError: for what does not fit the robot.
        VerificationError: if kernels and `verify` disagree by more than 1e-11: a bug.
    """
    started = perf_counter()
    if prefer is not None:
        asked = {"collision": collision, "near": near, "freeze": freeze, "weights": weights}
        return _solve_preferred(robot, target, choose_settings(settings, method), prefer, seed, stream, asked)
    if isinstance(target, Region):
        problem = _make_problem(read_robot(robot), choose_settings(settings, method), collision, near, freeze, weights)
        return solve_region(RegionQuestion(problem, target, check_seed(seed), check_stream(stream)))
    if type(robot) is not Robot or type(target) is not Target:
        robot, target = read_robot(robot), read_target(target)
    if settings is not None and type(settings) is not SolveSettings:
        settings = choose_settings(settings, method)
    if seed or stream or type(seed) is not int or type(stream) is not int:  # 0.2 us less for the first stream
        seed, stream = check_seed(seed), check_stream(stream)
    if near is None and freeze is None and weights is None:
        try:
            quick = find_quick(robot, settings, method, collision, target.kind)
        except TypeError:  # what has no hash is nothing that fits: it is refused below, by name
            quick = None
        result = quick.solve(target, seed, stream, started) if quick else None
        if result is not None:
            return result
    chosen = choose_settings(settings, method)
    problem = make_problem(robot, chosen, collision=collision, near=near, freeze=freeze, weights=weights)
    if near is not None or freeze is not None or weights is not None:
        quick = find_asker(problem.collision, chosen, target.kind).make(problem, Quick)
        result = quick.solve(target, seed, stream, started) if quick else None
        if result is not None:
            return result
    result = solve_rows(problem, [target], seed=seed, first_stream=stream, strict=True).row(0)
    waited_s = perf_counter() - started - result.compile_seconds
    return change_result(result, solve_seconds=max(waited_s, result.solve_seconds))


def _solve_preferred(
    robot: RobotLike,
    target: GoalLike,
    chosen: SolveSettings,
    prefer: Prefer,
    seed: int,
    stream: int,
    asked: dict[str, Any],
) -> SolveResult:
    """What `solve` finds, moved for what is preferred."""
    robot = read_robot(robot)
    if isinstance(target, Region):
        raise InputError("an answer is moved for an exact target; this one is a region", ("prefer",))
    if prefer == "motion" and asked["near"] is None:
        asked["near"] = robot.home
    problem = make_problem(robot, chosen, **asked)
    import_module("ikde.solver.objectives").check_prefer(problem.collision, prefer)  # others do not wait for these
    result = solve(robot, target, chosen, seed=seed, stream=stream, **asked)
    return import_module("ikde.solver.prefer").move_to_preferred(problem, result, prefer)


def solve_many(
    robot: RobotLike,
    targets: GoalsLike,
    settings: SolveSettings | Mapping[str, Any] | None = None,
    *,
    seed: int = 0,
    method: Method = "auto",
    collision: CollisionChoice = None,
    near: JointValues | None = None,
    freeze: Freeze | None = None,
    weights: Weights | None = None,
    bulk: BulkOptions | None = None,
) -> SolveResults:
    """Solve many targets at once, a lane each on all threads, in order; target k has the stream (seed, k).

    `targets`: `Targets`, positions [T, 3] in m, poses [T, 4, 4], or a sequence of what `solve` takes; one
    target is one row. Where some are a `Region`, each row is solved as `solve` does, and graded by plain numpy.
    `bulk` says on how many threads, whose answers plain numpy grades as well (`verified` is masked where it was not
    asked), and whether failures are explained. A disagreement does not raise: that result is not reached, and
    `verified` is False. Other arguments as for `solve`.

    Returns:
        A sequence of `SolveResult` whose columns are arrays: `q` [T, N], `reached` [T], `clearance_m` [T] and so on.
    """
    choose_way()  # a wrong word is found before anything else
    if not isinstance(bulk, BulkOptions | None):
        raise InputError(f"expected BulkOptions, got {bulk!r}", ("bulk",))
    robot, chosen = read_robot(robot), choose_settings(settings, method)
    problem = _make_problem(robot, chosen, collision, near, freeze, weights)
    goals = read_goals(targets)
    if isinstance(goals, Targets):
        return solve_rows(problem, goals, bulk or USUAL, seed=check_seed(seed))
    return solve_goals(problem, goals, seed=check_seed(seed))


def _make_problem(
    robot: Robot,
    chosen: SolveSettings,
    collision: CollisionChoice,
    near: JointValues | None,
    freeze: Freeze | None,
    weights: Weights | None,
) -> Problem:
    """A question about some joints, or about the whole robot, which is kept."""
    if near is None and freeze is None and weights is None:
        return _find_problem(CollisionModel.of(robot, collision), chosen)
    return make_problem(robot, chosen, collision=collision, near=near, freeze=freeze, weights=weights)


@KEPT.add
@lru_cache(maxsize=16)
def _find_problem(collision: CollisionModel, settings: SolveSettings) -> Problem:
    """The whole robot's question: what is prepared for it (`search`, `engines.lm`) is prepared once."""
    problem = make_problem(collision.robot, settings, collision=collision, near=None, freeze=None)
    read_only(problem.lower)
    read_only(problem.upper)
    return problem
