"""Pink: differential inverse kinematics on Pinocchio as a quadratic program, with its self-collision barrier."""

from pathlib import Path
from typing import Any

import numpy as np
import pink
import pinocchio as pin
from pink.barriers import SelfCollisionBarrier
from pink.limits import ConfigurationLimit, Limit, VelocityLimit
from pink.tasks import FrameTask, PostureTask
from protocol import Setup

import ikde
from adapters.differential import CLEARANCE_M, Differential, Manner, Program, Span, orientation_cost
from ikde.model.collision_model import CollisionModel

CLOSEST_PAIRS = 10


class PinkSpan(Span, Limit):
    """As one of Pink's limits."""

    def compute_qp_inequalities(self, configuration: Any, dt: float) -> tuple[np.ndarray, np.ndarray]:
        """The room that is left."""
        return self.G, self.room(configuration.q)


class PinkProgram(Program):
    """From URDF; the detector's pairs of spheres."""

    def __init__(self, robot: ikde.Robot, urdf: Path, manner: Manner) -> None:
        self.manner = manner
        self.model = pin.buildModelFromUrdf(str(urdf))
        self.data = self.model.createData()
        geometry = self._read_spheres(robot, urdf)
        self.collision = {"collision_model": geometry, "collision_data": geometry.createData()}
        self.task = FrameTask(robot.tool, **manner.frame_costs)
        if manner.posture_cost:
            self.posture = PostureTask(cost=np.where(robot.is_prismatic, 0.0, manner.posture_cost))
        limits: list[Limit] = [ConfigurationLimit(self.model, manner.range_gain)]
        if manner.speed is not None and manner.is_split:
            self.span = PinkSpan(manner.speed * manner.dt_s)
            limits.append(self.span)
        elif manner.speed is not None:
            limits.append(VelocityLimit(self.model, manner.speed))
        barrier = SelfCollisionBarrier(
            CLOSEST_PAIRS, gain=manner.approach / manner.dt_s, safe_displacement_gain=0.0, d_min=CLEARANCE_M
        )
        self.bounds = {"limits": limits, "barriers": [barrier], "safety_break": False}

    def _read_spheres(self, robot: ikde.Robot, urdf: Path) -> pin.GeometryModel:
        geometry = pin.buildGeomFromUrdf(self.model, str(urdf), pin.GeometryType.COLLISION)
        groups: dict[str, list[int]] = {}
        for index, shape in enumerate(geometry.geometryObjects):
            groups.setdefault(self.model.frames[shape.parentFrame].name.removeprefix("component_"), []).append(index)
        for a, b in CollisionModel.of(robot).pairs:
            for i in groups[a]:
                for j in groups[b]:
                    geometry.addCollisionPair(pin.CollisionPair(i, j))
        return geometry

    def pose(self, p: np.ndarray, R: np.ndarray) -> Any:
        """Pinocchio's."""
        return pin.SE3(R, p)

    def configure(self, q: np.ndarray) -> Any:
        """A new configuration on the same data."""
        return pink.Configuration(self.model, self.data, q, copy_data=False, **self.collision)

    def rotation(self, configuration: Any) -> np.ndarray:
        """From the frame's placement."""
        return configuration.get_transform_frame_to_world(self.task.frame).rotation

    def step(self, configuration: Any) -> np.ndarray | None:
        """Within limits and barrier."""
        manner = self.manner
        told = {"solver": manner.solver, "damping": manner.damping, **self.bounds, **manner.solver_options}
        try:
            return pink.solve_ik(configuration, self.tasks, manner.dt_s, **told)
        except pink.PinkError:
            return None


class Barrier(Differential):
    """Its barrier keeps the robot apart."""

    def prepare(self, setup: Setup) -> None:
        """Full steps."""
        super().prepare(setup)
        self.manner = Manner(orientation_cost=orientation_cost(setup), approach=0.5, range_gain=0.5)
        self.program = PinkProgram(setup.robot, setup.urdf, self.manner)
