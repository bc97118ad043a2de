"""TRAC-IK through pytracik: KDL's Newton and an SQP side by side in two threads, blind to collisions."""

from typing import Any

import numpy as np
from protocol import Peer, Setup, random_rotation
from trac_ik import TracIK


class Speed(Peer):
    """Its documented way."""

    def prepare(self, setup: Setup) -> None:
        """From URDF; it has one epsilon for m and rad."""
        super().prepare(setup)
        epsilon = setup.position_tolerance_m / 3.0**0.5  # it holds each axis apart
        self.solver = TracIK("world", setup.robot.tool, str(setup.urdf), timeout=0.005, epsilon=epsilon)
        self.random = np.random.default_rng(setup.seed)
        self.solver.joint_limits = setup.lower.tolist(), setup.upper.tolist()

    def solve(self, target: Any, deadline: float) -> np.ndarray | None:
        """A random seed each time; for a position, which pytracik does not take, a random orientation as well."""
        p, R = target
        draw, is_pose = self.setup.checker.draw, self.setup.is_pose
        return self.restart(lambda: self.solver.ik(p, R if is_pose else self.turn(), draw()), deadline)

    def turn(self) -> np.ndarray:
        """A random rotation [3, 3]."""
        return random_rotation(self.random.normal(size=4))
