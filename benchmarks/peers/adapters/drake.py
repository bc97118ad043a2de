"""Drake: inverse kinematics as a nonlinear program, self-collision as its distance constraint."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from protocol import Peer, Setup, Solid
from pydrake.geometry import Box, CollisionFilterDeclaration, Cylinder, GeometrySet
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.inverse_kinematics import InverseKinematics
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, CoulombFriction
from pydrake.solvers import SnoptSolver, SolverOptions
from pydrake.systems.framework import DiagramBuilder

from ikde.model.collision_model import CollisionModel

INFLUENCE_M, INSIDE = 0.02, 0.9  # share of each tolerance that the program is told, since its solver rounds


class Program(Peer):
    """`InverseKinematics` with a minimum distance, solved by SNOPT."""

    def prepare(self, setup: Setup) -> None:
        """From URDF; only the detector's pairs of links are looked at."""
        super().prepare(setup)
        self.make(())
        self.solver, self.options = SnoptSolver(), SolverOptions()
        # An orientation bound is 1 - cos(1e-3 rad) = 5e-7 to SNOPT, below its default of 1e-6.
        self.options.SetOption(SnoptSolver.id(), "Major feasibility tolerance", 1e-8)

    def load(self, solids: Sequence[Solid]) -> None:
        """A plant with them; the checker is for its guesses."""
        self.setup.checker.load(solids)
        self.make(solids)

    def make(self, solids: Sequence[Solid]) -> None:
        """The plant, which is as it is once it is finished."""
        setup, builder = self.setup, DiagramBuilder()
        plant, scene = AddMultibodyPlantSceneGraph(builder, time_step=0.0)
        Parser(builder).AddModels(str(setup.urdf))
        world, friction = plant.world_body(), CoulombFriction()
        around = GeometrySet()
        for k, solid in enumerate(solids):
            shape = Box(*solid.size_m) if solid.kind == "box" else Cylinder(*solid.size_m)
            T = RigidTransform(RotationMatrix(solid.T_world_solid[:3, :3]), solid.T_world_solid[:3, 3])
            around.Add(plant.RegisterCollisionGeometry(world, T, shape, f"solid_{k}", friction))
        plant.Finalize()
        robot = setup.robot
        shapes = {
            name: GeometrySet(plant.GetCollisionGeometriesForBody(plant.GetBodyByName(f"component_{name}")))
            for name in robot.components(CollisionModel.of(robot).detector.spheres)
        }
        every = GeometrySet()
        for name in shapes:
            every.Add(plant.GetCollisionGeometriesForBody(plant.GetBodyByName(f"component_{name}")))
        filters = CollisionFilterDeclaration().ExcludeWithin(every)
        for a, b in CollisionModel.of(robot).pairs:
            filters.AllowBetween(shapes[a], shapes[b])
        for name in CollisionModel.of(robot).fixed_components:
            filters.ExcludeBetween(shapes[name], around)
        scene.collision_filter_manager().Apply(filters)
        self.diagram = builder.Build()
        self.context = self.diagram.CreateDefaultContext()
        self.plant, self.plant_context = plant, plant.GetMyMutableContextFromRoot(self.context)
        self.tool = plant.GetFrameByName(robot.tool)
        starts = [plant.GetJointByName(name).position_start() for name in robot.joint_names]
        assert starts == list(range(len(starts)))

    def convert(self, p: np.ndarray, R: np.ndarray) -> Any:
        """Its own rotation matrix."""
        return p, RotationMatrix(R)

    def solve(self, target: Any, deadline: float) -> np.ndarray | None:
        """One program, solved from one guess after the other."""
        p, R = target
        setup, plant = self.setup, self.plant
        program = InverseKinematics(plant, self.plant_context)
        half = INSIDE * setup.position_tolerance_m / np.sqrt(3.0)
        world = plant.world_frame()
        program.AddPositionConstraint(self.tool, np.zeros(3), world, p - half, p + half)
        if setup.is_pose:
            bound = INSIDE * setup.orientation_tolerance_rad
            program.AddOrientationConstraint(world, R, self.tool, RotationMatrix(), bound)
        program.AddMinimumDistanceLowerBoundConstraint(1e-6, INFLUENCE_M)
        prog, q_variables, draw = program.prog(), program.q(), setup.checker.draw_free
        while True:
            result = self.solver.Solve(prog, draw(), self.options)
            if result.is_success():
                q = np.clip(result.GetSolution(q_variables), setup.lower, setup.upper)
                if setup.checker.is_free(q):
                    return q
            if self.setup.clock() > deadline:
                return None
