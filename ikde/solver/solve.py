"""`solve`, `solve_many`, `solve_distinct`: search, grade, explain."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ikde.errors import InputError, VerificationError
from ikde.kernels.arrays import Floats
from ikde.kernels.jit import compile_clock
from ikde.kernels.lanes import ATTEMPTS, COLLIDING, EVALUATIONS
from ikde.model.reach import reach_excess_m
from ikde.model.robot import Detector, Robot
from ikde.model.target import Target
from ikde.solver.explain import Explanation, count_blocking_pairs, explain
from ikde.solver.joints import JointValues
from ikde.solver.problem import Freeze, Problem, make_problem
from ikde.solver.result import SolveResult, StopReason
from ikde.solver.search import AGREEMENT, Found, disagreement, search
from ikde.solver.settings import SolveSettings
from ikde.solver.verify import verify

OUT_OF_REACH_ATTEMPTS = 4  # enough to show how close the tool can come
TURN_APART_RAD, SLIDE_APART_M = 0.1, 0.05  # what makes two solutions distinct


def solve(
    robot: Robot,
    target: Target,
    settings: SolveSettings | None = None,
    *,
    seed: int = 0,
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
    problem = make_problem(
        robot, settings or SolveSettings.for_method(method), detector=detector, near=near, freeze=freeze
    )
    result, _ = _solve_one(problem, target, check_seed(seed), 0, announce_compile)
    return result


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

    The first is that of `solve`. The list is shorter if the restarts run out; unreached, it holds one result with the
    reason. Arguments as for `solve`.
    """
    if count < 1:
        raise InputError(f"expected a whole number of at least 1, got {count}", ("count",))
    chosen = settings or SolveSettings.for_method(method)
    problem = make_problem(robot, chosen, detector=detector, near=near, freeze=freeze)
    found, attempt = [], 0
    while len(found) < count and attempt < chosen.restarts:
        rest = problem.with_settings(restarts=chosen.restarts - attempt)
        result, used = _solve_one(rest, target, check_seed(seed), attempt, announce_compile, quiet=bool(found))
        attempt += used
        if not result.reached:
            return found or [result]
        if all(are_distinct(robot, result.q, other.q) for other in found):
            found.append(result)
    return found


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
    chosen = settings or SolveSettings.for_method(method)
    problem = make_problem(robot, chosen, detector=detector, near=near, freeze=freeze)
    streams = list(range(len(targets)))
    if not targets:
        return []
    started = time.perf_counter()
    with compile_clock(announce_compile) as clock:
        found = search(problem, targets, seed=check_seed(seed), streams=streams, threads=threads)
        cost = _Cost(seconds=(time.perf_counter() - started - clock.seconds) / len(targets), compile=clock.seconds)
        rows = [_row(found, index) for index in streams]
        return [
            _grade(problem, target, row, seed, stream, cost, strict=False, probe=explain_failures)
            for target, row, stream in zip(targets, rows, streams, strict=True)
        ]


def are_distinct(robot: Robot, q: Floats, other: Floats) -> bool:
    """True if some revolute joint differs by more than 0.1 rad (around the circle) or some slide by more than 50 mm."""
    for joint, difference in zip(robot.joints, np.abs(q - other), strict=True):
        if joint.kind == "prismatic" and difference > SLIDE_APART_M:
            return True
        turn = difference % (2.0 * np.pi)
        if joint.kind == "revolute" and min(turn, 2.0 * np.pi - turn) > TURN_APART_RAD:
            return True
    return False


def check_seed(seed: int) -> int:
    """Return the seed; raises `InputError` unless it is a whole number, 0 <= seed < 2^64."""
    if not isinstance(seed, int | np.integer) or isinstance(seed, bool) or not 0 <= seed < 2**64:
        raise InputError(f"expected a whole number from 0 to 2^64 - 1, got {seed!r}", ("seed",))
    return int(seed)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Cost:
    seconds: float
    compile: float


def _solve_one(
    problem: Problem,
    target: Target,
    seed: int,
    first_attempt: int,
    announce: Callable[[], None] | None,
    *,
    quiet: bool = False,
) -> tuple[SolveResult, int]:
    """One target: the graded result, and how many attempts it took. `quiet` spares the explanation."""
    excess = reach_excess_m(problem.robot, target.p_world_tool, problem.lower, problem.upper)
    short = problem
    if excess > problem.settings.position_tolerance_m:
        short = problem.with_settings(restarts=min(OUT_OF_REACH_ATTEMPTS, problem.settings.restarts))
    started = time.perf_counter()
    with compile_clock(announce) as clock:
        found = search(short, [target], seed=seed, streams=[0], first_attempt=first_attempt)
        seconds = time.perf_counter() - started - clock.seconds
        result = _grade(
            short, target, found, seed, 0, _Cost(seconds=seconds, compile=clock.seconds), strict=True, probe=not quiet
        )
    return result, int(found.counts[0, ATTEMPTS])


def _row(found: Found, index: int) -> Found:
    rows = slice(index, index + 1)
    return Found(q=found.q[rows], counts=found.counts[rows], pair_counts=found.pair_counts[rows])


def _grade(
    problem: Problem,
    target: Target,
    found: Found,
    seed: int,
    stream: int,
    cost: _Cost,
    *,
    strict: bool,
    probe: bool,
) -> SolveResult:
    """Grade one row of what the kernels found; the verdict is `verify`'s alone."""
    q = found.q[0].copy()
    graded = verify(problem.robot, target, q, settings=problem.settings, detector=problem.detector or "none")
    gap = disagreement(problem, target, q, graded)
    if gap > AGREEMENT and strict:
        raise VerificationError(f"kernels and verify disagree by {gap:.3g} on q = {q.tolist()}")
    reached = graded.accepted and gap <= AGREEMENT
    blocking = count_blocking_pairs(problem, found.pair_counts[0])
    story = Explanation(
        stop_reason=StopReason.REACHED if reached else StopReason.BUDGET,
        reason="reached, inside the limits, free of self-collision" if reached else "not reached",
        hint=None,
        blocking_pairs=blocking,
    )
    if not reached:
        story = explain(problem, target, found, graded, seed) if probe else _story_from_counts(problem, found, story)
    q.setflags(write=False)
    return SolveResult(
        reached=reached,
        stop_reason=story.stop_reason,
        reason=story.reason,
        hint=story.hint,
        q=q,
        joint_names=problem.robot.joint_names,
        verification=graded,
        verified=gap <= AGREEMENT,
        method="de",
        detector=problem.detector.name if problem.detector else "none",
        seed=seed,
        stream=stream,
        attempts=int(found.counts[0, ATTEMPTS]),
        evaluations=int(found.counts[0, EVALUATIONS]),
        rejected=int(found.counts[0, COLLIDING]),
        blocking_pairs=story.blocking_pairs,
        solve_seconds=cost.seconds,
        compile_seconds=cost.compile,
    )


def _story_from_counts(problem: Problem, found: Found, story: Explanation) -> Explanation:
    if found.counts[0, COLLIDING] == 0:
        return story
    return Explanation(
        stop_reason=StopReason.SELF_COLLISION,
        reason=f"only colliding solutions found, {int(found.counts[0, COLLIDING])} of them",
        hint=None,
        blocking_pairs=story.blocking_pairs,
    )
