"""Many goals of which some have freedom, as rows: each is asked as a single one, on the stream of its row."""

from collections.abc import Sequence

import numpy as np

from ikde.kernels.answer import BLOCKED, METRICS, PAIR, SCORE, size_of
from ikde.kernels.arrays import ATTEMPTS, COLLIDING, COUNTS, EVALUATIONS, REACHED
from ikde.model.region import Region
from ikde.model.target import Target, Targets
from ikde.solver.cancellation import get_cancel_check
from ikde.solver.engine_table import NAMES
from ikde.solver.engines.search_state import PairCounts, SearchState
from ikde.solver.explain import Explanation
from ikde.solver.grade import Outcomes
from ikde.solver.metrics import Metrics
from ikde.solver.problem import Problem
from ikde.solver.regions import RegionQuestion, solve_region
from ikde.solver.result import SolveResult
from ikde.solver.results import SolveResults, solve_rows

Goals = Sequence[Target | Region]


def solve_goals(problem: Problem, goals: Goals, *, seed: int, first_stream: int = 0) -> SolveResults:
    """Rows of goals, each graded by plain numpy, too; goal k searches the stream (seed, first_stream + k)."""
    streams, rows, check_cancelled = range(first_stream, first_stream + len(goals)), [], get_cancel_check()
    for stream, goal in zip(streams, goals, strict=True):
        check_cancelled()
        rows.append(_solve(problem, goal, seed, stream))
    found = _gather(problem, rows)
    stories = {
        place: Explanation(stop_reason=r.stop_reason, reason=r.reason, hint=r.hint, blocking_pairs=r.blocking_pairs)
        for place, r in enumerate(rows)
        if not r.reached
    }
    outcomes = Outcomes(
        problem=problem,
        found=found,
        verdicts=np.ones(len(rows), dtype=np.bool_),
        asked=np.ones(len(rows), dtype=np.bool_),
        reached=np.array([row.reached for row in rows], dtype=np.bool_),
        explanations=stories,
    )
    return SolveResults(
        problem=problem,
        targets=Targets.of([row.target for row in rows]),
        seed=seed,
        streams=streams,
        found=found,
        outcomes=outcomes,
        compile_seconds=sum(row.compile_seconds for row in rows),
        singles=tuple(rows),
    )


def _solve(problem: Problem, goal: Target | Region, seed: int, stream: int) -> SolveResult:
    if isinstance(goal, Region):
        return solve_region(RegionQuestion(problem, goal, seed, stream))
    return solve_rows(problem, [goal], seed=seed, first_stream=stream, strict=True).row(0)


def _gather(problem: Problem, results: Sequence[SolveResult]) -> SearchState:
    """The numbers of single results as columns; counts are of all that was tried for each."""
    joints, count, pairs = len(problem.lower), len(results), problem.collision.counted
    numbers = np.array([result._row for result in results]).reshape(count, size_of(joints, len(pairs)))
    whole = numbers[:, joints + METRICS :].view(np.int64)
    counts = np.zeros((count, COUNTS), dtype=np.int64)
    columns = {REACHED: "reached", ATTEMPTS: "attempts", EVALUATIONS: "evaluations", COLLIDING: "rejected"}
    for column, name in columns.items():
        counts[:, column] = [getattr(result, name) for result in results]
    blocked = np.array([[result.blocking_pairs.get(pair, 0) for pair in pairs] for result in results], dtype=np.int64)
    kept = PairCounts(blocked.reshape(count, len(pairs)))
    kept.keep(0, np.arange(count))
    kept.drop_filled()
    return SearchState(
        q=numbers[:, :joints].copy(),
        score=numbers[:, joints + METRICS + SCORE : joints + METRICS + BLOCKED].copy(),
        counts=counts,
        pair_counts=kept,
        excess_m=np.zeros(count),
        excess_rad=np.zeros(count),
        ruled_out=np.full(count, -1),
        seconds=np.array([result.solve_seconds for result in results]),
        engine=np.array([NAMES.index(result.method) for result in results], dtype=np.int64),
        metrics=Metrics(
            position_error_m=numbers[:, joints].copy(),
            orientation_error_rad=numbers[:, joints + 1].copy(),
            clearance_m=numbers[:, joints + 2].copy(),
            closest_pair=whole[:, PAIR].copy(),
            accepted=np.array([result.reached for result in results], dtype=np.bool_),
        ),
    )
