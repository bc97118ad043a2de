"""Grades what an engine calls reached, as soon as it says so: what the grader refuses is open again.

An engine stops a hair inside the tolerances, so a refusal is rare: a tolerance near the rounding limit of a far target,
or a bug. The next attempt, or the next engine, then goes on with that row.
"""

import numpy as np

from ikde.kernels.arrays import REACHED, Floats, Ints
from ikde.model.target import Targets
from ikde.solver.engines.found import Found
from ikde.solver.figures import Limits, compute_figures
from ikde.solver.problem import Problem

REFUSED = (1.0, 0.0)  # the score of a refused answer: any that is met is better, any that is not met is worse


class Referee:
    """Keeps the figures of `found` (`solver.figures`) those of its `q`."""

    def __init__(self, problem: Problem, targets: Targets, found: Found) -> None:
        self._targets, self._found = targets, found
        self._problem, self._limits = problem, _widest(problem)
        self._graded: Floats = np.full_like(found.q, np.nan)

    def refuse(self) -> Ints:
        """Grade every row whose `q` is new; open those again that are called reached but not accepted; which ones."""
        found = self._found
        new = np.flatnonzero((found.q != self._graded).any(axis=1))
        if len(new):
            self._grade(new)
        refused = new[(found.counts[new, REACHED] == 1) & ~found.figures.accepted[new]]
        found.counts[refused, REACHED] = 0
        found.score[refused] = REFUSED
        return refused

    def _grade(self, rows: Ints) -> None:
        problem, q = self._problem, self._found.q[rows]
        asked = problem.robot, problem.detector, self._targets.take(rows), q, problem.settings
        self._found.figures.put(rows, compute_figures(*asked, limits=self._limits))
        self._graded[rows] = q


def _widest(problem: Problem) -> Limits:
    """The limits of the robot, or the ranges of the problem where they are wider: a probe asks what they bring."""
    lower, upper = np.minimum(problem.lower, problem.robot.lower), np.maximum(problem.upper, problem.robot.upper)
    return tuple(lower.tolist()), tuple(upper.tolist())
