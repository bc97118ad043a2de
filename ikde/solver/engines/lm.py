"""`lm`: damped least squares from collision-free seeds, by kernels written for the robot."""

from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from ikde.kernels.arrays import Floats, Ints, SeedArrays
from ikde.kernels.flat_arguments import flatten_answer, flatten_search
from ikde.model.large_worlds import KEPT
from ikde.model.target import KINDS
from ikde.solver.engine_table import ENGINES
from ikde.solver.engines.engine import SearchInputs, make_descent, make_ranges
from ikde.solver.engines.pool import load_kernels, make_seeds
from ikde.solver.joined import append_world, cut_world, is_large, join_answer, without_world
from ikde.solver.metrics import pack_grader
from ikde.solver.problem import Problem, pack_searched

Block = tuple[Floats, Ints, Floats, Floats]
"""What `flatten_search` gives."""

ONE_BY_ONE = ENGINES["lm"].one_by_one


class Prepared(NamedTuple):
    """Kernels of one kind of target, and what they are handed that stays from target to target."""

    kernels: Any
    block: Block
    ready: set[bool]
    """Which have run: those of one by one (True), of many (False)."""


@KEPT.add
@lru_cache(maxsize=16)
def prepare(problem: Problem, kind: str) -> Prepared:
    """What a problem needs for one kind of target."""
    return Prepared(load_kernels(problem.collision, kind), pack_block(problem, kind), set())


def find_prepared(problem: Problem, kind: str) -> Prepared:
    """The same; what ends with a large cloud is not kept."""
    return (prepare.__wrapped__ if is_large(problem.collision.arrays) else prepare)(problem, kind)


def pack_block(problem: Problem, kind: str, seeds: SeedArrays | None = None) -> Block:
    """All that stays from target to target, as `solve_target` takes it."""
    numbers, whole, pool, pool_T = _pack_head(problem, kind, seeds)
    return *append_world(numbers, whole, int(whole[3]), problem.collision.arrays.world), pool, pool_T


def _pack_head(problem: Problem, kind: str, seeds: SeedArrays | None) -> Block:
    """The same without the world."""
    robot, collision = pack_searched(problem.collision)
    settings = make_ranges(problem), make_descent(problem, kind), seeds or make_seeds(problem, kind)
    return flatten_search(robot, without_world(collision), *settings)


def pack_answer(problem: Problem, kind: str, seeds: SeedArrays | None = None) -> tuple[Floats, Ints, Floats, Floats]:
    """All that stays from target to target, as `answer_target` takes it; `seeds` if they are there already."""
    *search, pool, pool_T = _pack_head(problem, kind, seeds)
    grader = cut_world(*pack_grader(problem.collision, problem.settings))
    block = flatten_answer(search, grader, KINDS.index(kind), problem.turns, is_graded=problem.near is None)
    return *join_answer(*block, problem.collision.arrays.world), pool, pool_T


class DampedLeastSquares:
    """Solves the rows of each kind of target with that kind's kernels."""

    name = "lm"
    rows_per_call = 4096
    attempts_per_call = 256

    def __init__(self, inputs: SearchInputs) -> None:
        self._inputs, problem = inputs, inputs.problem
        counts = np.bincount(inputs.targets.kind).tolist()
        self._prepared = {kind: find_prepared(problem, KINDS[kind]) for kind, count in enumerate(counts) if count}
        self._one_by_one = len(inputs.streams) <= ONE_BY_ONE

    @property
    def is_ready(self) -> bool:
        """Its kernels have run."""
        return all(self._one_by_one in prepared.ready for prepared in self._prepared.values())

    def call(self, rows: range, first: int, last: Ints) -> None:
        """Make attempts first .. last - 1 on the rows that are not reached yet."""
        asked = self._inputs
        for kind, (kernels, block, ready) in self._prepared.items():
            ready.add(self._one_by_one)
            attempts = asked.attempts(rows, first, last, kind)
            np.minimum(attempts, first + self.attempts_per_call, out=attempts)
            with np.errstate(over="ignore"):  # the random stream wraps around; without the JIT numpy would warn
                if not self._one_by_one:
                    where = np.array([rows.start, rows.stop]), asked.seed, asked.streams, attempts
                    kernels.solve_targets(*block, *asked.targets, *where, *asked.outputs)
                    continue
                for row, (begin, end) in zip(rows, attempts.tolist(), strict=True):
                    outputs = tuple(array[row] for array in asked.outputs)
                    lane = row, asked.seed, int(asked.streams[row]), begin, end
                    kernels.solve_target.compiled(*block, *asked.targets, *lane, *outputs)
