"""How far a joint can move a point that it carries: what bounds on motions between samples are made of."""

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.collision_model import CollisionModel
from ikde.model.robot import Robot
from ikde.model.tree import Tree


def list_centres(collision: CollisionModel) -> dict[str, list[tuple[int, Floats]]]:
    """Of each component its spheres: the body, and the centre [3] in it, m."""
    centres: dict[str, list[tuple[int, Floats]]] = {}
    for sphere in collision.spheres:
        centres.setdefault(sphere.component, []).append((sphere.body, sphere.p_body_sphere))
    return centres


def chain_of(tree: Tree, body: int) -> list[int]:
    """Bodies from `body` down to the first that the world carries."""
    chain = []
    while body != 0:
        chain.append(body)
        body = tree.bodies[body].parent
    return chain


def max_radius(robot: Robot, tree: Tree, max_abs_q: Floats, chain: list[int], body: int, point: Floats) -> float:
    """Largest distance from the axis of `body` that a point of the chain's first body can have."""
    joint = tree.bodies[body].joint
    if joint is None or robot.joints[joint].kind == "prismatic":
        return 1.0
    inner, length = chain[: chain.index(body)], 0.0
    for carried in inner:  # from the point towards the joint: the point may stand anywhere around each
        length += float(np.linalg.norm(point)) + _prismatic_travel(robot, tree, max_abs_q, carried)
        point = tree.bodies[carried].T_parent_body[:3, 3]
    axis = tree.bodies[body].axis
    return length + float(np.linalg.norm(point - (point @ axis) * axis))


def _prismatic_travel(robot: Robot, tree: Tree, max_abs_q: Floats, body: int) -> float:
    """How far a prismatic body is from where it is at q = 0, at most, m."""
    joint = tree.bodies[body].joint
    return float(max_abs_q[joint]) if joint is not None and robot.joints[joint].kind == "prismatic" else 0.0
