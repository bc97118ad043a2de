"""Pink: differential inverse kinematics on Pinocchio as a quadratic program, with its self-collision barrier."""

from typing import Any

import numpy as np
import pink
import pinocchio as pin
from pink.barriers import SelfCollisionBarrier
from pink.limits import ConfigurationLimit
from pink.tasks import FrameTask
from protocol import Setup

from adapters.differential import CLEARANCE_M, DAMPING, DT, SOLVER, Differential, task_options

CLOSEST_PAIRS = 10


class Barrier(Differential):
    """Its barrier keeps the robot apart."""

    def prepare(self, setup: Setup) -> None:
        """From URDF; the detector's pairs of spheres."""
        super().prepare(setup)
        robot = setup.robot
        self.model = pin.buildModelFromUrdf(str(setup.urdf))
        geometry = pin.buildGeomFromUrdf(self.model, str(setup.urdf), pin.GeometryType.COLLISION)
        groups: dict[str, list[int]] = {}
        for index, shape in enumerate(geometry.geometryObjects):
            groups.setdefault(self.model.frames[shape.parentFrame].name.removeprefix("component_"), []).append(index)
        for a, b in robot.pairs(robot.detector(None)):
            for i in groups[a]:
                for j in groups[b]:
                    geometry.addCollisionPair(pin.CollisionPair(i, j))
        self.data = self.model.createData()
        self.collision = {"collision_model": geometry, "collision_data": geometry.createData()}
        self.task = FrameTask(robot.tool, **task_options(setup))
        barrier = SelfCollisionBarrier(CLOSEST_PAIRS, gain=0.5, safe_displacement_gain=0.0, d_min=CLEARANCE_M)
        self.bounds = {"limits": [ConfigurationLimit(self.model)], "barriers": [barrier], "safety_break": False}

    def convert(self, p: np.ndarray, R: np.ndarray) -> Any:
        """SE3."""
        return pin.SE3(R, p)

    def configure(self, q: np.ndarray) -> Any:
        """A new configuration on the same data."""
        return pink.Configuration(self.model, self.data, q, copy_data=False, **self.collision)

    def step(self, configuration: Any) -> np.ndarray | None:
        """Within limits and barrier."""
        try:
            return pink.solve_ik(configuration, [self.task], DT, solver=SOLVER, damping=DAMPING, **self.bounds)
        except pink.PinkError:
            return None
