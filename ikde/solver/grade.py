"""Grade and explain what the kernels found: the verdict is plain numpy's alone, on exactly the returned q."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ikde.errors import VerificationError
from ikde.model.target import Target
from ikde.solver.explain import Explanation, count_blocking_pairs, explain, explain_from_counts
from ikde.solver.figures import AGREEMENT, Figures, compute_disagreement, compute_figures
from ikde.solver.problem import Problem
from ikde.solver.result import StopReason
from ikde.solver.search import Found
from ikde.solver.verify import Bools, Verdicts, verify_many


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Graded:
    """Both grades of T rows, whether they agree, and the story of each row."""

    figures: Figures
    verdicts: Verdicts
    verified: Bools  # [T]
    explanations: tuple[Explanation, ...]


def grade(problem: Problem, targets: Sequence[Target], found: Found, *, seed: int, strict: bool, probe: bool) -> Graded:
    """Grade every row of `found`.

    `strict` raises `VerificationError` where kernels and plain numpy disagree; else the row is marked. `probe` lets the
    explanation of a failure make short searches.
    """
    figures = compute_figures(problem.robot, problem.detector, targets, found.q)
    verdicts = verify_many(problem.robot, targets, found.q, problem.settings, problem.detector)
    gaps = compute_disagreement(targets, figures, verdicts)
    verified = gaps <= AGREEMENT  # False for NaN
    if strict and not verified.all():
        worst = int(np.argmin(verified))
        raise VerificationError(f"kernels and verify disagree by {gaps[worst]:.3g} on q = {found.q[worst].tolist()}")
    stories = []
    for row, target in enumerate(targets):
        if not verified[row]:
            stories.append(_unverified(float(gaps[row])))
        elif verdicts.accepted[row]:
            stories.append(_reached(problem, found.row(row)))
        elif probe:
            stories.append(explain(problem, target, found.row(row), verdicts.row(row), seed))
        else:
            stories.append(explain_from_counts(problem, found.row(row)))
    return Graded(figures=figures, verdicts=verdicts, verified=verified, explanations=tuple(stories))


def _unverified(gap: float) -> Explanation:
    reason = f"kernels and verify disagree by {gap:.3g}: a bug, please report it"
    return Explanation(stop_reason=StopReason.UNVERIFIED, reason=reason, hint=None, blocking_pairs={})


def _reached(problem: Problem, found: Found) -> Explanation:
    free = "free of self-collision" if problem.detector else "self-collision not looked at"
    return Explanation(
        stop_reason=StopReason.REACHED,
        reason=f"within tolerance, inside the limits, {free}",
        hint=None,
        blocking_pairs=count_blocking_pairs(problem, found.pair_counts[0]),
    )
