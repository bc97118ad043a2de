"""Robotics Toolbox for Python: its C++ Levenberg-Marquardt, `ETS.ik_LM`.

Its residual is E = 1/2 e^T W e with e in m and rad; W is the `mask`. Weights of (position tolerance / orientation
tolerance)^2 for the orientation and tol = 1/2 (position tolerance)^2 make E <= tol mean what every peer is asked.
"""

from typing import Any

import numpy as np
import roboticstoolbox as rtb
from protocol import Peer, Setup


class Documented(Peer):
    """As its documentation shows it."""

    name = "Robotics Toolbox ik_LM"
    packages = ("roboticstoolbox-python",)
    use = "ets.ik_LM(T) with its defaults (Chan, k = 1, up to 30 x 100 iterations), tol for the tolerances; restarted"
    options = {"method": "chan", "k": 1.0}  # noqa: RUF012 - read from the source by client.py

    def prepare(self, setup: Setup) -> None:
        """From URDF to the elementary transform sequence of the tool."""
        super().prepare(setup)
        robot = rtb.Robot.URDF(str(setup.urdf))
        self.ets = robot.ets(end=setup.robot.tool)
        weight = (setup.position_tolerance_m / setup.orientation_tolerance_rad) ** 2
        self.mask = np.array([1.0] * 3 + [weight if setup.is_pose else 0.0] * 3)
        self.tol = 0.5 * setup.position_tolerance_m**2

    def convert(self, p: np.ndarray, R: np.ndarray) -> np.ndarray:
        """A homogeneous matrix."""
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = R, p
        return T

    def solve(self, target: Any, deadline: float) -> np.ndarray | None:
        """Its own random restarts until the pose is met; from the start again while the answer collides."""

        def attempt() -> np.ndarray | None:
            answer = self.ets.ik_LM(target, tol=self.tol, mask=self.mask, **self.options)
            return answer.q if answer.success else None

        return self.restart(attempt, deadline)


class Tuned(Documented):
    """The best of its three methods, five gains and two limits here, from collision-free seeds."""

    name = "Robotics Toolbox ik_LM, tuned, free seeds"
    use = "ets.ik_LM(T, q0=collision-free random, method='chan', k=0.1, ilimit=10, slimit=1), restarted"
    options = {"method": "chan", "k": 0.1, "ilimit": 10, "slimit": 1}  # noqa: RUF012

    def solve(self, target: Any, deadline: float) -> np.ndarray | None:
        """One search from each collision-free random configuration."""
        draw = self.setup.checker.draw_free

        def attempt() -> np.ndarray | None:
            answer = self.ets.ik_LM(target, q0=draw(), tol=self.tol, mask=self.mask, **self.options)
            return answer.q if answer.success else None

        return self.restart(attempt, deadline)


PEERS = (Documented, Tuned)
