"""Which joints drive a base in the plane and turn it."""

from functools import lru_cache

import numpy as np

from ikde.kernels.arrays import COORDINATE, PARENT, PRISMATIC, Ints
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot
from ikde.model.pairs import component_bodies
from ikde.model.robot import Robot
from ikde.model.tree import build_tree

NO_BASE = np.array([-1, -1, -1])
NO_BASE.setflags(write=False)
HEADING = 3  # the body that a base's third joint turns


@lru_cache(maxsize=64)
def find_planar_base(robot: Robot) -> Ints:
    """Coordinates [3] of x, y and turn of a base that drives in the plane and carries all that can collide.

    -1 thrice for any other robot; read-only.
    """
    arrays = pack_robot(robot)
    bodies, T = arrays.bodies, arrays.T_parent_body
    if len(bodies) < 4 or bodies[1:4, PARENT].tolist() != [0, 1, 2] or bodies[1:4, PRISMATIC].tolist() != [1, 1, 0]:
        return NO_BASE
    x, y, turn = bodies[1:4, COORDINATE].tolist()
    steps = np.eye(4)
    axes = []
    for k in (1, 2, 3):
        steps = steps @ np.vstack([T[k], [0.0, 0.0, 0.0, 1.0]])
        axes.append(steps[:3, 2])
    is_plane = np.allclose(axes, np.eye(3), atol=1e-12) and np.allclose(steps[:2, 3], 0.0, atol=1e-12)
    models = (CollisionModel(robot=robot, detector=detector) for detector in robot.detectors.values())
    carries_all = all(map(base_carries, models))
    carries_all &= bool((bodies[4:, PARENT] >= HEADING).all())
    if not (is_plane and carries_all):
        return NO_BASE
    base = np.array([x, y, turn])
    base.setflags(write=False)
    return base


def base_carries(collision: CollisionModel) -> bool:
    """Whether all that is compared rides on a planar base: where the base is does not matter then."""
    bodies = component_bodies(collision.rows, build_tree(collision.robot))
    return all(bodies[component] >= HEADING for pair in collision.pairs for component in pair)
