"""Kernels written for a robot in place of the tables that tests run on; honest ones, and some that lie."""

from contextlib import contextmanager
from types import SimpleNamespace

from ikde.kernels.arrays import ATTEMPTS, EVALUATIONS, REACHED
from ikde.solver.engines import pool
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
    pool._find_pool.cache_clear()


class Liar:
    """Kernels that call every attempt reached, at one configuration [N]; `claims` counts how often."""

    def __init__(self, q):
        self.q, self.claims = q, 0

    def change(self, module):
        """The module with its solvers exchanged; its seeds are honest."""
        solvers = {"solve_target": BothWays(self.solve_target), "solve_targets": self.solve_many(3)}
        if hasattr(module, "solve_branches"):
            solvers["solve_branches"] = self.solve_many(5)
        return SimpleNamespace(**{**vars(module), **solvers})

    def solve_target(self, *arguments):
        """Like that of `kernels/lm.py`."""
        *_, first, last, q, score, counts, _ = arguments
        if last > first:
            self.claim(q, score, counts)

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
