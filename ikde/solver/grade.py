"""Grade and explain what the kernels found, on exactly the returned q.

The metrics and the verdict of every row are the kernels' grader's (`kernels/grade_many.py`); plain numpy grades again,
every row or a sample, and must agree to 1e-11. What each shares with the search stands in docs/design.md.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ikde.errors import VerificationError
from ikde.kernels.arrays import Floats, Ints
from ikde.model.robot import Robot
from ikde.model.target import Targets
from ikde.solver.engines.search_state import SearchState
from ikde.solver.explain import Explanation, explain, stop_from_counts
from ikde.solver.metrics import AGREEMENT, Metrics, compute_disagreement, judge_clearances, measure_scale
from ikde.solver.problem import Problem
from ikde.solver.result import STOP_REASONS, SolveResult, StopReason
from ikde.solver.settings import BulkOptions
from ikde.solver.verify import Bools, MaskedBools, verify_many

SPLIT = "met by the last digit: rounding takes it across a tolerance or the safe distance for one of the two graders"
SAMPLE = 64  # one stream in so many, wherever a batch is cut


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Outcomes:
    """The grades of T rows, whether they agree, and why rows ended."""

    metrics: Metrics
    collision: MaskedBools
    """[T] masked where it was not checked."""
    verified: MaskedBools
    """[T] whether plain numpy agrees; masked where it was not asked."""
    reached: Bools
    """[T] accepted by every grader that graded it, and none disagrees."""
    stop_reasons: Ints
    """[T] index into `STOP_REASONS`."""
    explanations: Mapping[int, Explanation]
    """Row -> why, of rows that were explained; the others have their counts."""


def grade(
    problem: Problem,
    targets: Targets,
    found: SearchState,
    bulk: BulkOptions,
    *,
    seed: int,
    first_stream: int = 0,
    strict: bool = False,
) -> Outcomes:
    """Grade every row of `found`.

    Args:
        problem: robot, collision model, settings and ranges.
        targets: one a row.
        found: the rows.
        bulk: which rows plain numpy grades, and whether failures are explained, by short searches.
        seed: of the probes.
        first_stream: stream of the first row.
        strict: raise `VerificationError` where the graders disagree; else the row is marked.
    """
    metrics = found.metrics
    streams = np.arange(first_stream, first_stream + len(targets))
    rows = np.flatnonzero(_choose(bulk, streams) | (~metrics.accepted if bulk.explain else False))
    verified = np.ma.masked_array(np.zeros(len(targets), dtype=bool), mask=True)
    reached = metrics.accepted.copy()
    explanations: dict[int, Explanation] = {}
    if rows.size:
        asked, Q = targets.take(rows), found.q[rows]
        verdicts = verify_many(problem.collision, asked, Q, problem.settings)
        gaps = compute_disagreement(asked, metrics.take(rows), verdicts)
        if strict:
            _refuse(gaps, Q)
        verified[rows] = agrees = gaps <= AGREEMENT  # False for NaN
        reached[rows] &= agrees & verdicts.accepted
        explanations = {int(rows[place]): _unverified(gaps[place]) for place in np.flatnonzero(~agrees)}
        if bulk.explain:
            for place in np.flatnonzero(agrees & ~reached[rows]).tolist():
                row, graded = int(rows[place]), verdicts.row(place)
                explanations[row] = explain(
                    problem, targets[row], found.row(row), graded, seed=seed, stream=int(streams[row])
                )
    return Outcomes(
        metrics=metrics,
        collision=judge_clearances(metrics, problem.collision),
        verified=verified,
        reached=reached,
        stop_reasons=_stop_reasons(problem, found, reached, explanations),
        explanations=explanations,
    )


def confirm(robot: Robot, result: SolveResult) -> SolveResult:
    """The result, verified; raises `VerificationError` if plain numpy does not see on its `q` what it says."""
    plain, scale = result.grade, measure_scale(robot, result.target.p_world_tool[None], result.q[None])[0]
    names = ["position_error_m", "orientation_error_rad", *(["clearance_m"] if result.clearance_m is not None else [])]
    gap = float(np.max([abs(getattr(result, name) - getattr(plain, name)) for name in names]) / scale)  # keeps NaN
    if not gap <= AGREEMENT or (result.reached and plain.outside_limits):
        raise _disagreement(gap, result.q)
    split = {"reached": False, "stop_reason": StopReason.BUDGET, "reason": SPLIT, "hint": None}
    return result.with_changes(verified=True, grade=plain, **(split if result.reached and not plain.accepted else {}))


def _choose(bulk: BulkOptions, streams: Ints) -> Bools:
    """Which rows plain numpy grades [T]: the sample depends on the streams, not on where a batch is cut."""
    return {"all": streams >= 0, "sample": streams % SAMPLE == 0, "none": streams < 0}[bulk.verify]


def _refuse(gaps: Floats, Q: Floats) -> None:
    agree = gaps <= AGREEMENT
    if not agree.all():
        worst = int(np.argmin(agree))
        raise _disagreement(gaps[worst], Q[worst])


def _disagreement(gap: float, q: Floats) -> VerificationError:
    return VerificationError(f"kernels and verify disagree by {gap:.3g} on q = {q.tolist()}")


def _stop_reasons(
    problem: Problem, found: SearchState, reached: Bools, explanations: Mapping[int, Explanation]
) -> Ints:
    unreached = stop_from_counts(problem, found)
    codes = np.where(reached, STOP_REASONS.index(StopReason.REACHED), unreached)
    for row, story in explanations.items():
        codes[row] = STOP_REASONS.index(story.stop_reason)
    return codes


def _unverified(gap: float) -> Explanation:
    reason = f"kernels and verify disagree by {gap:.3g}: a bug, please report it"
    return Explanation(stop_reason=StopReason.UNVERIFIED, reason=reason, hint=None, blocking_pairs={})
