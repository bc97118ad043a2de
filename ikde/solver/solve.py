"""`solve`, `solve_many`, `solve_distinct`: search, grade, explain."""

from collections.abc import Callable, Sequence

import numpy as np

from ikde.errors import InputError
from ikde.kernels.arrays import Floats
from ikde.model.robot import Detector, Robot
from ikde.model.target import Target
from ikde.solver.joints import JointValues
from ikde.solver.problem import Freeze, make_problem
from ikde.solver.result import SolveResult
from ikde.solver.rows import solve_rows
from ikde.solver.settings import SolveSettings

TURN_APART_RAD, SLIDE_APART_M = 0.1, 0.05  # what makes two solutions distinct


def solve(
    robot: Robot,
    target: Target,
    settings: SolveSettings | None = None,
    *,
    seed: int = 0,
    stream: int = 0,
    method: str = "auto",
    detector: str | Detector | None = None,
    near: JointValues | None = None,
    freeze: Freeze | None = None,
    announce_compile: Callable[[], None] | None = None,
) -> SolveResult:
    """Find a configuration that meets the target, inside all limits and free of self-collision.

    Args:
        robot: the robot.
        target: what the tool is asked to do.
        settings: tolerances and search settings; None for the method's own (`SolveSettings.for_method`).
        seed: same seed, same bits. 0 <= seed < 2^64.
        stream: which random stream of the seed; `solve_many` gives its target k stream k.
        method: `"auto"`, ikde's choice, or `"de"`, the search of the paper.
        detector: a name, a `Detector`, `"none"`, or None for the robot's default.
        near: joint values to stay close to: the joint ranges are searched in growing boxes around them.
        freeze: joints that must not move, with their value in m or rad (None: from `near`, else home).
        announce_compile: called once if kernels must be compiled first.

    Returns:
        The solution, or the best configuration found with the reason; graded by `verify` either way.

    Raises:
        InputError: for what does not fit the robot.
        VerificationError: if kernels and `verify` disagree by more than 1e-11: a bug.
    """
    problem = make_problem(robot, _choose(settings, method), detector=detector, near=near, freeze=freeze)
    options = {"seed": check_seed(seed), "first_stream": stream, "announce_compile": announce_compile}
    return solve_rows(problem, [target], strict=True, **options).row(0)


def solve_distinct(
    robot: Robot,
    target: Target,
    count: int,
    settings: SolveSettings | None = None,
    *,
    seed: int = 0,
    method: str = "auto",
    detector: str | Detector | None = None,
    near: JointValues | None = None,
    freeze: Freeze | None = None,
    announce_compile: Callable[[], None] | None = None,
) -> list[SolveResult]:
    """Up to `count` distinct solutions: each two differ by more than 0.1 rad in a turn or 50 mm in a slide.

    The first is that of `solve`. The list is shorter if a search fails, or after `count` times the settings' restarts;
    unreached, it holds one result with the reason. Arguments as for `solve`.
    """
    if count < 1:
        raise InputError(f"expected a whole number of at least 1, got {count}", ("count",))
    chosen = _choose(settings, method)
    problem = make_problem(robot, chosen, detector=detector, near=near, freeze=freeze)
    solutions: list[SolveResult] = []
    attempt = 0
    while len(solutions) < count and attempt < count * chosen.restarts:
        options = {"seed": check_seed(seed), "first_attempt": attempt, "announce_compile": announce_compile}
        result = solve_rows(problem, [target], strict=True, probe=not solutions, **options).row(0)
        attempt += result.attempts
        if not result.reached:
            return solutions or [result]
        if all(are_distinct(robot, result.q, other.q) for other in solutions):
            solutions.append(result)
    return solutions


def solve_many(
    robot: Robot,
    targets: Sequence[Target],
    settings: SolveSettings | None = None,
    *,
    seed: int = 0,
    method: str = "auto",
    detector: str | Detector | None = None,
    near: JointValues | None = None,
    freeze: Freeze | None = None,
    threads: int | None = None,
    explain_failures: bool = True,
    announce_compile: Callable[[], None] | None = None,
) -> list[SolveResult]:
    """Solve many targets at once, a lane each on all threads, in order; target k has the stream (seed, k).

    A disagreement between kernels and `verify` does not raise: that result is not reached and not `verified`.
    Without `explain_failures` an unreached target is told from its counts alone, which costs nothing. Other arguments
    as for `solve`.
    """
    if threads is not None and threads < 1:
        raise InputError(f"expected a whole number of at least 1, got {threads}", ("threads",))
    chosen = _choose(settings, method)
    problem = make_problem(robot, chosen, detector=detector, near=near, freeze=freeze)
    if not targets:
        return []
    rows = solve_rows(
        problem,
        targets,
        seed=check_seed(seed),
        threads=threads,
        probe=explain_failures,
        announce_compile=announce_compile,
    )
    return [rows.row(index) for index in range(len(rows))]


def are_distinct(robot: Robot, q: Floats, other: Floats) -> bool:
    """True if a revolute joint differs by more than 0.1 rad (around the circle) or the slides by more than 50 mm."""
    difference = np.abs(q - other)
    turns = difference[~robot.slides] % (2.0 * np.pi)
    turned = np.minimum(turns, 2.0 * np.pi - turns) > TURN_APART_RAD
    return bool(np.any(turned) or np.linalg.norm(difference[robot.slides]) > SLIDE_APART_M)


def check_seed(seed: int) -> int:
    """Return the seed; raises `InputError` unless it is a whole number, 0 <= seed < 2^64."""
    if not isinstance(seed, int | np.integer) or isinstance(seed, bool) or not 0 <= seed < 2**64:
        raise InputError(f"expected a whole number from 0 to 2^64 - 1, got {seed!r}", ("seed",))
    return int(seed)


def _choose(settings: SolveSettings | None, method: str) -> SolveSettings:
    """The settings, or the method's own; a wrong name is an error either way."""
    own = SolveSettings.for_method(method)
    return own if settings is None else settings
