"""mink: differential inverse kinematics on MuJoCo as a quadratic program, with its collision limit."""

from typing import Any

import mink
import mujoco
import numpy as np
from protocol import Setup

from adapters.differential import CLEARANCE_M, DAMPING, DT, SOLVER, Differential, task_options

SEEN_M = 0.1


class Limited(Differential):
    """Its collision limit keeps the robot apart."""

    def prepare(self, setup: Setup) -> None:
        """From MJCF; a pair of geom groups for each pair of components."""
        super().prepare(setup)
        robot = setup.robot
        model = mujoco.MjModel.from_xml_path(str(setup.mjcf))
        self.configuration = mink.Configuration(model)
        self.task = mink.FrameTask(frame_name=robot.tool, frame_type="body", **task_options(setup))
        names = [model.geom(k).name for k in range(model.ngeom)]
        groups = {
            component: [name for name in names if name.rpartition("_")[0] == component]
            for component in robot.components(robot.detector(None).spheres)
        }
        pairs = [(groups[a], groups[b]) for a, b in robot.pairs(robot.detector(None))]
        distances = {"minimum_distance_from_collisions": CLEARANCE_M, "collision_detection_distance": SEEN_M}
        self.limits = [
            mink.ConfigurationLimit(model, gain=0.95),
            mink.CollisionAvoidanceLimit(model, pairs, **distances),
        ]

    def convert(self, p: np.ndarray, R: np.ndarray) -> Any:
        """SE3."""
        return mink.SE3.from_rotation_and_translation(mink.SO3.from_matrix(R), p)

    def configure(self, q: np.ndarray) -> Any:
        """One configuration, moved."""
        self.configuration.update(q)
        return self.configuration

    def step(self, configuration: Any) -> np.ndarray | None:
        """Within its limits."""
        try:
            return mink.solve_ik(configuration, [self.task], DT, SOLVER, damping=DAMPING, limits=self.limits)
        except mink.MinkError:
            return None
