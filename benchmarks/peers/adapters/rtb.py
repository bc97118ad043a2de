"""Robotics Toolbox for Python: its C++ Levenberg-Marquardt, `ETS.ik_LM`.

Its residual is E = 1/2 e^T W e with e in m and rad; W is the `mask`. Weights of (position tolerance / orientation
tolerance)^2 for the orientation and tol = 1/2 (position tolerance)^2 make E <= tol mean what every peer is asked.
"""

from typing import Any

import numpy as np
import roboticstoolbox as rtb
from protocol import Peer, Setup, to_matrix


class Toolbox(Peer):
    """As its documentation shows it, or with other options from collision-free seeds."""

    def __init__(self, free_seeds: bool = False, seeds: str = "own", k: float = 1.0, **options: Any) -> None:
        self.seeds = "free" if free_seeds else seeds
        self.options = {"method": "chan", "k": k, **options}

    def prepare(self, setup: Setup) -> None:
        """From URDF to the elementary transform sequence of the tool."""
        super().prepare(setup)
        self.ets = rtb.Robot.URDF(str(setup.urdf)).ets(end=setup.robot.tool)
        weight = (setup.position_tolerance_m / setup.orientation_tolerance_rad) ** 2
        self.options["mask"] = np.array([1.0] * 3 + [weight if setup.is_pose else 0.0] * 3)
        self.options["tol"] = 0.5 * setup.position_tolerance_m**2

    def convert(self, p: np.ndarray, R: np.ndarray) -> np.ndarray:
        """A homogeneous matrix."""
        return to_matrix(p, R)

    def solve(self, target: Any, deadline: float) -> np.ndarray | None:
        """Its own random starts unless a seed is given; from the start again while the answer collides."""
        checker = self.setup.checker
        draw = {"free": checker.draw_free, "random": checker.draw, "own": lambda: None}[self.seeds]

        def attempt() -> np.ndarray | None:
            answer = self.ets.ik_LM(target, q0=draw(), **self.options)
            return answer.q if answer.success else None

        return self.restart(attempt, deadline)
