"""What engines fill, a row a target."""

from dataclasses import dataclass, fields

import numpy as np

from ikde.kernels.arrays import COUNTS, Floats, Ints
from ikde.solver.metrics import Metrics, make_metrics
from ikde.solver.problem import Problem
from ikde.solver.verify import Bools


class PairCounts:
    """How often each of P pairs blocked each row: few rows have any, so kernels fill a piece of all at a time."""

    def __init__(self, filled: Ints) -> None:
        self.filled = filled  # [rows of a piece, P] what kernels add to
        self._entries = np.empty((0, 3), dtype=np.int64)  # row, pair, how often; sorted by row

    def keep(self, first: int, some: Ints) -> None:
        """Take over what stands in rows `some` of `filled`, zero elsewhere, as that of rows `first` + `some`; clear it.

        Rows come in order.
        """
        if not len(some):
            return
        places, pairs = np.nonzero(self.filled[some])
        rows = some[places]
        new = np.column_stack([first + rows, pairs, self.filled[rows, pairs]])
        self._entries = np.concatenate([self._entries, new])
        self.filled[rows, pairs] = 0

    def drop_filled(self) -> None:
        """Nothing will be added: a hundred thousand rows of qiao2021 are 28 MB, what is kept of them 0.4."""
        self.filled = self.filled[:0].copy()

    def take(self, rows: Ints) -> "PairCounts":
        """What is kept of these rows [K], which become rows 0 .. K - 1."""
        taken = PairCounts(self.filled[:0].copy())
        parts = [taken._entries]
        for place, row in enumerate(rows.tolist()):
            first, last = np.searchsorted(self._entries[:, 0], (row, row + 1))
            parts.append(self._entries[first:last] + np.array([place - row, 0, 0]))
        taken._entries = np.concatenate(parts)
        return taken

    def blocked_beyond(self, pair: int) -> Ints:
        """Rows that were blocked by pairs from this one on."""
        return np.unique(self._entries[self._entries[:, 1] >= pair, 0])

    def row(self, index: int) -> Ints:
        """Counts [P] of one row, of those that were kept."""
        counts = np.zeros(self.filled.shape[1], dtype=np.int64)
        first, last = np.searchsorted(self._entries[:, 0], (index, index + 1))
        counts[self._entries[first:last, 1]] = self._entries[first:last, 2]
        return counts


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SearchState:
    """What the kernels found, a row a target."""

    q: Floats  # [T, N]
    score: Floats  # [T, 2] how good `q` is: 0 if the pose is met, else 1; then depth or cost in m
    counts: Ints  # [T, COUNTS]
    pair_counts: PairCounts  # [T, P]
    excess_m: Floats  # [T] how far out of reach an unreached target provably is; 0 within the tolerance or if unknown
    excess_rad: Floats  # [T] by how much its orientation is, likewise
    ruled_out: Ints  # [T] why it is proved to have no solution: index into `result.STOP_REASONS`; -1: not proved
    seconds: Floats  # [T] wall time of each lane; short searches that share a call share its time in equal parts
    engine: Ints  # [T] which one answered: its place in `engine_table.NAMES`
    metrics: Metrics  # of `q`, by the grader; what it refuses is not reached

    def is_excluded(self, rows: slice = slice(None)) -> Bools:
        """Which of these targets are proved to have no solution [T]."""
        return (self.excess_m[rows] > 0.0) | (self.excess_rad[rows] > 0.0) | (self.ruled_out[rows] >= 0)

    @property
    def is_settled(self) -> bool:
        """Whether every target is reached, or proved to have no solution."""
        accepted = self.metrics.accepted
        return bool(accepted.all()) or bool((accepted | self.is_excluded()).all())

    def put(self, other: "SearchState") -> None:
        """Take over the columns of as many rows, their pairs as they are filled now."""
        for name in COLUMNS:
            getattr(self, name)[:] = getattr(other, name)
        self.pair_counts.filled[:] = other.pair_counts.filled
        self.metrics.put(slice(None), other.metrics)

    def piece(self, rows: slice) -> "SearchState":
        """Some rows side by side, as views; their pairs are those that are filled now."""
        return self._take(rows, self.pair_counts, self.metrics.piece(rows))

    def take(self, rows: Ints) -> "SearchState":
        """The rows of some targets [K]."""
        return self._take(rows, self.pair_counts.take(rows), self.metrics.take(rows))

    def row(self, index: int) -> "SearchState":
        """One target's share."""
        rows = np.array([index])
        pairs = keep_pairs(self.pair_counts.row(index)[None])
        return self._take(rows, pairs, self.metrics.take(rows))

    def _take(self, rows: Ints | slice, pair_counts: PairCounts, metrics: Metrics) -> "SearchState":
        columns = {name: getattr(self, name)[rows] for name in COLUMNS}
        return SearchState(pair_counts=pair_counts, metrics=metrics, **columns)


COLUMNS = tuple(field.name for field in fields(SearchState) if field.name not in ("pair_counts", "metrics"))


def keep_pairs(counts: Ints) -> PairCounts:
    """What is kept of counts [T, P]."""
    kept = PairCounts(counts.copy())
    kept.keep(0, np.arange(len(counts)))
    return kept


def make_search_state(problem: Problem, count: int, piece: int | None = None) -> SearchState:
    """Buffers for so many targets, of which nothing is found yet; pairs are counted for `piece` of them at a time."""
    pairs, filled = len(problem.collision.counted), count if piece is None else min(piece, count)
    return SearchState(
        q=np.zeros((count, len(problem.robot.joints))),
        score=np.full((count, 2), np.inf),
        counts=np.zeros((count, COUNTS), dtype=np.int64),
        pair_counts=PairCounts(np.zeros((filled, pairs), dtype=np.int64)),
        excess_m=np.zeros(count),
        excess_rad=np.zeros(count),
        ruled_out=np.full(count, -1),
        seconds=np.zeros(count),
        engine=np.zeros(count, dtype=np.int64),
        metrics=make_metrics(count),
    )
