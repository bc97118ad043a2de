"""Pink: differential inverse kinematics on Pinocchio as a quadratic program, with its self-collision barrier."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pink
import pinocchio as pin
from pink.barriers import SelfCollisionBarrier
from pink.limits import ConfigurationLimit, Limit, VelocityLimit
from pink.tasks import FrameTask, PostureTask
from protocol import Setup, Solid
from world_checkers import add_solids, read_spheres

import ikde
from adapters.differential import CLEARANCE_M, Differential, Manner, Program, Span, orientation_cost

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
        self.own = read_spheres(robot, self.model, urdf)
        self.surround(())
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

    def surround(self, solids: Sequence[Solid]) -> None:
        """Solids in place of those before."""
        geometry = add_solids(self.own, solids)
        self.collision = {"collision_model": geometry, "collision_data": geometry.createData()}

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

    def load(self, solids: Sequence[Solid]) -> None:
        """Into its collision model; the checker is for its seeds."""
        self.setup.checker.load(solids)
        self.program.surround(solids)
