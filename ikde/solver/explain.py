"""Why there is no solution: proved by a bound, or as far as trying tells."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from ikde.kernels.answer import BLOCKED, FIRST_COUNT, METRICS, SCORE
from ikde.kernels.arrays import ATTEMPTS, COLLIDING, REACHED, Floats, Ints
from ikde.model.collision_model import CollisionModel
from ikde.model.target import Target, Targets
from ikde.solver.branches import rule_out_by_branches, tell_branches
from ikde.solver.digits import at_least
from ikde.solver.engine_table import ENGINES
from ikde.solver.engines.search_state import SearchState, make_search_state
from ikde.solver.fixed import tell_fixed
from ikde.solver.hints import (
    Probe,
    hint_at_bounds,
    hint_at_branches,
    hint_at_stream,
    hint_at_tolerance,
    try_freeing,
    try_longer,
    try_widening,
)
from ikde.solver.plain import compute_gaps
from ikde.solver.problem import Problem
from ikde.solver.proof import prove
from ikde.solver.remedies import try_in_world
from ikde.solver.result import NO_SOLUTION, STOP_REASONS, StopReason, count_blocking_pairs
from ikde.solver.search import search
from ikde.solver.sweep import Swept, rule_out_by_sweep, tell_sweep
from ikde.solver.tool_body import tell_tool_body
from ikde.solver.touching import find_always_touching
from ikde.solver.verify import Bools, Grade, verify

COUNTED = 64  # attempts whose collisions are counted pair by pair

PROVED = {
    StopReason.OUT_OF_REACH: "no configuration of the arm, whatever its limits, has this pose",
    StopReason.LIMITS: "every configuration with this pose is outside the limits",
    StopReason.COLLISION: "every configuration with this pose collides or is outside the limits",
    StopReason.WORLD: "every configuration that meets the target collides or is outside the limits",
}

COLLIDES = StopReason.COLLISION, StopReason.WORLD
MORE_TIME = "a longer timeout, or none: then the search ends with its attempts and diagnoses what is in the way"

_OUT_OF_REACH, _COLLISION, _BUDGET, _TIMED_OUT, _WORLD = (
    STOP_REASONS.index(StopReason(word)) for word in ("out_of_reach", "collision", "budget", "timed_out", "world")
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Explanation:
    """Why, in a word and in a line, and what would help."""

    stop_reason: StopReason
    reason: str
    hint: str | None
    blocking_pairs: Mapping[tuple[str, str], int]


@dataclass(frozen=True, slots=True)
class _Met:
    """How many attempts met the target in collision, and how often each pair was to blame."""

    colliding: int
    blocking: Mapping[tuple[str, str], int]
    often: Mapping[str, str] = field(default_factory=dict)
    """The component that touched an obstacle most often, by the obstacle; empty where that was not counted."""


def stop_from_counts(problem: Problem, found: SearchState) -> Ints:
    """What the counts of the search alone tell, at no cost: index [T] into `STOP_REASONS` of rows not reached."""
    timeout_s = None if problem.is_fixed else problem.settings.timeout_s
    stops = np.where(found.counts[:, COLLIDING] > 0, _COLLISION, _BUDGET)
    if problem.collision.obstacles:
        stops[found.pair_counts.blocked_beyond(len(problem.collision.pairs))] = _WORLD
    if timeout_s is not None:
        stops[found.seconds >= timeout_s] = _TIMED_OUT
    stops = np.where(found.is_excluded(), _OUT_OF_REACH, stops)
    return np.where(found.ruled_out >= 0, found.ruled_out, stops)


def reason_from_counts(stop: StopReason, attempts: int, colliding: int, timeout_s: float | None) -> str:
    """One line that says it, of what is not proved to be out of reach."""
    if stop in COLLIDES:
        return f"only colliding solutions found, {colliding} of them"
    if stop is StopReason.TIMED_OUT:
        met = f", {colliding} of them in collision at the target" if colliding else ""
        return f"timed out after {timeout_s:g} s and {_count(attempts)}{met}"
    return f"{_count(attempts)} spent"


def is_proof(reason: str) -> bool:
    """Whether a reason says that there is no solution, proved by branches or by what is fixed to the tool."""
    return reason.startswith(NO_SOLUTION)


def reason_from_proof(stop: StopReason) -> str:
    """One line that says it of a pose that is ruled out."""
    return f"{NO_SOLUTION}: {PROVED[stop]}"


def explain(
    problem: Problem, target: Target, found: SearchState, graded: Grade, *, seed: int, stream: int
) -> Explanation:
    """Explain an unreached target from its counts, proved bounds, and short searches that change one thing."""
    if problem.is_fixed:
        return _explain_fixed(problem, target, found, graded)
    if prove(problem, target) != (0.0, 0.0):
        return explain_reach(problem, target)
    if found.ruled_out[0] >= 0:
        touching = (
            _never_free(problem, _read_counts(problem, found), graded) if found.ruled_out[0] == _COLLISION else None
        )
        return touching or _ruled_out(problem, target, found, graded, seed=seed, stream=stream)
    met, timeout_s = _read_counts(problem, found), problem.settings.timeout_s
    if stop_from_counts(problem, found)[0] == _TIMED_OUT:
        return _timed_out(found, graded, timeout_s, met.blocking)
    probe = Probe(target, seed, stream, float(found.seconds[0]))
    swept = rule_out_by_sweep(problem, target)
    if swept is not None:
        return _swept(problem, target, probe, swept, found, graded)
    return _searched(problem, target, probe, met, found, graded)


def _searched(
    problem: Problem, target: Target, probe: Probe, met: _Met, found: SearchState, graded: Grade
) -> Explanation:
    """What is not proved: what more of the search finds, what always touches, what would help."""
    met, hint = _look_closer(problem, probe, met)
    hint = hint or try_longer(problem, probe)
    if hint:
        return _spent(found, graded, hint)
    return _never_free(problem, met, graded) or _explain_by_remedies(problem, target, probe, met, found, graded)


def _explain_fixed(problem: Problem, target: Target, found: SearchState, graded: Grade) -> Explanation:
    """Where no joint may move all is known: no search, but bounds for joints that would be free."""
    stop = STOP_REASONS[stop_from_counts(problem, found)[0]]
    if stop is StopReason.BUDGET:  # met by the last digit, which the graders see differently
        return _spent(found, graded, None)
    pair = graded.closest_pair if graded.collision else None
    return Explanation(
        stop_reason=stop,
        reason=tell_fixed(float(found.excess_m[0]), float(found.excess_rad[0]), pair),
        hint=hint_at_bounds(problem, target) if prove(problem, target) != (0.0, 0.0) else None,
        blocking_pairs=_read_counts(problem, found).blocking,
    )


def explain_reach(problem: Problem, target: Target) -> Explanation:
    """Why a target is out of reach that a bound has excluded: no search, but bounds for wider ranges."""
    return Explanation(
        stop_reason=StopReason.OUT_OF_REACH,
        reason=tell_out_of_reach(*prove(problem, target)),
        hint=hint_at_bounds(problem, target),
        blocking_pairs={},
    )


def explain_ruled_out(
    problem: Problem, target: Target, *, row: Floats, why: int, seed: int, stream: int
) -> Explanation:
    """Explain what the closed form rules out for the reason of this number, from the row of the best that was found."""
    found, joints = make_search_state(problem, 1), len(problem.lower)
    whole = row[joints + METRICS :].view(np.int64)
    found.q[0], found.counts[0], found.ruled_out[0] = row[:joints], whole[FIRST_COUNT:SCORE], why
    found.pair_counts.filled[0] = whole[BLOCKED:]
    found.pair_counts.keep(0, np.array([0]))
    graded = verify(problem.robot, target, found.q[0], settings=problem.settings, collision=problem.collision)
    return explain(problem, target, found, graded, seed=seed, stream=stream)


def tell_out_of_reach(far_m: float, off_rad: float) -> str:
    """One line for what `prove` has found."""
    words = [f"{at_least(far_m)} m too far"] if far_m > 0.0 else []
    words += [f"{at_least(off_rad)} rad off in orientation"] if off_rad > 0.0 else []
    return f"out of reach: at least {' and '.join(words)}, whatever the joints do"


def _explain_by_remedies(
    problem: Problem, target: Target, probe: Probe, met: _Met, found: SearchState, graded: Grade
) -> Explanation:
    remedy = try_in_world(problem, probe, met.blocking)
    remedy = remedy or try_freeing(problem, probe) or try_widening(problem, probe)
    if met.colliding > 0:
        return _colliding(problem, met, graded, remedy)
    if remedy:
        reason = f"no solution inside the joint ranges found in {_count(found.counts[0, ATTEMPTS])}; {_best(graded)}"
        return Explanation(stop_reason=StopReason.LIMITS, reason=reason, hint=remedy, blocking_pairs={})
    return _spent(found, graded, hint_at_tolerance(problem, target, found.q[0], graded))


def _never_free(problem: Problem, met: _Met, graded: Grade) -> Explanation | None:
    """That some pairs touch in every configuration, if they do."""
    touching = find_always_touching(problem.collision.own)
    if touching is None:
        return None
    lines = f": {' and '.join(touching.lines)}" if touching.lines else ""
    is_met = graded.within_tolerance and not graded.outside_limits
    is_enough = is_met and set(graded.colliding_pairs) <= set(touching.pairs)
    hint = "these pairs left out: a solution was found that touches in no others"
    return Explanation(
        stop_reason=StopReason.COLLISION,
        reason=f"{touching}; if that is meant, {touching.remedy}{lines}",
        hint=hint if is_enough else None,
        blocking_pairs=met.blocking,
    )


def _ruled_out(
    problem: Problem, target: Target, found: SearchState, graded: Grade, *, seed: int, stream: int
) -> Explanation:
    """What the closed form proves, or the tool's body; what would help."""
    probe = Probe(target, seed, stream, float(found.seconds[0]))
    is_by_branches = rule_out_by_branches(problem, Targets.of([target]))[0] >= 0
    reason, blocking = (tell_branches if is_by_branches else tell_tool_body)(problem, target)
    hint = try_in_world(problem, probe, blocking) or try_freeing(problem, probe)
    hint = hint or (hint_at_branches(problem, target) if is_by_branches else None)
    hint = hint or hint_at_tolerance(problem, target, found.q[0], graded)
    stop = STOP_REASONS[found.ruled_out[0]]
    return Explanation(stop_reason=stop, reason=reason, hint=hint, blocking_pairs=blocking)


def _swept(
    problem: Problem, target: Target, probe: Probe, swept: Swept, found: SearchState, graded: Grade
) -> Explanation:
    """What the sweep of the joint that carries the arm proves; what would help."""
    hint = try_in_world(problem, probe, swept.blocking) or try_freeing(problem, probe) or try_widening(problem, probe)
    return Explanation(
        stop_reason=swept.stop_reason,
        reason=tell_sweep(problem.robot, swept),
        hint=hint or hint_at_tolerance(problem, target, found.q[0], graded),
        blocking_pairs=swept.blocking,
    )


def _colliding(problem: Problem, met: _Met, graded: Grade, remedy: str | None) -> Explanation:
    own, stop = set(problem.collision.pairs), StopReason.COLLISION
    if not met.blocking.keys() <= own:
        stop = StopReason.WORLD
    worst = ", ".join(_tell_blocker(pair, pair in own, met, graded) for pair in list(met.blocking)[:3])
    collisions = f"{met.colliding} met the target, each in collision; blocked by {worst}"
    return Explanation(
        stop_reason=stop,
        reason=f"only colliding solutions found: {collisions}",
        hint=remedy,
        blocking_pairs=met.blocking,
    )


def _tell_blocker(pair: tuple[str, str], is_own: bool, met: _Met, graded: Grade) -> str:
    """Two components, or an obstacle and what touches it: most often if that was counted, else in the best answer."""
    count = f"{met.blocking[pair]} of {met.colliding}"
    if is_own:
        return f"{'-'.join(pair)} ({count})"
    name = pair[1]
    if name in met.often:
        return f"{name} ({count}, most often {met.often[name]})"
    best = [a for a, b in graded.colliding_pairs if b == name]
    return f"{name} ({count}{f', the best by {best[0]}' if best else ''})"


def _spent(found: SearchState, graded: Grade, hint: str | None) -> Explanation:
    reason = f"{_count(int(found.counts[0, ATTEMPTS]))} spent; {_best(graded)}"
    return Explanation(stop_reason=StopReason.BUDGET, reason=reason, hint=hint, blocking_pairs={})


def _timed_out(
    found: SearchState, graded: Grade, timeout_s: float | None, blocking: Mapping[tuple[str, str], int]
) -> Explanation:
    attempts, colliding = found.counts[0, [ATTEMPTS, COLLIDING]].tolist()
    reason = reason_from_counts(StopReason.TIMED_OUT, attempts, colliding, timeout_s)
    return Explanation(
        stop_reason=StopReason.TIMED_OUT, reason=f"{reason}; {_best(graded)}", hint=MORE_TIME, blocking_pairs=blocking
    )


def _count(attempts: int) -> str:
    return f"{attempts} attempt{'s' if attempts != 1 else ''}"


def _best(graded: Grade) -> str:
    return f"the best is off by {graded.position_error_m:.3g} m and {graded.orientation_error_rad:.3g} rad"


def _read_counts(problem: Problem, found: SearchState) -> _Met:
    pairs = problem.collision.counted
    return _Met(int(found.counts[0, COLLIDING]), count_blocking_pairs(pairs, found.pair_counts.row(0)))


def _look_closer(problem: Problem, probe: Probe, met: _Met) -> tuple[_Met, str | None]:
    """Collisions counted pair by pair, where the search did not; and what helps, if that finds a solution."""
    if ENGINES[problem.settings.engines[-1]].counts_all_pairs:
        if met.colliding > 0 or not problem.collision.pairs or problem.settings.evolution.collision == "reject":
            return met, None
        rejecting = problem.with_settings(de={"collision": "reject"})
        tested = probe.run(rejecting)
        hint = "collision reject: a solution was found by testing the best of each population only"
        return _read_counts(problem, tested), hint if probe.confirms(rejecting, tested) else None
    if met.colliding == 0 or problem.settings.timeout_s is not None:
        return met, None
    often = _search_often(problem, probe)
    counted = _count_pairs(problem, often)
    return counted if counted.colliding else met, hint_at_stream(problem, probe.target, often)


def _search_often(problem: Problem, probe: Probe) -> SearchState:
    """One attempt on each of many streams; attempt 0 with `near` is `near` itself, on every stream.

    Under `auto` of `lm` alone, if that meets the target: 64 populations of `memetic` take a second.
    """
    begin = 0 if problem.near is None else 1
    lanes = {"seed": probe.seed, "streams": range(COUNTED), "first_attempt": begin, "attempts": 1}
    if len(problem.settings.engines) > 1:
        found = search(problem.with_settings(method="lm"), [probe.target] * COUNTED, **lanes)
        if (found.score[:, 0] == 0.0).any():
            return found
    return search(problem, [probe.target] * COUNTED, **lanes)


def _count_pairs(problem: Problem, found: SearchState) -> _Met:
    met = found.q[(found.score[:, 0] == 0.0) & (found.counts[:, REACHED] == 0)]
    collision = problem.collision
    if not collision.pairs or not len(met):
        return _Met(0, {})
    touching = compute_gaps(collision, met) <= collision.limit_m
    blocking = count_blocking_pairs(collision.counted, collision.fold(touching).sum(axis=0))
    return _Met(len(met), blocking, _find_often(collision, touching))


def _find_often(collision: CollisionModel, touching: Bools) -> dict[str, str]:
    """The component that touches each obstacle most often, of flags [K, P + C O]."""
    if not collision.obstacles:
        return {}
    counts = touching[:, len(collision.pairs) :].sum(axis=0).reshape(len(collision.components), -1)
    most = zip(collision.obstacles, counts.argmax(axis=0).tolist(), counts.any(axis=0).tolist(), strict=True)
    return {obstacle.name: collision.components[place] for obstacle, place, is_any in most if is_any}
