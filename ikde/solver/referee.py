"""Grades what engines found, once it is in the turn that was meant and near `near`; the refused is searched on.

A full turn moves no body, but for rounding, and an engine stops a hair inside the tolerances, so a refusal is rare: a
tolerance near the rounding limit of a far target, or a bug. The next attempt, or engine, then goes on with that row.
"""

import numpy as np

from ikde.kernels.arrays import ATTEMPTS, REACHED, Ints
from ikde.kernels.turns import unwind_rows
from ikde.model.target import Targets
from ikde.solver.engines.search_state import SearchState
from ikde.solver.engines.stay_near import stay_near
from ikde.solver.metrics import Limits, compute_metrics
from ikde.solver.problem import Problem

REFUSED = (1.0, 0.0)  # the score of a refused answer: any that is met is better, any that is not met is worse


class Referee:
    """Keeps the metrics of `found` (`solver.metrics`) those of its `q`."""

    def __init__(self, problem: Problem, targets: Targets, found: SearchState) -> None:
        self._targets, self._found = targets, found
        self._problem, self._limits, self._turns = problem, _widest(problem), problem.turns
        self._graded = np.full(len(targets), -1)  # attempts of each row when it was graded: without a new one, no new q

    def refuse(self) -> Ints:
        """Grade every row with new attempts; open those again that are called reached but not accepted; which ones."""
        found, reached = self._found, self._found.counts[:, REACHED] == 1
        new = np.flatnonzero((found.counts[:, ATTEMPTS] != self._graded) | (reached & ~found.metrics.accepted))
        if len(new):
            self._grade(new)
        refused = np.flatnonzero(reached & ~found.metrics.accepted)
        found.counts[refused, REACHED] = 0
        found.score[refused] = REFUSED
        return refused

    def _grade(self, rows: Ints) -> None:
        found, problem, targets = self._found, self._problem, self._targets
        some = rows if len(rows) < len(targets) else slice(None)  # mostly all at once, without a copy
        asked, Q = targets.take(some), found.q[some]
        unwind_rows(*self._turns, Q)
        if problem.near is not None and problem.descends:
            stay_near(problem, asked, np.flatnonzero(found.counts[some, REACHED] == 1), Q)
        found.q[some] = Q
        found.metrics.put(some, compute_metrics(problem.collision, asked, Q, problem.settings, limits=self._limits))
        self._graded[some] = found.counts[some, ATTEMPTS]


def _widest(problem: Problem) -> Limits:
    """The limits of the robot, or the ranges of the problem where they are wider: a probe asks what they bring."""
    lower, upper = np.minimum(problem.lower, problem.robot.lower), np.maximum(problem.upper, problem.robot.upper)
    return tuple(lower.tolist()), tuple(upper.tolist())
