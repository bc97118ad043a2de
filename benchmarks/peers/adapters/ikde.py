"""ikde itself, as its README shows it: `solve` in a loop, a method each, and `solve_many` for all at once.

The file is called like the library; inside the package `adapters` that hides nothing.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from protocol import Peer, Setup

import ikde


class Auto(Peer):
    """`ikde.solve(robot, target)` as it comes."""

    name = "ikde"
    packages = ("ikde", "numpy", "numba")
    method = "auto"
    use = "ikde.solve(robot, target, settings, seed=k) in a Python loop, result object and grade included"

    def prepare(self, setup: Setup) -> None:
        """Only tolerances differ from the defaults."""
        super().prepare(setup)
        self.settings = ikde.SolveSettings.for_method(self.method).with_changes(
            position_tolerance_m=setup.position_tolerance_m, orientation_tolerance_rad=setup.orientation_tolerance_rad
        )
        self.count = 0

    def convert(self, p: np.ndarray, R: np.ndarray) -> ikde.Target:
        """`ikde.Target`."""
        return ikde.Target(p, R_world_tool=R) if self.setup.is_pose else ikde.Target(p)

    def solve(self, target: Any, deadline: float) -> np.ndarray | None:
        """One call; the budget is in iterations, so the deadline is not looked at."""
        self.count += 1
        result = ikde.solve(self.setup.robot, target, self.settings, seed=self.count)
        return result.q if result.reached else None


class Damped(Auto):
    """Only the damped least squares."""

    name = "ikde, method lm"
    method = "lm"
    use = "the same with method='lm'"


class Analytic(Auto):
    """Only the closed form."""

    name = "ikde, method analytic"
    method = "analytic"
    use = "the same with method='analytic'"


class Memetic(Auto):
    """Only the memetic search."""

    name = "ikde, method memetic"
    method = "memetic"
    use = "the same with method='memetic'"


class Evolution(Auto):
    """The paper's search."""

    name = "ikde, method de"
    method = "de"
    use = "the same with method='de', the search of the paper"


class Many(Auto):
    """All targets at once."""

    name = "ikde.solve_many"
    batch = True
    use = "ikde.solve_many(robot, targets, settings, threads=1), arrays in and out: a target's time is its share"

    def convert_batch(self, p: np.ndarray, R: np.ndarray) -> ikde.Targets:
        """`ikde.Targets`."""
        return ikde.Targets(p, R_world_tool=R) if self.setup.is_pose else ikde.Targets(p)

    def solve_batch(self, targets: Any, deadline: float) -> Sequence[np.ndarray | None]:
        """One call on one thread."""
        self.count += 1
        rows = ikde.solve_many(self.setup.robot, targets, self.settings, seed=self.count, threads=1)
        return [q if reached else None for q, reached in zip(rows.q, rows.reached, strict=True)]


PEERS = (Auto, Many, Damped, Analytic, Memetic, Evolution)
