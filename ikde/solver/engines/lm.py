"""`lm`: damped least squares from collision-free seeds, by kernels written for the robot."""

from collections.abc import Callable
from functools import partial

import numpy as np

from ikde.kernels.arrays import Floats, Ints, SeedArrays
from ikde.kernels.flat_arguments import flatten_answer, flatten_search
from ikde.model.target import KINDS
from ikde.solver.engine_table import ENGINES
from ikde.solver.engines.engine import SearchInputs, make_descent, make_ranges
from ikde.solver.engines.pool import load_kernels, make_seeds
from ikde.solver.metrics import pack_grader
from ikde.solver.problem import Problem, pack_searched

ONE_BY_ONE = ENGINES["lm"].one_by_one


def pack_block(problem: Problem, kind: str, seeds: SeedArrays | None = None) -> tuple[Floats, Ints, Floats, Floats]:
    """All that stays from target to target, as `solve_target` takes it."""
    settings = make_ranges(problem), make_descent(problem, kind), seeds or make_seeds(problem, kind)
    return flatten_search(*pack_searched(problem.collision), *settings)


def prepare_search(problem: Problem, kind: str) -> Callable[..., None]:
    """Damped least squares on one target: `search(*targets, row, seed, stream, begin, end, *outputs)`."""
    return partial(load_kernels(problem.collision, kind).solve_target.compiled, *pack_block(problem, kind))


def pack_answer(problem: Problem, kind: str, seeds: SeedArrays | None = None) -> tuple[Floats, Ints, Floats, Floats]:
    """All that stays from target to target, as `answer_target` takes it; `seeds` if they are there already."""
    *search, pool, pool_T = pack_block(problem, kind, seeds)
    grader = pack_grader(problem.collision, problem.settings)
    return *flatten_answer(search, grader, KINDS.index(kind), problem.turns), pool, pool_T


class DampedLeastSquares:
    """Solves the rows of each kind of target with that kind's kernels."""

    name = "lm"
    rows_per_call = 1024
    attempts_per_call = 256

    def __init__(self, inputs: SearchInputs) -> None:
        self._inputs, problem = inputs, inputs.problem
        names = {kind: KINDS[kind] for kind in np.unique(inputs.targets.kind).tolist()}
        self._one_by_one = len(inputs.streams) <= ONE_BY_ONE
        prepare = prepare_search if self._one_by_one else self._prepare_many
        self._searches = {kind: prepare(problem, name) for kind, name in names.items()}

    def call(self, rows: range, first: int, last: Ints) -> None:
        """Make attempts first .. last - 1 on the rows that are not reached yet."""
        asked = self._inputs
        stop = np.minimum(last, first + self.attempts_per_call)
        for kind, search in self._searches.items():
            attempts = asked.attempts(rows, first, stop, kind)
            with np.errstate(over="ignore"):  # the random stream wraps around; without the JIT numpy would warn
                if not self._one_by_one:
                    search(rows, attempts)
                    continue
                for row, (begin, end) in zip(rows, attempts.tolist(), strict=True):
                    outputs = tuple(array[row] for array in asked.outputs)
                    search(*asked.targets, row, asked.seed, int(asked.streams[row]), begin, end, *outputs)

    def _prepare_many(self, problem: Problem, kind: str) -> Callable[..., None]:
        """The same on many targets, side by side: `search(rows, attempts)`."""
        asked, module = self._inputs, load_kernels(problem.collision, kind)
        models = module.use_models(*pack_searched(problem.collision))
        settings = (make_ranges(problem), make_descent(problem, kind), make_seeds(problem, kind))

        def search(rows: range, attempts: Ints) -> None:
            where = (asked.targets, np.array([rows.start, rows.stop]))
            module.solve_targets(*models, *where, *settings, asked.seed, asked.streams, attempts, *asked.outputs)

        return search
