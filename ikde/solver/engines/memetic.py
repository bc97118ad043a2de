"""`memetic`: differential evolution that adapts itself, polished by damped least squares; for what is hard."""

import numpy as np

from ikde.kernels.arrays import Ints, MemeticArrays
from ikde.kernels.memetic import solve_memetic_lane
from ikde.solver.engines.engine import SearchInputs, make_descent
from ikde.solver.problem import pack_search, pack_searched


class Memetic:
    """A lane a target, each attempt a population of its own."""

    name = "memetic"
    is_ready = False
    rows_per_call = 1
    attempts_per_call = 1

    def __init__(self, inputs: SearchInputs) -> None:
        self._inputs, problem = inputs, inputs.problem
        self._models = pack_searched(problem.collision)
        search = pack_search(problem)
        self._settings = (search, MemeticArrays(), make_descent(problem, "pose"))  # none of its steps uses a tolerance

    def call(self, rows: range, first: int, last: Ints) -> None:
        """Make attempts first .. last - 1 on the rows that are not reached yet."""
        asked = self._inputs
        attempts = asked.attempts(rows, first, np.minimum(last, first + self.attempts_per_call))
        with np.errstate(over="ignore"):  # the random stream wraps around; without the JIT numpy would warn
            for row, block in zip(rows, attempts, strict=True):
                lane = (asked.seed, asked.streams[row], block, *(array[row] for array in asked.outputs))
                solve_memetic_lane(*self._models, asked.targets, row, *self._settings, *lane)
