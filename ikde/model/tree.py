"""The tree of rigid bodies behind the frames: a body is everything that one joint moves as a whole."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.robot import WORLD, Robot


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Body:
    """What one joint moves. Body 0 is the world and has no joint."""

    parent: int
    joint: int | None
    """Index into q."""
    axis: Floats
    """[3] in the body's frame."""
    T_parent_body: Floats
    """[4, 4] at q = 0."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Tree:
    """Bodies, parents first, and where each frame is fixed."""

    bodies: tuple[Body, ...]
    frame_body: dict[str, int]
    T_body_frame: dict[str, Floats]


@lru_cache(maxsize=64)
def build_tree(robot: Robot) -> Tree:
    """Collapse fixed frames onto the bodies that carry them."""
    world = Body(parent=0, joint=None, axis=np.array([0.0, 0.0, 1.0]), T_parent_body=np.eye(4))
    bodies = [world]
    frame_body = {WORLD: 0}
    T_body_frame = {WORLD: np.eye(4)}
    for frame in robot.frames:
        carrier = frame_body[frame.parent]
        T = T_body_frame[frame.parent] @ transform(frame.R_parent_frame, frame.p_parent_frame)
        if frame.joint is not None and frame.axis is not None:
            joint = robot.joint_names.index(frame.joint)
            bodies.append(Body(parent=carrier, joint=joint, axis=frame.axis, T_parent_body=T))
            carrier, T = len(bodies) - 1, np.eye(4)
        frame_body[frame.name] = carrier
        T_body_frame[frame.name] = T
    return Tree(bodies=tuple(bodies), frame_body=frame_body, T_body_frame=T_body_frame)


def transform(R: Floats, p: Floats) -> Floats:
    """Homogeneous matrix [4, 4] of a rotation [3, 3] and a translation [3]."""
    T = np.eye(4)
    T[:3, :3] = R
    T[:3, 3] = p
    return T
