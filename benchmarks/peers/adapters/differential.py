"""What mink and Pink share: Gauss-Newton steps of a quadratic program that keeps limits and distance."""

from typing import Any

import numpy as np
from protocol import Peer, Setup

STEPS, CLEARANCE_M = 40, 1e-3
DT, DAMPING, SOLVER = 1.0, 1e-6, "daqp"


class Differential(Peer):
    """Steps from a collision-free configuration, started again when they lead nowhere."""

    task: Any
    """The library's `FrameTask`."""

    def solve(self, target: Any, deadline: float) -> np.ndarray | None:
        """Runs from collision-free seeds."""
        self.task.set_target(target)
        draw = self.setup.checker.draw_free
        return self.restart(lambda: self.descend(self.configure(draw())), deadline)

    def descend(self, configuration: Any) -> np.ndarray | None:
        """One run."""
        for _ in range(STEPS):
            error = self.task.compute_error(configuration)
            if self.setup.keeps(error[:3], error[3:]):
                return configuration.q.copy()
            v = self.step(configuration)
            if v is None:
                return None
            configuration.integrate_inplace(v, DT)
        return None

    def configure(self, q: np.ndarray) -> Any:
        """The library's configuration at joint values [N]."""
        raise NotImplementedError

    def step(self, configuration: Any) -> np.ndarray | None:
        """The velocity of the next step, None if the program has no answer."""
        raise NotImplementedError


def task_options(setup: Setup) -> dict[str, float]:
    """Costs of the frame task in both."""
    return {"position_cost": 1.0, "orientation_cost": 0.5 if setup.is_pose else 0.0, "lm_damping": 0.1}
