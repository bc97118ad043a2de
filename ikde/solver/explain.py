"""Why there is no solution, and what would help: found by trying, not by guessing."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ikde.kernels.arrays import ATTEMPTS, COLLIDING, REACHED, Floats, Ints
from ikde.model.reach import reach_excess_m
from ikde.model.robot import Pairs
from ikde.model.target import Target
from ikde.solver.engines.found import Found
from ikde.solver.plain import compute_gaps
from ikde.solver.problem import Problem
from ikde.solver.result import STOP_REASONS, StopReason
from ikde.solver.search import search
from ikde.solver.touching import AlwaysTouching, find_always_touching
from ikde.solver.verify import Verification

PROBE_ATTEMPTS = {True: 24, False: 2}  # of the DE, of other engines
COUNTED = 64  # attempts whose collisions are counted pair by pair
WIDER = 4.0  # how much wider the slides get when a probe asks whether limits are what stands in the way
GENEROUS = 100.0  # a best error within this many tolerances is worth a word about the tolerance

MORE_TIME = "a longer timeout, or none: then the search ends with its attempts and looks into what is in the way"

_OUT_OF_REACH, _SELF_COLLISION, _BUDGET, _TIMED_OUT = map(
    STOP_REASONS.index,
    (StopReason.OUT_OF_REACH, StopReason.SELF_COLLISION, StopReason.BUDGET, StopReason.TIMED_OUT),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Explanation:
    """Why, in a word and in a line, and what would help."""

    stop_reason: StopReason
    reason: str
    hint: str | None
    blocking_pairs: Mapping[tuple[str, str], int]


def count_blocking_pairs(pairs: Pairs, pair_counts: np.ndarray) -> dict[tuple[str, str], int]:
    """Pairs that blocked, with how often, most often first."""
    blocking = {pairs[k]: int(pair_counts[k]) for k in np.flatnonzero(pair_counts)}
    return dict(sorted(blocking.items(), key=lambda item: -item[1]))


def stop_from_counts(found: Found, timeout_s: float | None) -> Ints:
    """What the counts of the search alone tell, at no cost: index [T] into `STOP_REASONS` of rows not reached."""
    stops = np.where(found.counts[:, COLLIDING] > 0, _SELF_COLLISION, _BUDGET)
    if timeout_s is not None:
        stops[found.seconds >= timeout_s] = _TIMED_OUT
    return np.where(found.excess_m > 0.0, _OUT_OF_REACH, stops)


def reason_from_counts(
    stop: StopReason, excess_m: float, attempts: int, colliding: int, timeout_s: float | None
) -> str:
    """One line that says it."""
    if stop is StopReason.OUT_OF_REACH:
        return _out_of_reach(excess_m)
    if stop is StopReason.SELF_COLLISION:
        return f"only colliding solutions found, {colliding} of them"
    if stop is StopReason.TIMED_OUT:
        met = f", {colliding} of them in collision at the target" if colliding else ""
        return f"timed out after {timeout_s:g} s and {_count(attempts)}{met}"
    return f"{_count(attempts)} spent"


def explain(problem: Problem, target: Target, found: Found, graded: Verification, seed: int) -> Explanation:
    """Explain an unreached target from its counts, a proved bound, and short searches that change one thing."""
    if found.excess_m[0] > 0.0:
        reason, hint = _out_of_reach(float(found.excess_m[0])), _reach_hint(problem, target)
        return Explanation(stop_reason=StopReason.OUT_OF_REACH, reason=reason, hint=hint, blocking_pairs={})
    colliding, pairs = int(found.counts[0, COLLIDING]), problem.robot.pairs(problem.detector)
    blocking, timeout_s = count_blocking_pairs(pairs, found.pair_counts[0]), problem.settings.timeout_s
    if stop_from_counts(found, timeout_s)[0] == _TIMED_OUT:
        return _timed_out(found, graded, timeout_s, blocking)
    if colliding > 0 and not problem.settings.evolves and timeout_s is None:
        counted = _count_pairs(problem, target, seed)
        colliding, blocking = counted if counted[0] else (colliding, blocking)
    probe = _Probe(target, seed, float(found.seconds[0]))
    if colliding == 0 and problem.detector is not None and problem.settings.evolves:
        tested = probe.run(problem.with_settings(collision="reject"))
        colliding, blocking = int(tested.counts[0, COLLIDING]), count_blocking_pairs(pairs, tested.pair_counts[0])
        if tested.counts[0, REACHED]:
            return _spent(found, graded, "more restarts: a search that only tests the best (reject) found a solution")
    touching = find_always_touching(problem.robot, problem.detector) if problem.detector else None
    if touching is not None:
        return _never_free(touching, blocking)
    return _explain_by_remedies(problem, probe, found, graded, colliding, blocking)


def _explain_by_remedies(
    problem: Problem,
    probe: "_Probe",
    found: Found,
    graded: Verification,
    colliding: int,
    blocking: Mapping[tuple[str, str], int],
) -> Explanation:
    remedy = _try_remedies(problem, probe)
    if colliding > 0:
        worst = ", ".join(f"{a}-{b} ({n} of {colliding})" for (a, b), n in list(blocking.items())[:3])
        return Explanation(
            stop_reason=StopReason.SELF_COLLISION,
            reason=f"only colliding solutions found: {colliding} met the target, each in collision; blocked by {worst}",
            hint=remedy or "a detector with tighter spheres, or another target",
            blocking_pairs=blocking,
        )
    if remedy:
        return Explanation(
            stop_reason=StopReason.LIMITS,
            reason=f"no configuration inside the joint ranges meets the target; {_best(graded)}",
            hint=remedy,
            blocking_pairs={},
        )
    return _spent(found, graded, _tolerance_hint(problem, graded))


def _never_free(touching: AlwaysTouching, blocking: Mapping[tuple[str, str], int]) -> Explanation:
    lines = f": {' and '.join(touching.lines)}" if touching.lines else ""
    return Explanation(
        stop_reason=StopReason.SELF_COLLISION,
        reason=f"{touching}; if that is meant, {touching.remedy}{lines}",
        hint="leave out pairs that may touch, or give the others smaller spheres",
        blocking_pairs=blocking,
    )


def _out_of_reach(excess_m: float) -> str:
    return f"out of reach: at least {excess_m:.3f} m beyond the stretched arm at the nearest base position"


def _spent(found: Found, graded: Verification, hint: str | None) -> Explanation:
    reason = f"{_count(int(found.counts[0, ATTEMPTS]))} spent; {_best(graded)}"
    return Explanation(stop_reason=StopReason.BUDGET, reason=reason, hint=hint, blocking_pairs={})


def _timed_out(
    found: Found, graded: Verification, timeout_s: float | None, blocking: Mapping[tuple[str, str], int]
) -> Explanation:
    attempts, colliding = found.counts[0, [ATTEMPTS, COLLIDING]].tolist()
    reason = reason_from_counts(StopReason.TIMED_OUT, 0.0, attempts, colliding, timeout_s)
    return Explanation(
        stop_reason=StopReason.TIMED_OUT,
        reason=f"{reason}; {_best(graded)}",
        hint=MORE_TIME,
        blocking_pairs=blocking,
    )


def _count(attempts: int) -> str:
    return f"{attempts} attempt{'s' if attempts != 1 else ''}"


def _best(graded: Verification) -> str:
    return f"the best is off by {graded.position_error_m:.3g} m and {graded.orientation_error_rad:.3g} rad"


@dataclass(slots=True)
class _Probe:
    """Short searches for one target, within what is left of its time."""

    target: Target
    seed: int
    spent_s: float

    def run(self, problem: Problem) -> Found:
        """A few attempts at a question that may have been changed."""
        brief = problem.with_settings(restarts=PROBE_ATTEMPTS[problem.settings.evolves])
        found = search(brief, [self.target], seed=self.seed, streams=[0], spent_s=self.spent_s)
        self.spent_s += float(found.seconds[0])
        return found


def _count_pairs(problem: Problem, target: Target, seed: int) -> tuple[int, dict[tuple[str, str], int]]:
    """How many of some attempts met the target in collision, and how often each pair was to blame."""
    begin = 0 if problem.near is None else 1  # attempt 0 is `near` itself, on every stream
    found = search(problem, [target] * COUNTED, seed=seed, streams=range(COUNTED), first_attempt=begin, attempts=1)
    met = found.q[(found.score[:, 0] == 0.0) & (found.counts[:, REACHED] == 0)]
    detector = problem.detector
    if detector is None or not len(met):
        return 0, {}
    pairs = problem.robot.pairs(detector)
    gaps = compute_gaps(problem.robot, detector.spheres, pairs, met)
    return len(met), count_blocking_pairs(pairs, (gaps <= detector.safe_distance_m).sum(axis=0))


def _widened(problem: Problem) -> tuple[Floats, Floats]:
    """Slides four times as wide, revolute joints free to turn once around."""
    slides, lower, upper = problem.robot.slides, problem.robot.lower, problem.robot.upper
    grow = 0.5 * (WIDER - 1.0) * (upper - lower)
    wide_lower = np.where(slides, lower - grow, np.minimum(lower, -np.pi))
    wide_upper = np.where(slides, upper + grow, np.maximum(upper, np.pi))
    return wide_lower, wide_upper


def _try_remedies(problem: Problem, probe: _Probe) -> str | None:
    """The first single change with which a short search succeeds."""
    robot = problem.robot
    if problem.frozen:
        free = problem.with_ranges(robot.lower, robot.upper)
        if probe.run(free).counts[0, REACHED]:
            return f"free {', '.join(problem.frozen)}: a solution was found without freezing"
    lower, upper = _widened(problem)
    found = probe.run(problem.with_ranges(lower, upper))
    if found.counts[0, REACHED]:
        outside = (found.q[0] < problem.lower) | (found.q[0] > problem.upper)
        names = [joint.name for joint, out in zip(robot.joints, outside, strict=True) if out]
        if names:
            return f"a wider range for {', '.join(names)}: a solution was found beyond the limits"
    return None


def _reach_hint(problem: Problem, target: Target) -> str:
    robot = problem.robot
    if problem.frozen and reach_excess_m(robot, target.p_world_tool, robot.lower, robot.upper) == 0.0:
        return f"free {', '.join(problem.frozen)}: then the bound no longer excludes the target"
    names = [joint.name for joint in robot.joints if joint.kind == "prismatic"]
    far = np.where(robot.slides, 1e3, 0.0)  # m; what turns may do does not enter the bound
    if names and reach_excess_m(robot, target.p_world_tool, -far, far) == 0.0:
        return f"a larger range for {', '.join(names)} would bring it into reach"
    return "a target closer to the robot; no joint range brings the tool there"


def _tolerance_hint(problem: Problem, graded: Verification) -> str | None:
    settings = problem.settings
    close = graded.position_error_m <= GENEROUS * settings.position_tolerance_m
    close = close and graded.orientation_error_rad <= GENEROUS * settings.orientation_tolerance_rad
    if not close or graded.self_collision:
        return "more generations or restarts, or another target"
    wanted = f"{_round_up(graded.position_error_m)} m"
    if graded.orientation_error_rad > 0.0:
        wanted += f" and {_round_up(graded.orientation_error_rad)} rad"
    return f"a tolerance of {wanted} would accept the best"


def _round_up(value: float) -> str:
    """Two digits, never below the value."""
    step = 10.0 ** (np.floor(np.log10(value)) - 1)
    return f"{np.ceil(value / step) * step:.2g}"
