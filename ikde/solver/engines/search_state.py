"""What engines fill, a row a target."""

from dataclasses import dataclass, fields

import numpy as np

from ikde.kernels.arrays import COUNTS, Floats, Ints
from ikde.solver.metrics import Metrics, make_metrics
from ikde.solver.problem import Problem
from ikde.solver.verify import Bools


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SearchState:
    """What the kernels found, a row a target."""

    q: Floats  # [T, N]
    score: Floats  # [T, 2] how good `q` is: 0 if the pose is met, else 1; then depth or cost in m
    counts: Ints  # [T, COUNTS]
    pair_counts: Ints  # [T, P]
    excess_m: Floats  # [T] how far out of reach an unreached target provably is; 0 within the tolerance or if unknown
    excess_rad: Floats  # [T] by how much its orientation is, likewise
    ruled_out: Ints  # [T] why branches prove that it has no solution: index into `result.STOP_REASONS`; -1: not proved
    seconds: Floats  # [T] wall time of each lane; short searches that share a call share its time evenly
    engine: Ints  # [T] which one answered: its place in `engine_table.NAMES`
    metrics: Metrics  # of `q`, by the grader; what it refuses is not reached

    def is_excluded(self, rows: slice = slice(None)) -> Bools:
        """Which of these targets are proved to have no solution [T]."""
        return (self.excess_m[rows] > 0.0) | (self.excess_rad[rows] > 0.0) | (self.ruled_out[rows] >= 0)

    def row(self, index: int) -> "SearchState":
        """One target's share."""
        rows = np.array([index])
        columns = {field.name: getattr(self, field.name) for field in fields(self)}
        metrics = columns.pop("metrics").take(rows)
        return SearchState(metrics=metrics, **{name: column[rows] for name, column in columns.items()})


def make_search_state(problem: Problem, count: int) -> SearchState:
    """Buffers for so many targets, of which nothing is found yet."""
    pairs = len(problem.collision.pairs)
    return SearchState(
        q=np.zeros((count, len(problem.robot.joints))),
        score=np.full((count, 2), np.inf),
        counts=np.zeros((count, COUNTS), dtype=np.int64),
        pair_counts=np.zeros((count, pairs), dtype=np.int64),
        excess_m=np.zeros(count),
        excess_rad=np.zeros(count),
        ruled_out=np.full(count, -1),
        seconds=np.zeros(count),
        engine=np.zeros(count, dtype=np.int64),
        metrics=make_metrics(count),
    )
