"""Grade and explain what the kernels found, on exactly the returned q.

The figures and the verdict of every row are those of a grader that shares no code with what searches; plain numpy
grades again, every row or a sample, and must agree to 1e-11.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from ikde.errors import InputError, VerificationError
from ikde.kernels.arrays import Floats, Ints
from ikde.model.robot import Robot
from ikde.model.target import Targets
from ikde.solver.engines.found import Found
from ikde.solver.explain import Explanation, explain, stop_from_counts
from ikde.solver.figures import AGREEMENT, Figures, compute_disagreement, compute_figures, measure_scale
from ikde.solver.problem import Problem
from ikde.solver.result import STOP_REASONS, SolveResult, StopReason
from ikde.solver.verify import Bools, verify_many

Verify = Literal["all", "sample", "none"]
SAMPLE = 64  # one stream in so many, wherever a batch is cut


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Graded:
    """The grades of T rows, whether they agree, and why rows ended."""

    figures: Figures
    verified: Bools
    """[T] False where plain numpy disagrees."""
    reached: Bools
    """[T] accepted by all who graded it, and verified."""
    stop_reasons: Ints
    """[T] index into `STOP_REASONS`."""
    explanations: Mapping[int, Explanation]
    """Row -> why, of rows that were looked into; counts tell of the others."""


def grade(
    problem: Problem,
    targets: Targets,
    found: Found,
    *,
    seed: int,
    first_stream: int = 0,
    strict: bool,
    probe: bool,
    verify: Verify = "all",
) -> Graded:
    """Grade every row of `found`.

    Args:
        problem: robot, detector, settings and ranges.
        targets: one a row.
        found: the rows.
        seed: of the probes.
        first_stream: stream of the first row.
        strict: raise `VerificationError` where the graders disagree; else the row is marked.
        probe: look into failures by short searches. Plain numpy grades them first.
        verify: which rows plain numpy grades: `"all"`, one stream in 64, or those that are looked into.
    """
    figures = compute_figures(problem.robot, problem.detector, targets, found.q, problem.settings)
    streams = np.arange(first_stream, first_stream + len(targets))
    rows = np.flatnonzero(_choose(verify, streams) | (~figures.accepted if probe else False))
    verified, reached = np.ones(len(targets), dtype=bool), figures.accepted
    explanations: dict[int, Explanation] = {}
    if rows.size:
        asked, Q = targets.take(rows), found.q[rows]
        verdicts = verify_many(problem.robot, asked, Q, problem.settings, problem.detector)
        gaps = compute_disagreement(asked, figures.take(rows), verdicts)
        if strict:
            _refuse(gaps, Q)
        verified[rows] = gaps <= AGREEMENT  # False for NaN
        reached = figures.accepted & verified
        reached[rows] &= verdicts.accepted
        told = zip(rows.tolist(), gaps.tolist(), strict=True)
        explanations = {row: _unverified(gap) for row, gap in told if not verified[row]}
        if probe:
            for place in np.flatnonzero((verified & ~reached)[rows]).tolist():
                row, graded = int(rows[place]), verdicts.row(place)
                explanations[row] = explain(
                    problem, targets[row], found.row(row), graded, seed=seed, stream=int(streams[row])
                )
    return Graded(
        figures=figures,
        verified=verified,
        reached=reached,
        stop_reasons=_stop_reasons(problem, found, reached, explanations),
        explanations=explanations,
    )


def confirm(robot: Robot, result: SolveResult) -> SolveResult:
    """The result itself; raises `VerificationError` if plain numpy does not see on its `q` what it says."""
    plain, scale = result.verification, measure_scale(robot, result.target.p_world_tool[None], result.q[None])[0]
    names = ["position_error_m", "orientation_error_rad", *(["clearance_m"] if result.clearance_m is not None else [])]
    gap = float(np.max([abs(getattr(result, name) - getattr(plain, name)) for name in names]) / scale)  # keeps NaN
    if not (gap <= AGREEMENT and (plain.accepted or not result.reached)):
        raise _disagreement(gap, result.q)
    return result


def _choose(verify: Verify, streams: Ints) -> Bools:
    """Which rows plain numpy grades [T]: the sample depends on the streams, not on where a batch is cut."""
    if verify not in get_args(Verify):
        raise InputError(f"expected one of {', '.join(get_args(Verify))}, got {verify!r}", ("verify",))
    return {"all": streams >= 0, "sample": streams % SAMPLE == 0, "none": streams < 0}[verify]


def _refuse(gaps: Floats, Q: Floats) -> None:
    agree = gaps <= AGREEMENT
    if not agree.all():
        worst = int(np.argmin(agree))
        raise _disagreement(gaps[worst], Q[worst])


def _disagreement(gap: float, q: Floats) -> VerificationError:
    return VerificationError(f"kernels and verify disagree by {gap:.3g} on q = {q.tolist()}")


def _stop_reasons(problem: Problem, found: Found, reached: Bools, explanations: Mapping[int, Explanation]) -> Ints:
    unreached = stop_from_counts(found, problem.settings.timeout_s)
    codes = np.where(reached, STOP_REASONS.index(StopReason.REACHED), unreached)
    for row, story in explanations.items():
        codes[row] = STOP_REASONS.index(story.stop_reason)
    return codes


def _unverified(gap: float) -> Explanation:
    reason = f"kernels and verify disagree by {gap:.3g}: a bug, please report it"
    return Explanation(stop_reason=StopReason.UNVERIFIED, reason=reason, hint=None, blocking_pairs={})
