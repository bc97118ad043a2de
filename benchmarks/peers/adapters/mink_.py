"""mink: differential inverse kinematics on MuJoCo as a quadratic program, with its collision limit."""

from typing import Any

import mink
import mujoco
import numpy as np
from protocol import Peer, Setup

STEPS = 40


class Limited(Peer):
    """Steps from a collision-free configuration that the collision limit keeps apart."""

    name = "mink, collision limit"
    packages = ("mink", "mujoco", "daqp")
    use = (
        "solve_ik(FrameTask, ConfigurationLimit, CollisionAvoidanceLimit over the detector's pairs, daqp), dt 1, from "
        "collision-free seeds; restarted"
    )

    def prepare(self, setup: Setup) -> None:
        """From MJCF; a pair of geom groups for each pair of components."""
        super().prepare(setup)
        robot = setup.robot
        self.model = mujoco.MjModel.from_xml_path(str(setup.mjcf))
        self.configuration = mink.Configuration(self.model)
        self.task = mink.FrameTask(
            frame_name=robot.tool,
            frame_type="body",
            position_cost=1.0,
            orientation_cost=0.5 if setup.is_pose else 0.0,
            lm_damping=0.1,
        )
        names = [self.model.geom(k).name for k in range(self.model.ngeom)]
        groups = {
            component: [name for name in names if name.rpartition("_")[0] == component]
            for component in robot.components(robot.detector(None).spheres)
        }
        pairs = [(groups[a], groups[b]) for a, b in robot.pairs(robot.detector(None))]
        self.limits = [
            mink.ConfigurationLimit(self.model, gain=0.95),
            mink.CollisionAvoidanceLimit(
                self.model, pairs, minimum_distance_from_collisions=1e-3, collision_detection_distance=0.1
            ),
        ]

    def convert(self, p: np.ndarray, R: np.ndarray) -> Any:
        """SE3, beside what the error is measured with."""
        return mink.SE3.from_rotation_and_translation(mink.SO3.from_matrix(R), p)

    def solve(self, target: Any, deadline: float) -> np.ndarray | None:
        """Runs from collision-free seeds."""
        self.task.set_target(target)
        draw = self.setup.checker.draw_free
        return self.restart(lambda: self.descend(draw()), deadline)

    def descend(self, q: np.ndarray) -> np.ndarray | None:
        """One run."""
        configuration, task, setup = self.configuration, self.task, self.setup
        configuration.update(q)
        for _ in range(STEPS):
            error = task.compute_error(configuration)
            if np.linalg.norm(error[:3]) <= setup.position_tolerance_m and (
                not setup.is_pose or np.linalg.norm(error[3:]) <= setup.orientation_tolerance_rad
            ):
                return configuration.q.copy()
            try:
                v = mink.solve_ik(configuration, [task], 1.0, "daqp", damping=1e-6, limits=self.limits)
            except mink.MinkError:
                return None
            configuration.integrate_inplace(v, 1.0)
        return None


PEERS = (Limited,)
