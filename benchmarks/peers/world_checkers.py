"""Two checkers of a robot among solids for peers that are blind to them: Pinocchio with coal, and ikde's kernels.

Both compare the detector's pairs of spheres, and the spheres of what joints move with all solids.
"""

from collections.abc import Sequence
from pathlib import Path

import coal
import numba
import numpy as np
import pinocchio as pin
from protocol import Solid

import ikde
from ikde.kernels.clearance import find_own_pair
from ikde.kernels.flat_arguments import unpack_world
from ikde.kernels.frames import compute_bodies
from ikde.kernels.spheres import compute_bounds, compute_centres
from ikde.kernels.world_grid import find_hit
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot
from ikde.model.solids import make_solid
from ikde.model.world import World, make_obstacle, make_world


class Drawing:
    """Random numbers of a robot's joints."""

    def __init__(self, robot: ikde.Robot, seed: int) -> None:
        self._range, self._random = robot.drawn, np.random.default_rng(seed)

    def is_free(self, q: np.ndarray) -> bool:
        """True without collision at joint values [N]."""
        raise NotImplementedError

    def draw(self) -> np.ndarray:
        """Uniform joint values [N] inside the limits."""
        return self._random.uniform(*self._range)

    def draw_free(self) -> np.ndarray:
        """The same, free of collision."""
        while True:
            q = self.draw()
            if self.is_free(q):
                return q


class CoalChecker(Drawing):
    """Pinocchio's `computeCollisions` over its broad phase, a dynamic tree of boxes, until the first that collide."""

    def __init__(self, robot: ikde.Robot, urdf: Path, seed: int) -> None:
        super().__init__(robot, seed)
        self.model = pin.buildModelFromUrdf(str(urdf))
        self.data = self.model.createData()
        self.own = read_spheres(robot, self.model, urdf)
        self.load(())

    def load(self, solids: Sequence[Solid]) -> None:
        """Solids in place of those before."""
        self.geometry = add_solids(self.own, solids)
        self.geometry_data = pin.GeometryData(self.geometry)
        self.manager = pin.BroadPhaseManager_DynamicAABBTreeCollisionManager(
            self.model, self.geometry, self.geometry_data
        )

    def is_free(self, q: np.ndarray) -> bool:
        """One call."""
        return not pin.computeCollisions(self.model, self.data, self.manager, q, True)


class KernelChecker(Drawing):
    """ikde's kernels, on tables and called from Python."""

    def __init__(self, robot: ikde.Robot, seed: int) -> None:
        super().__init__(robot, seed)
        self._own, self.robot = CollisionModel.of(robot), pack_robot(robot)
        self.load((Solid(kind="box", size_m=(0.1, 0.1, 0.1), T_world_solid=np.eye(4) + np.eye(4, k=3) * 50.0),))

    def load(self, solids: Sequence[Solid]) -> None:
        """Solids in place of those before."""
        self.collision = self._own.in_world(make_solids_world(solids)).arrays

    def is_free(self, q: np.ndarray) -> bool:
        """One call."""
        return is_free_in_world(self.robot, self.collision, q)


@numba.njit(error_model="numpy")
def is_free_in_world(robot, collision, q):
    """True without collision: first of the robot's own pairs, then with solids."""
    T_world_body = np.empty((robot.bodies.shape[0], 3, 4))
    bounds, centres = np.empty((collision.components.shape[0], 3)), np.empty((3, collision.radius.size))
    compute_bodies(robot, q, T_world_body)
    compute_bounds(collision, T_world_body, bounds)
    compute_centres(collision, T_world_body, centres)
    if find_own_pair(collision, bounds, centres) >= 0:
        return False
    return find_hit(unpack_world(collision.world), collision, bounds, centres) < 0


def make_solids_world(solids: Sequence[Solid]) -> World:
    """As ikde has them."""
    return make_world(
        make_obstacle(f"solid_{k}", [make_solid(solid.kind, solid.size_m)], solid.T_world_solid)
        for k, solid in enumerate(solids)
    )


def read_spheres(robot: ikde.Robot, model: pin.Model, urdf: Path) -> pin.GeometryModel:
    """The spheres of a URDF, and the detector's pairs of them."""
    geometry = pin.buildGeomFromUrdf(model, str(urdf), pin.GeometryType.COLLISION)
    groups: dict[str, list[int]] = {}
    for index, shape in enumerate(geometry.geometryObjects):
        groups.setdefault(model.frames[shape.parentFrame].name.removeprefix("component_"), []).append(index)
    for a, b in CollisionModel.of(robot).pairs:
        for i in groups[a]:
            for j in groups[b]:
                geometry.addCollisionPair(pin.CollisionPair(i, j))
    return geometry


def add_solids(own: pin.GeometryModel, solids: Sequence[Solid]) -> pin.GeometryModel:
    """The same with solids, each compared with every sphere that joints move."""
    geometry = own.copy()
    moved = [index for index, shape in enumerate(own.geometryObjects) if shape.parentJoint > 0]
    for k, solid in enumerate(solids):
        shape = coal.Box(*solid.size_m) if solid.kind == "box" else coal.Cylinder(*solid.size_m)
        T = pin.SE3(solid.T_world_solid[:3, :3], solid.T_world_solid[:3, 3])
        place = geometry.addGeometryObject(pin.GeometryObject(f"solid_{k}", 0, 0, T, shape))
        for index in moved:
            geometry.addCollisionPair(pin.CollisionPair(index, place))
    return geometry
