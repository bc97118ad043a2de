"""`de`: the differential evolution of the papers [Qiao2021, Qiao2022]."""

import numpy as np

from ikde.kernels.arrays import Ints
from ikde.kernels.evolution import solve_lanes
from ikde.solver.engines.engine import SearchInputs
from ikde.solver.problem import Problem, pack_search, pack_searched

EVALUATIONS_PER_CALL = 20_000  # some 20 ms: searches that are shorter share a call, up to
LANES_PER_CALL = 64


class DifferentialEvolution:
    """A lane a target: population after population."""

    name = "de"
    is_ready = False
    attempts_per_call = 16

    def __init__(self, inputs: SearchInputs) -> None:
        self._inputs, problem = inputs, inputs.problem
        self._models, self._search = pack_searched(problem.collision), pack_search(problem)
        self.rows_per_call = _lanes_per_call(problem)

    def call(self, rows: range, first: int, last: Ints) -> None:
        """Make attempts first .. last - 1 on the rows that are not reached yet."""
        asked = self._inputs
        where, block = np.array([rows.start, rows.stop]), np.array([first, first + self.attempts_per_call])
        arrays = (*self._models, asked.targets, where, self._search)
        with np.errstate(over="ignore"):  # the random stream wraps around; without the JIT numpy would warn
            solve_lanes(*arrays, asked.seed, asked.streams, block, last, *asked.outputs)


def _lanes_per_call(problem: Problem) -> int:
    """How many lanes share a call: one, unless the search is very short."""
    settings = problem.settings
    attempts = min(settings.budget("de"), DifferentialEvolution.attempts_per_call)
    evaluations = settings.evolution.population * (settings.evolution.generations + 1) * attempts
    return int(np.clip(EVALUATIONS_PER_CALL // evaluations, 1, LANES_PER_CALL))
