"""Grade and explain what the kernels found, on exactly the returned q.

The metrics and the verdict of every row are the kernels' grader's (`kernels/grade_many.py`); plain numpy grades again,
every row or a sample, and must agree to 1e-11. What each shares with the search stands in docs/design.md.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ikde.errors import VerificationError
from ikde.kernels.arrays import Floats, Ints, read_only
from ikde.model.robot import Robot
from ikde.model.target import Targets
from ikde.model.value import MadeAnew
from ikde.solver.engines.search_state import SearchState
from ikde.solver.explain import Explanation, explain, stop_from_counts
from ikde.solver.metrics import AGREEMENT, Metrics, compute_disagreement, judge_clearances, measure_scale
from ikde.solver.problem import Problem
from ikde.solver.result import STOP_REASONS, SolveResult, StopReason, change_result
from ikde.solver.settings import BulkOptions
from ikde.solver.verify import Bools, Grade, MaskedBools, verify_many

SPLIT = "met by the last digit: rounding takes it across a tolerance or the safe distance for one of the two graders"
BLOCK, SAMPLED = 4096, 64  # the last 64 streams of each 4096, wherever a batch is cut: few calls of numpy, full ones
AT_ONCE = 256  # rows that plain numpy grades in a call: 11 us each (qiao2021); 38 with 16 of them


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Outcomes(MadeAnew):
    """The grades of T rows, whether they agree, and why rows ended."""

    problem: Problem
    found: SearchState
    verdicts: Bools
    """[T] whether plain numpy agrees; False where it was not asked."""
    asked: Bools
    """[T] whether it was."""
    reached: Bools
    """[T] accepted by every grader that graded it, and none disagrees."""
    explanations: Mapping[int, Explanation]
    """Row -> why, of rows that were explained; the others have their counts."""

    @property
    def metrics(self) -> Metrics:
        """By the kernels' grader."""
        return self.found.metrics

    def take(self, rows: Ints, found: SearchState) -> "Outcomes":
        """Those of some rows [K], which `found` has."""
        kept = {place: self.explanations[row] for place, row in enumerate(rows.tolist()) if row in self.explanations}
        columns = {name: getattr(self, name)[rows] for name in ("verdicts", "asked", "reached")}
        return Outcomes(problem=self.problem, found=found, explanations=kept, **columns)

    @cached_property
    def collision(self) -> MaskedBools:
        """Whether each row collides [T]; masked where it was not checked."""
        return judge_clearances(self.metrics, self.problem.collision)

    @cached_property
    def verified(self) -> MaskedBools:
        """Whether plain numpy agrees [T]; masked where it was not asked."""
        return np.ma.masked_array(self.verdicts, mask=read_only(~self.asked))

    @cached_property
    def stop_reasons(self) -> Ints:
        """Index [T] into `STOP_REASONS`."""
        unreached = stop_from_counts(self.problem, self.found)
        codes = np.where(self.reached, STOP_REASONS.index(StopReason.REACHED), unreached)
        for row, story in self.explanations.items():
            codes[row] = STOP_REASONS.index(story.stop_reason)
        return read_only(codes)


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
    metrics, T = found.metrics, len(targets)
    asked, verdicts, reached = np.zeros(T, dtype=bool), np.zeros(T, dtype=bool), metrics.accepted.copy()
    explanations: dict[int, Explanation] = {}
    rows = _choose(bulk, first_stream, metrics.accepted)
    graded: dict[int, Grade] = {}

    for first in range(0, len(rows), AT_ONCE):  # on one thread: two, which wait for Python's lock, take twice as long
        some = rows[first : first + AT_ONCE]
        grades = verify_many(problem.collision, targets.take(some), found.q[some], problem.settings)
        gaps = compute_disagreement(targets.take(some), metrics.take(some), grades)
        if strict:
            _refuse(gaps, found.q[some])
        asked[some], verdicts[some] = True, gaps <= AGREEMENT  # False for NaN
        reached[some] &= verdicts[some] & grades.accepted
        explanations.update({int(some[place]): _unverified(gaps[place]) for place in np.flatnonzero(~verdicts[some])})
        if bulk.explain:
            graded.update({int(some[place]): grades.row(place) for place in np.flatnonzero(~reached[some]).tolist()})

    for row in sorted(graded.keys() - explanations.keys()):
        lane = {"seed": seed, "stream": first_stream + row}
        explanations[row] = explain(problem, targets[row], found.row(row), graded[row], **lane)
    return Outcomes(
        problem=problem,
        found=found,
        verdicts=verdicts,
        asked=asked,
        reached=reached,
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
    return change_result(result, verified=True, grade=plain, **(split if result.reached and not plain.accepted else {}))


def _choose(bulk: BulkOptions, first_stream: int, accepted: Bools) -> Ints:
    """Rows that plain numpy grades: the sample depends on the streams, not on where a batch is cut."""
    if bulk.verify == "all":
        return np.arange(len(accepted))
    chosen = ~accepted if bulk.explain else np.zeros(len(accepted), dtype=bool)
    if bulk.verify == "sample" and first_stream % BLOCK + len(accepted) > BLOCK - SAMPLED:
        chosen |= np.arange(first_stream, first_stream + len(accepted)) % BLOCK >= BLOCK - SAMPLED
    return chosen.nonzero()[0]


def _refuse(gaps: Floats, Q: Floats) -> None:
    agree = gaps <= AGREEMENT
    if not agree.all():
        worst = int(np.argmin(agree))
        raise _disagreement(gaps[worst], Q[worst])


def _disagreement(gap: float, q: Floats) -> VerificationError:
    return VerificationError(f"kernels and verify disagree by {gap:.3g} on q = {q.tolist()}")


def _unverified(gap: float) -> Explanation:
    reason = f"kernels and verify disagree by {gap:.3g}: a bug, please report it"
    return Explanation(stop_reason=StopReason.UNVERIFIED, reason=reason, hint=None, blocking_pairs={})
