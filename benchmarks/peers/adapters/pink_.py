"""Pink: differential inverse kinematics on Pinocchio as a quadratic program, with its self-collision barrier."""

from typing import Any

import numpy as np
import pink
import pinocchio as pin
from pink.barriers import SelfCollisionBarrier
from pink.limits import ConfigurationLimit
from pink.tasks import FrameTask
from protocol import Peer, Setup

STEPS, CLOSEST_PAIRS = 40, 10


class Barrier(Peer):
    """Steps from a collision-free configuration that the barrier keeps apart."""

    name = "Pink, self-collision barrier"
    packages = ("pin-pink", "pin", "daqp")
    use = (
        "solve_ik(FrameTask, ConfigurationLimit, SelfCollisionBarrier of the 10 closest sphere pairs without its pull "
        "to rest, daqp), dt 1, from collision-free seeds; restarted"
    )

    def prepare(self, setup: Setup) -> None:
        """From URDF; the detector's pairs of spheres."""
        super().prepare(setup)
        robot = setup.robot
        self.model = pin.buildModelFromUrdf(str(setup.urdf))
        self.geometry = pin.buildGeomFromUrdf(self.model, str(setup.urdf), pin.GeometryType.COLLISION)
        groups: dict[str, list[int]] = {}
        for index, shape in enumerate(self.geometry.geometryObjects):
            groups.setdefault(self.model.frames[shape.parentFrame].name.removeprefix("component_"), []).append(index)
        for a, b in robot.pairs(robot.detector(None)):
            for i in groups[a]:
                for j in groups[b]:
                    self.geometry.addCollisionPair(pin.CollisionPair(i, j))
        self.data, self.geometry_data = self.model.createData(), self.geometry.createData()
        self.task = FrameTask(
            robot.tool, position_cost=1.0, orientation_cost=0.5 if setup.is_pose else 0.0, lm_damping=0.1
        )
        self.limits = [ConfigurationLimit(self.model)]
        self.barriers = [SelfCollisionBarrier(CLOSEST_PAIRS, gain=0.5, safe_displacement_gain=0.0, d_min=1e-3)]

    def convert(self, p: np.ndarray, R: np.ndarray) -> Any:
        """SE3."""
        return pin.SE3(R, p)

    def solve(self, target: Any, deadline: float) -> np.ndarray | None:
        """Runs from collision-free seeds."""
        self.task.set_target(target)
        draw = self.setup.checker.draw_free
        return self.restart(lambda: self.descend(draw()), deadline)

    def descend(self, q: np.ndarray) -> np.ndarray | None:
        """One run."""
        setup, task = self.setup, self.task
        configuration = pink.Configuration(
            self.model,
            self.data,
            q,
            copy_data=False,
            collision_model=self.geometry,
            collision_data=self.geometry_data,
        )
        for _ in range(STEPS):
            error = task.compute_error(configuration)
            if np.linalg.norm(error[:3]) <= setup.position_tolerance_m and (
                not setup.is_pose or np.linalg.norm(error[3:]) <= setup.orientation_tolerance_rad
            ):
                return configuration.q.copy()
            try:
                options = {"limits": self.limits, "barriers": self.barriers, "safety_break": False}
                v = pink.solve_ik(configuration, [task], 1.0, solver="daqp", damping=1e-6, **options)
            except pink.PinkError:
                return None
            configuration.integrate_inplace(v, 1.0)
        return None


PEERS = (Barrier,)
