"""Moves what engines found to a local minimum of the motion from `near`."""

from functools import lru_cache

import numpy as np

from ikde.kernels.arrays import Floats, Ints
from ikde.kernels.flat_arguments import flatten_models
from ikde.kernels.least_motion import reduce_motions
from ikde.model.large_worlds import KEPT
from ikde.model.pack import pack_targets
from ikde.model.target import KINDS, Targets
from ikde.solver.engines.engine import make_ranges, make_walk
from ikde.solver.problem import Problem, pack_searched


def stay_near(problem: Problem, targets: Targets, rows: Ints, Q: Floats) -> None:
    """Move these rows of `Q` [T, N], which meet their targets, in place; each stays an answer, and none moves more."""
    for kind in np.unique(targets.kind[rows]).tolist():
        some = rows[targets.kind[rows] == kind]
        reduce_motions(*pack_walk(problem, KINDS[kind]), *pack_targets(targets), some, Q)


@KEPT.add
@lru_cache(maxsize=16)
def pack_walk(problem: Problem, kind: str) -> tuple[Floats, Ints, Floats, Floats]:
    """What stays from target to target, as `reduce_motions` takes it: writable, as it is there for one target."""
    models = flatten_models(*pack_searched(problem.collision))
    return *models, make_ranges(problem).copy(), make_walk(problem, kind)
