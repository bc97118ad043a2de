"""Kernels written for a robot in place of the tables that tests run on; honest ones, and some that lie."""

from contextlib import contextmanager
from types import SimpleNamespace

from ikde.kernels.answer import grade_row, open_row
from ikde.kernels.arrays import ATTEMPTS, EVALUATIONS, REACHED, TargetArrays
from ikde.kernels.flat_arguments import unpack_answer
from ikde.solver.asker import find_asker
from ikde.solver.engines import pool
from ikde.solver.engines.lm import prepare
from ikde.solver.few import find_ask
from ikde.solver.quick import find_quick
from tests.substitutes import BothWays, substituted


@contextmanager
def written_kernels(monkeypatch, change=lambda module: module):
    """Solve as users do, by the modules written for a robot, each of them changed; gives the kinds asked for."""
    asked, load = [], pool.load_module

    def load_changed(collision, kind):
        asked.append(kind)
        return change(load(collision, kind))

    monkeypatch.delenv("IKDE_KERNELS", raising=False)
    _forget()
    with substituted(load, load_changed):
        yield asked
    _forget()


def _forget():
    """What was made of other kernels."""
    find_quick.cache_clear()
    pool.find_whole.cache_clear()
    prepare.cache_clear()
    find_ask.cache_clear()
    find_asker.cache_clear()


class Liar:
    """Kernels that call every attempt reached, at one configuration [N]; `claims` counts how often."""

    def __init__(self, q):
        self.q, self.claims = q, 0

    def change(self, module):
        """The module with its solvers exchanged; its seeds are honest."""
        solvers = {"solve_target": BothWays(self.solve_target), "solve_targets": self.solve_many(6)}
        solvers |= {"answer_target": BothWays(self.answer_target), "answer_near": BothWays(self.answer_near)}
        if hasattr(module, "solve_branches"):
            solvers["solve_branches"] = self.solve_many(5)
        return SimpleNamespace(**{**vars(module), **solvers})

    def solve_target(self, *arguments):
        """Like that of `kernels/lm.py`."""
        *_, first, last, q, score, counts, _ = arguments
        if last > first:
            self.claim(q, score, counts)

    def answer_target(self, numbers, whole, pool, pool_T, T_world_tool, seed, stream, first, last, out):
        """Like that of `kernels/lm.py`, with its honest grader."""
        grader, terms, kinds, _ = unpack_answer(numbers, whole)
        q, score, counts, _ = open_row(len(self.q), first, out)
        self.solve_target(first, last, q, score, counts, None)
        return grade_row(grader, terms, TargetArrays(kinds, T_world_tool.reshape(1, 3, 4)), len(self.q), out)

    def answer_near(self, numbers, whole, pool, pool_T, weight, *question):
        """The same: a lie is not moved."""
        return self.answer_target(numbers, whole, pool, pool_T, *question)

    def solve_many(self, place):
        """Like `solve_targets` and `solve_branches`; which rows they solve stands at this place."""

        def solve(*arguments):
            (start, stop), attempts = arguments[place], arguments[-5]
            for row, (first, last) in zip(range(start, stop), attempts.tolist(), strict=True):
                if last > first:
                    self.claim(*(array[row] for array in arguments[-4:-1]))

        return solve

    def claim(self, q, score, counts):
        """Reached at the first attempt."""
        q[:], score[:] = self.q, 0.0
        counts[[REACHED, ATTEMPTS, EVALUATIONS]] += 1
        self.claims += 1
