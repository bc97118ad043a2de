"""Moves what engines found to a local minimum of the motion from `near`."""

import numpy as np

from ikde.kernels.arrays import Floats, Ints
from ikde.kernels.least_motion import reduce_motions
from ikde.model.pack import pack_targets
from ikde.model.target import KINDS, Targets
from ikde.solver.engines.engine import make_descent, make_ranges
from ikde.solver.problem import Problem, pack_searched


def stay_near(problem: Problem, targets: Targets, rows: Ints, Q: Floats) -> None:
    """Move these rows of `Q` [T, N], which meet their targets, in place; each stays an answer, and none moves more."""
    models, ranges, asked = pack_searched(problem.collision), make_ranges(problem), pack_targets(targets)
    for kind in np.unique(asked.kind[rows]).tolist():
        some = rows[asked.kind[rows] == kind]
        reduce_motions(*models, asked, some, ranges, make_descent(problem, KINDS[kind]), problem.weights, Q)
