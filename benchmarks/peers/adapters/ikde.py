"""ikde itself, as its README shows it: `solve` in a loop, and `solve_many` for all at once.

The file is called like the library; inside the package `adapters` that hides nothing.
"""

import time
from collections.abc import Sequence
from typing import Any

import numpy as np
from protocol import Answer, Peer, Setup, Solid

import ikde
from ikde.solver.settings import BulkOptions


class Single(Peer):
    """`ikde.solve(robot, target)`."""

    def __init__(self, method: str = "auto") -> None:
        self.method, self.count = method, 0
        self.collision: ikde.CollisionModel | None = None

    def prepare(self, setup: Setup) -> None:
        """Only tolerances differ from the defaults."""
        super().prepare(setup)
        self.collision = None
        self.settings = ikde.SolveSettings.for_method(self.method).with_changes(
            position_tolerance_m=setup.position_tolerance_m, orientation_tolerance_rad=setup.orientation_tolerance_rad
        )

    def load(self, solids: Sequence[Solid]) -> None:
        """A world, with the robot in it."""
        from world_checkers import make_solids_world

        self.collision = ikde.CollisionModel.of(self.setup.robot).in_world(make_solids_world(solids))

    def convert(self, p: np.ndarray, R: np.ndarray) -> ikde.Target:
        """`ikde.Target`."""
        return ikde.Target(p, R_world_tool=R) if self.setup.is_pose else ikde.Target(p)

    def solve(self, target: Any, deadline: float) -> np.ndarray | None:
        """One call; the budget is in iterations, so the deadline is not looked at."""
        self.count += 1
        result = ikde.solve(self.setup.robot, target, self.settings, collision=self.collision, seed=self.count)
        return result.q if result.reached else None


class Many(Single):
    """`ikde.solve_many(robot, targets)`."""

    def answer(self, p: np.ndarray, R: np.ndarray, seconds: float, slice_s: float) -> list[Answer]:
        """One call on one thread; a target's time is its share."""
        self.count += 1
        targets = ikde.Targets(p, R_world_tool=R) if self.setup.is_pose else ikde.Targets(p)
        started = time.perf_counter()
        rows = ikde.solve_many(self.setup.robot, targets, self.settings, seed=self.count, bulk=BulkOptions(threads=1))
        share = (time.perf_counter() - started) / len(p)
        return [(share, q if reached else None) for q, reached in zip(rows.q, rows.reached, strict=True)]
