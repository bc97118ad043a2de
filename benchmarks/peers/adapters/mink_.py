"""mink: differential inverse kinematics on MuJoCo as a quadratic program, with its collision limit."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import mink
import mujoco
import numpy as np
from protocol import Setup, Solid

import ikde
from adapters.differential import CLEARANCE_M, Differential, Manner, Program, Span, orientation_cost
from ikde.model.collision_model import CollisionModel

SEEN_M = 0.1


class MinkSpan(Span, mink.Limit):
    """As one of mink's limits."""

    def compute_qp_inequalities(self, configuration: Any, dt: float) -> mink.Constraint:
        """The room that is left."""
        return mink.Constraint(self.G, self.room(configuration.q))


class MinkProgram(Program):
    """From MJCF; a pair of geom groups for each pair of components."""

    def __init__(self, robot: ikde.Robot, mjcf: Path, manner: Manner, solids: Sequence[Solid] = ()) -> None:
        self.manner = manner
        model = make_model(mjcf, solids)
        self.configuration = mink.Configuration(model)
        self.task = mink.FrameTask(robot.tool, "body", **manner.frame_costs)
        if manner.posture_cost:
            self.posture = mink.PostureTask(model, cost=np.where(robot.is_prismatic, 0.0, manner.posture_cost))
        self.limits: list[mink.Limit] = [mink.ConfigurationLimit(model, gain=manner.range_gain)]
        if manner.speed is not None and manner.is_split:
            self.span = MinkSpan(manner.speed * manner.dt_s)
            self.limits.append(self.span)
        elif manner.speed is not None:
            self.limits.append(mink.VelocityLimit(model, dict(zip(robot.joint_names, manner.speed, strict=True))))
        # The limit holds a step, not a speed, below gain * distance / dt: a gain of approach * dt means a share.
        told = {"minimum_distance_from_collisions": CLEARANCE_M, "collision_detection_distance": SEEN_M}
        pairs = pair_geoms(robot, model, len(solids))
        self.limits.append(mink.CollisionAvoidanceLimit(model, pairs, gain=manner.approach * manner.dt_s, **told))

    def pose(self, p: np.ndarray, R: np.ndarray) -> Any:
        """Its own."""
        return mink.SE3.from_rotation_and_translation(mink.SO3.from_matrix(R), p)

    def configure(self, q: np.ndarray) -> Any:
        """One configuration, moved."""
        self.configuration.update(q)
        return self.configuration

    def rotation(self, configuration: Any) -> np.ndarray:
        """From the body's pose."""
        return configuration.get_transform_frame_to_world(self.task.frame_name, "body").rotation().as_matrix()

    def step(self, configuration: Any) -> np.ndarray | None:
        """Within its limits."""
        manner = self.manner
        told = {"damping": manner.damping, "limits": self.limits, **manner.solver_options}
        try:
            return mink.solve_ik(configuration, self.tasks, manner.dt_s, manner.solver, **told)
        except mink.MinkError:
            return None


def make_model(mjcf: Path, solids: Sequence[Solid]) -> mujoco.MjModel:
    """The robot with solids around it."""
    spec = mujoco.MjSpec.from_file(str(mjcf))
    for k, solid in enumerate(solids):
        is_box = solid.kind == "box"
        half = np.array(solid.size_m) / 2 if is_box else np.array([solid.size_m[0], solid.size_m[1] / 2, 0.0])
        quat = np.empty(4)
        mujoco.mju_mat2Quat(quat, solid.T_world_solid[:3, :3].ravel())
        kind = mujoco.mjtGeom.mjGEOM_BOX if is_box else mujoco.mjtGeom.mjGEOM_CYLINDER
        told = {"size": half, "pos": solid.T_world_solid[:3, 3], "quat": quat}
        spec.worldbody.add_geom(name=f"solid_{k}", type=kind, **told)
    return spec.compile()


def pair_geoms(robot: ikde.Robot, model: mujoco.MjModel, solids: int) -> list[tuple[list[str], list[str]]]:
    """The detector's pairs as groups of geoms, and what joints move with all solids."""
    names = [model.geom(k).name for k in range(model.ngeom)]
    groups = {
        component: [name for name in names if name.rpartition("_")[0] == component]
        for component in robot.components(CollisionModel.of(robot).detector.spheres)
    }
    around, fixed = [f"solid_{k}" for k in range(solids)], CollisionModel.of(robot).fixed_components
    others = [(geoms, around) for component, geoms in groups.items() if component not in fixed] if solids else []
    return [(groups[a], groups[b]) for a, b in CollisionModel.of(robot).pairs] + others


class Limited(Differential):
    """Its collision limit keeps the robot apart."""

    def prepare(self, setup: Setup) -> None:
        """Full steps."""
        super().prepare(setup)
        self.manner = Manner(orientation_cost=orientation_cost(setup), approach=0.85, range_gain=0.95)
        self.program = MinkProgram(setup.robot, setup.mjcf, self.manner)

    def load(self, solids: Sequence[Solid]) -> None:
        """A model with them; the checker is for its seeds."""
        self.setup.checker.load(solids)
        self.program = MinkProgram(self.setup.robot, self.setup.mjcf, self.manner, solids)
