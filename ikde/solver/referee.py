"""Grades what engines found, once it is in the turn that was meant and near `near`; the refused is searched on.

A full turn moves no body, but for rounding, and an engine stops a hair inside the tolerances, so a refusal is rare: a
tolerance near the rounding limit of a far target, or a bug. The next attempt, or engine, then goes on with that row.
"""

from functools import lru_cache

import numpy as np

from ikde.kernels.arrays import ATTEMPTS, REACHED, Floats, Ints
from ikde.kernels.turns import unwind_rows
from ikde.model.large_worlds import KEPT
from ikde.model.target import Targets
from ikde.solver.engines.search_state import SearchState
from ikde.solver.engines.stay_near import stay_near
from ikde.solver.metrics import Limits, compute_metrics
from ikde.solver.problem import Problem
from ikde.solver.verify import Bools

REFUSED = (1.0, 0.0)  # the score of a refused answer: any that is met is better, any that is not met is worse


class Referee:
    """Keeps the metrics of `found` (`solver.metrics`) those of its `q`."""

    def __init__(self, problem: Problem, targets: Targets, found: SearchState, *, is_graded: bool = False) -> None:
        self.found, self.targets = found, targets
        self._problem, self._limits = problem, _widest(problem)
        attempts = found.counts[:, ATTEMPTS].copy()
        self._graded = attempts if is_graded else np.full_like(attempts, -1)  # of each row: without a new one, no new q

    def grade(self, rows: slice) -> None:
        """Grade those of some rows that have new attempts; threads may do so at once, each with rows of its own."""
        new = self.found.counts[rows, ATTEMPTS] != self._graded[rows]
        if new.all():
            self._grade(rows)  # mostly all at once, without a copy
        elif new.any():
            self._grade(rows.start + np.flatnonzero(new))

    def refuse(self) -> Ints:
        """Grade every row with new attempts; open those again that are called reached but not accepted; which ones."""
        found, reached = self.found, self.found.counts[:, REACHED] == 1
        self.grade(slice(0, len(reached)))
        refused = np.flatnonzero(reached & ~found.metrics.accepted)
        found.counts[refused, REACHED] = 0
        found.score[refused] = REFUSED
        return refused

    def _grade(self, rows: Ints | slice) -> None:
        found, problem, asked = self.found, self._problem, self.targets.take(rows)
        Q = found.q[rows]  # of rows side by side a view: it is changed in place
        unwind_rows(*_turns(problem), Q)
        if problem.near is not None and problem.descends:
            stay_near(problem, asked, np.flatnonzero(found.counts[rows, REACHED] == 1), Q)
        found.q[rows] = Q
        found.metrics.put(rows, compute_metrics(problem.collision, asked, Q, problem.settings, limits=self._limits))
        self._graded[rows] = found.counts[rows, ATTEMPTS]


@KEPT.add
@lru_cache(maxsize=16)
def _turns(problem: Problem) -> tuple[Floats, Floats, Bools, Floats]:
    """What `unwind_rows` takes, made once."""
    return problem.turns


@KEPT.add
@lru_cache(maxsize=64)
def _widest(problem: Problem) -> Limits:
    """The limits of the robot, or the ranges of the problem where they are wider: a probe asks what they bring."""
    lower, upper = np.minimum(problem.lower, problem.robot.lower), np.maximum(problem.upper, problem.robot.upper)
    return tuple(lower.tolist()), tuple(upper.tolist())
