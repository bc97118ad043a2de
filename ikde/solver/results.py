"""Many solves at once, a row each: searched on all cores, graded, explained."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields, replace
from functools import lru_cache, partial
from typing import Any, overload

import numpy as np

from ikde.errors import InputError
from ikde.kernels.answer import pack_row
from ikde.kernels.arrays import ATTEMPTS, COLLIDING, EVALUATIONS, Floats, Ints, read_only
from ikde.model.large_worlds import KEPT
from ikde.model.target import KINDS, Target, Targets
from ikde.model.value import MadeAnew
from ikde.solver.compile_note import name_work, note_compile
from ikde.solver.engine_table import NAMES
from ikde.solver.engines.search_state import SearchState
from ikde.solver.explain import Explanation, reason_from_counts, reason_from_proof, tell_out_of_reach
from ikde.solver.fixed import tell_fixed
from ikde.solver.grade import Outcomes, grade
from ikde.solver.motion import measure_motion
from ikde.solver.problem import Problem
from ikde.solver.result import (
    STOP_REASONS,
    ResultMaker,
    SolveResult,
    StopReason,
    change_result,
    count_blocking_pairs,
    reached_reason,
)
from ikde.solver.search import search
from ikde.solver.settings import BulkOptions
from ikde.solver.verify import Bools, MaskedBools

MEASURED = ("position_error_m", "orientation_error_rad", "clearance_m")
EVERY_ROW = BulkOptions(verify="all")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SolveResults(MadeAnew):
    """Finished searches, a sequence of `SolveResult`: row k belongs to target k. Its columns are arrays."""

    problem: Problem
    targets: Targets
    seed: int
    streams: Sequence[int]
    """Which random stream of the seed each row has."""
    found: SearchState
    outcomes: Outcomes
    compile_seconds: float
    singles: tuple[SolveResult, ...] | None = None
    """The rows as they are, where some goals are regions: each target is the exact pose that was drawn; else None."""

    @property
    def q(self) -> Floats:
        """Joint values [T, N] in the robot's own convention, m and rad."""
        return self.found.q

    @property
    def reached(self) -> Bools:
        """Within tolerance, inside the limits, and free of self-collision where that was checked [T].

        The kernels' grader decides; where plain numpy graded as well (`verified`) both must accept.
        """
        return self.outcomes.reached

    @property
    def collision(self) -> MaskedBools:
        """True where the clearance is not above the safe distance [T]; masked without a detector: not checked."""
        return self.outcomes.collision

    @property
    def verified(self) -> MaskedBools:
        """True where plain numpy agrees to 1e-11, False where it does not [T]; masked where it was not asked."""
        return self.outcomes.verified

    @property
    def stop_reasons(self) -> Ints:
        """Why each search ended [T]: index into `solver.result.STOP_REASONS`."""
        return self.outcomes.stop_reasons

    @property
    def position_error_m(self) -> Floats:
        """Distance of the tool from its target [T], m."""
        return self.outcomes.metrics.position_error_m

    @property
    def orientation_error_rad(self) -> Floats:
        """Rotation-vector norm between tool and target [T], rad."""
        return self.outcomes.metrics.orientation_error_rad

    @property
    def motion(self) -> Floats:
        """How far each row is from `near`, else from home [T]: sqrt(sum (w_j dq_j)^2), by the problem's weights."""
        return measure_motion(self.problem.weights, self.problem.centre, self.q)

    @property
    def clearance_m(self) -> Floats:
        """Distance - R_i - R_j of the closest pair [T], m; inf without a pair."""
        metrics = self.outcomes.metrics
        return self.problem.collision.clearances_m(metrics.clearance_m, metrics.closest_pair)

    @property
    def closest_pair(self) -> Ints:
        """Index of the pair that the clearance lies between [T], into `problem.collision.all_pairs`; -1 without one."""
        return self.outcomes.metrics.closest_pair

    @property
    def attempts(self) -> Ints:
        """Starts made [T]: populations, seeds, or places of the base."""
        return self.found.counts[:, ATTEMPTS]

    @property
    def evaluations(self) -> Ints:
        """Forward kinematics with pose error [T]."""
        return self.found.counts[:, EVALUATIONS]

    @property
    def rejected(self) -> Ints:
        """Attempts that met the pose but collided [T]."""
        return self.found.counts[:, COLLIDING]

    @property
    def engines(self) -> Ints:
        """Which engine answered [T]: its place in `engine_table.NAMES`."""
        return self.found.engine

    @property
    def alternatives(self) -> Ints:
        """Which part of its region each row has reached, or tried last [T]; -1 for exact targets."""
        known = [None] * len(self) if self.singles is None else [result.alternative for result in self.singles]
        return read_only(np.array([-1 if place is None else place for place in known], dtype=np.int64))

    def __post_init__(self) -> None:
        """What was graded stays what it is: no column can be written to by mistake."""
        for known in (self.found, self.found.metrics, self.outcomes):
            for column in (getattr(known, field.name) for field in fields(known)):
                if isinstance(column, np.ndarray):
                    read_only(column)

    def __len__(self) -> int:
        return len(self.targets)

    def __iter__(self) -> Iterator[SolveResult]:
        return (self[index] for index in range(len(self)))

    @overload
    def __getitem__(self, index: int) -> SolveResult: ...

    @overload
    def __getitem__(self, index: slice | Sequence[int] | Ints | Bools) -> "SolveResults": ...

    def __getitem__(self, index: Any) -> "SolveResult | SolveResults":
        count = len(self)
        if isinstance(index, bool) or not isinstance(index, int | np.integer):
            return self._take(read_rows(index, count))
        if not -count <= index < count:
            raise IndexError(f"row {index} of {count}")
        return self.row(int(index) % count)

    def __repr__(self) -> str:
        return f"<SolveResults: {len(self)} rows, {int(self.reached.sum())} reached by {self.problem.robot.name}>"

    def to_arrow(self) -> Any:
        """A `pyarrow.Table`, a row a target: seed, stream, method, and the columns of a batch."""
        from ikde.solver.columns import tabulate

        return tabulate(self)

    def to_pandas(self) -> Any:
        """The same as a `pandas.DataFrame`; raises `InputError` without pandas."""
        try:
            return self.to_arrow().to_pandas()
        except ImportError:
            raise InputError("to_pandas needs pandas: install it, or use to_arrow") from None

    def _take(self, rows: Ints) -> "SolveResults":
        found = self.found.take(rows)
        outcomes, streams = self.outcomes.take(rows, found), tuple(self.streams[row] for row in rows.tolist())
        singles = None if self.singles is None else tuple(self.singles[row] for row in rows.tolist())
        known = {"streams": streams, "found": found, "outcomes": outcomes, "singles": singles}
        return replace(self, targets=self.targets.take(rows), **known)

    def reason(self, index: int) -> str:
        """One line: what happened in this row."""
        if index in self.outcomes.explanations:
            return self.outcomes.explanations[index].reason
        stop = STOP_REASONS[self.stop_reasons[index]]
        if stop is StopReason.REACHED:
            return reached_reason(self.problem.collision)
        excess = float(self.found.excess_m[index]), float(self.found.excess_rad[index])
        if self.problem.is_fixed and stop is not StopReason.BUDGET:
            closest = self.problem.collision.name_pair(self.closest_pair[index]) if self.collision[index] else None
            return tell_fixed(*excess, closest)
        if self.found.ruled_out[index] >= 0:
            return reason_from_proof(stop)
        if stop is StopReason.OUT_OF_REACH:
            return tell_out_of_reach(*excess)
        counts = int(self.attempts[index]), int(self.rejected[index])
        return reason_from_counts(stop, *counts, self.problem.settings.timeout_s)

    def explanation(self, index: int) -> Explanation:
        """Why, and what would help: of a row that was not explained what its counts say, made now."""
        if index in self.outcomes.explanations:
            return self.outcomes.explanations[index]
        return Explanation(
            stop_reason=STOP_REASONS[self.stop_reasons[index]],
            reason=self.reason(index),
            hint=None,
            blocking_pairs=count_blocking_pairs(self.problem.collision.counted, self.found.pair_counts.row(index)),
        )

    def row(self, index: int) -> SolveResult:
        """One row with everything known about it."""
        if self.singles is not None:
            return self.singles[index]
        outcomes, metrics, found = self.outcomes, self.outcomes.metrics, self.found
        measured = [getattr(metrics, name)[index] for name in MEASURED]
        blocked = found.pair_counts.row(index)
        row = pack_row(found.q[index], measured, metrics.closest_pair[index], found.counts[index], blocked)
        lane = self.targets[index], self.seed, self.streams[index], float(found.seconds[index])
        result = _find_maker(self.problem, NAMES[found.engine[index]]).make(row, *lane)
        own: dict[str, Any] = {"compile_seconds": self.compile_seconds}
        if outcomes.asked[index]:
            own["verified"] = bool(outcomes.verdicts[index])
        if not outcomes.reached[index]:
            story = self.explanation(index)
            own |= {name: getattr(story, name) for name in ("stop_reason", "reason", "hint", "blocking_pairs")}
            own |= {"reached": False}
        return change_result(result, **own)


def read_rows(index: Any, count: int) -> Ints:
    """Places [K] of what a slice, a mask [T] (what is masked in it is False) or an array of places chooses.

    Raises:
        IndexError: for what is none.
    """
    if isinstance(index, slice):
        return np.arange(count)[index]
    if isinstance(index, np.ma.MaskedArray):
        if index.dtype != np.bool_ and np.ma.is_masked(index):
            raise IndexError("expected places, but some are masked")
        index = np.ma.filled(index, False)
    try:
        chosen: Any = np.asarray(index)
    except ValueError:  # lists of several lengths
        chosen = np.empty((0, 0))
    if chosen.dtype == np.bool_ and chosen.shape != (count,):
        raise IndexError(f"expected a mask of {count} rows, got shape {chosen.shape}")
    if chosen.ndim != 1 or (chosen.dtype.kind not in "biu" and chosen.size):
        raise IndexError("expected a place, a slice, a mask or an array of places")
    return np.arange(count)[chosen.astype(np.int64) if not chosen.size and chosen.dtype.kind == "f" else chosen]


@KEPT.add
@lru_cache(maxsize=64)
def _find_maker(problem: Problem, method: str) -> ResultMaker:
    """What all rows of a problem share is made once."""
    return ResultMaker(problem, method)


def _name_work(problem: Problem, targets: Targets) -> str:
    kinds = [kind for index, kind in enumerate(KINDS) if index in targets.kind]
    return name_work(f"{' and '.join(kinds)} targets", problem.collision)


def solve_rows(
    problem: Problem,
    targets: Targets | Sequence[Target],
    bulk: BulkOptions = EVERY_ROW,
    *,
    seed: int,
    first_stream: int = 0,
    first_attempt: int = 0,
    strict: bool = False,
    spent_s: float = 0.0,
) -> SolveResults:
    """Solve targets, a lane each on all threads; target k searches the stream (seed, first_stream + k).

    Args:
        problem: robot, collision model, settings and ranges.
        targets: what the tool is asked to do.
        bulk: threads, and what is verified and explained.
        seed: same seed, same bits.
        first_stream: stream of the first target.
        first_attempt: where in its stream each search begins.
        strict: raise where the graders disagree, instead of recording it.
        spent_s: what is gone of each target's time, if the settings have a timeout.

    Raises:
        VerificationError: with `strict`, for a disagreement of more than 1e-11: a bug.
    """
    targets = Targets.of(targets)
    where = {"seed": seed, "streams": range(first_stream, first_stream + len(targets)), "first_attempt": first_attempt}
    with note_compile(partial(_name_work, problem, targets)) as clock:
        found = search(problem, targets, threads=bulk.threads, spent_s=spent_s, **where)
        outcomes = grade(problem, targets, found, bulk, seed=seed, first_stream=first_stream, strict=strict)
    return SolveResults(
        problem=problem,
        targets=targets,
        seed=seed,
        streams=where["streams"],
        found=found,
        outcomes=outcomes,
        compile_seconds=clock.seconds,
    )
