"""`lm`: damped least squares from collision-free seeds, by kernels written for the robot."""

import numpy as np

from ikde.kernels.arrays import Ints
from ikde.kernels.flat_arguments import flatten_search
from ikde.model.target import KINDS
from ikde.solver.engine_table import ENGINES
from ikde.solver.engines.engine import Question, make_descent, make_ranges
from ikde.solver.engines.pool import load_kernels, make_seeds
from ikde.solver.problem import pack_searched

ONE_BY_ONE = ENGINES["lm"].one_by_one


class DampedLeastSquares:
    """Solves the rows of each kind of target with that kind's kernels."""

    name = "lm"
    rows_per_call = 1024
    attempts_per_call = 256

    def __init__(self, question: Question) -> None:
        self._question, problem = question, question.problem
        names = {kind: KINDS[kind] for kind in np.unique(question.targets.kind).tolist()}
        self._kernels = {kind: load_kernels(problem.collision, name) for kind, name in names.items()}
        self._models = pack_searched(problem.collision)
        self._settings = {
            kind: (make_ranges(problem), make_descent(problem, name), make_seeds(problem, name))
            for kind, name in names.items()
        }

    def call(self, rows: range, first: int, last: Ints) -> None:
        """Make attempts first .. last - 1 on the rows that are not reached yet."""
        asked = self._question
        stop = np.minimum(last, first + self.attempts_per_call)
        for kind, module in self._kernels.items():
            attempts = asked.attempts(rows, first, stop, kind)
            settings = self._settings[kind]
            with np.errstate(over="ignore"):  # the random stream wraps around; without the JIT numpy would warn
                if len(asked.streams) > ONE_BY_ONE:
                    where = (asked.targets, np.array([rows.start, rows.stop]))
                    which = (asked.seed, asked.streams, attempts)
                    module.solve_targets(*self._models, *where, *settings, *which, *asked.outputs)
                    continue
                block = flatten_search(*self._models, *settings)
                for row, (begin, end) in zip(rows, attempts.tolist(), strict=True):
                    lane = (asked.seed, int(asked.streams[row]), begin, end, *(array[row] for array in asked.outputs))
                    module.solve_target(*asked.targets, row, *block, *lane)
