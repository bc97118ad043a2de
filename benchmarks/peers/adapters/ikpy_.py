"""ikpy: SciPy's bounded least squares over its chain, blind to collisions."""

from typing import Any

import ikpy.chain
import numpy as np
from protocol import Peer, Setup, to_matrix


class Bounded(Peer):
    """Its default optimiser, from random starts."""

    def prepare(self, setup: Setup) -> None:
        """From URDF; fixed links are masked out."""
        super().prepare(setup)
        elements = ["world"]
        frames = {frame.name: frame for frame in setup.robot.frames}
        path, name = [], setup.robot.tool
        while name != "world":
            path.append(name)
            name = frames[name].parent
        self.joints = []
        for name in reversed(path):
            joint = frames[name].joint or f"fixed_{name}"
            elements += [joint, name]
            self.joints.append(frames[name].joint)
        mask = [False, *(joint is not None for joint in self.joints)]
        self.chain = ikpy.chain.Chain.from_urdf_file(str(setup.urdf), base_elements=elements, active_links_mask=mask)
        self.places = np.flatnonzero(mask)
        assert [self.chain.links[k].name for k in self.places] == list(setup.robot.joint_names)

    def convert(self, p: np.ndarray, R: np.ndarray) -> np.ndarray:
        """A homogeneous matrix."""
        return to_matrix(p, R)

    def solve(self, target: Any, deadline: float) -> np.ndarray | None:
        """A random start each time."""
        mode = "all" if self.setup.is_pose else None
        start = np.zeros(len(self.chain.links))

        def attempt() -> np.ndarray | None:
            start[self.places] = self.setup.checker.draw()
            q = self.chain.inverse_kinematics_frame(target, initial_position=start, orientation_mode=mode)
            T = self.chain.forward_kinematics(q)
            return q[self.places] if self.setup.reaches(T, target[:3, 3], target[:3, :3]) else None

        return self.restart(attempt, deadline)
