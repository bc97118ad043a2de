"""RoboPlan: `SimpleIk`, damped steps that keep the limits and restart from collision-free configurations by themselves.

It checks the spheres of the URDF with coal, the detector's pairs alone. Before anything is timed its verdict on random
configurations must be that of the checker which the others share.
"""

from collections.abc import Sequence
from itertools import combinations
from typing import Any

import numpy as np
from protocol import Peer, Setup, Solid, to_matrix
from roboplan.core import Box, CartesianConfiguration, Cylinder, JointConfiguration, Scene, loadUrdfSceneDescription
from roboplan.simple_ik import SimpleIk, SimpleIkOptions

from ikde.model.collision_model import CollisionModel

GROUP, VERDICTS = "joints", 3000
COMPARED = 3  # worlds whose verdicts are compared before anything is timed


class Simple(Peer):
    """One call from home after the other until one succeeds, as long as each may take; options over its defaults."""

    def __init__(self, **options: Any) -> None:
        self.options = options

    def prepare(self, setup: Setup) -> None:
        """From URDF, with all joints as its group."""
        super().prepare(setup)
        self.scene = make_scene(setup)
        compare_verdicts(self.scene, setup)
        tolerances = {
            "max_linear_error_norm": setup.position_tolerance_m,
            "max_angular_error_norm": setup.orientation_tolerance_rad,
        }
        self.solver = SimpleIk(self.scene, SimpleIkOptions(group_name=GROUP, **tolerances, **self.options))
        self.solver.setRngSeed(setup.seed)
        self.scene.setRngSeed(setup.seed)
        self.home, self.start = JointConfiguration(), JointConfiguration()
        self.home.positions, self.solution = setup.robot.home, JointConfiguration()
        self.solids, self.loaded = 0, 0

    def load(self, solids: Sequence[Solid]) -> None:
        """Geometries of its scene."""
        scene, robot = self.scene, self.setup.robot
        for k in range(self.solids):
            scene.removeGeometry(f"solid_{k}")
        fixed = [f"component_{name}" for name in CollisionModel.of(robot).fixed_components]
        for k, solid in enumerate(solids):
            add = scene.addBoxGeometry if solid.kind == "box" else scene.addCylinderGeometry
            shape = Box(*solid.size_m) if solid.kind == "box" else Cylinder(*solid.size_m)
            add(f"solid_{k}", "universe", shape, np.asfortranarray(solid.T_world_solid), np.ones(4))
            apart = [*fixed, *(f"solid_{other}" for other in range(k))]
            scene.setCollisions([(f"solid_{k}", name) for name in apart], False)
        self.solids = len(solids)
        if self.loaded < COMPARED:
            self.setup.checker.load(solids)
            compare_verdicts(scene, self.setup)
        self.loaded += 1

    def convert(self, p: np.ndarray, R: np.ndarray) -> CartesianConfiguration:
        """A goal for the tool's frame."""
        return CartesianConfiguration("world", self.setup.robot.tool, to_matrix(p, R))

    def solve(self, target: Any, deadline: float) -> np.ndarray | None:
        """From home, then from collision-free configurations that it draws."""
        start, solution = self.home, self.solution
        while not self.solver.solveIk(target, start, solution):
            if self.setup.clock() > deadline:
                return None
            self.start.positions = self.scene.randomCollisionFreePositions()
            start = self.start
        return solution.positions


def make_scene(setup: Setup) -> Scene:
    """The robot with the pairs of its detector."""
    scene, robot = Scene(setup.robot.name, loadUrdfSceneDescription(setup.urdf)), setup.robot
    scene.addGroup(GROUP, list(robot.joint_names))
    assert scene.getJointGroupInfo(GROUP).q_indices.tolist() == list(range(len(robot.joints)))
    compared = {frozenset(pair) for pair in CollisionModel.of(robot).pairs}
    every = list(combinations(robot.components(CollisionModel.of(robot).detector.spheres), 2))
    for enable in (False, True):
        pairs = [pair for pair in every if (frozenset(pair) in compared) is enable]
        scene.setCollisions([(f"component_{a}", f"component_{b}") for a, b in pairs], enable)
    return scene


def compare_verdicts(scene: Scene, setup: Setup) -> None:
    """Raise unless random configurations collide for both or for neither."""
    drawn = [setup.checker.draw() for _ in range(VERDICTS)]
    differing = sum(scene.hasCollisions(q) == setup.checker.is_free(q) for q in drawn)
    if differing:
        raise RuntimeError(f"{differing} of {VERDICTS} verdicts differ from the shared checker's")
