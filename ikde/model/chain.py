"""The joints that move the tool, from the world on, in given ranges: what may not move is part of a link."""

from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.robot import Robot
from ikde.model.rotation import measure_skew, rotation_about
from ikde.model.tree import Body, build_tree


class Link(NamedTuple):
    """What one joint moves, with all that is fixed to it."""

    R_before_link: Floats
    """[3, 3] in the link before, at q = 0."""
    p_before_link: Floats
    """[3] m."""
    axis: Floats
    """[3] of the joint, in the link's own frame."""
    is_revolute: bool
    lower: float
    upper: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Chain:
    """The links, and where the tool is in the last of them (in the world, if nothing may move)."""

    links: tuple[Link, ...]
    p_link_tool: Floats
    R_link_tool: Floats
    skews: int
    """Matrices that were multiplied."""
    skew: float
    """What they lack of rotations, summed up."""
    length_m: float
    """All that can add up in a coordinate: offsets, and prismatic joints at their limits."""


def find_chain(robot: Robot, lower: Floats, upper: Floats) -> Chain:
    """The chain in joint ranges `lower`, `upper` [N]; a joint whose ends are equal is held there."""
    path, p_body_tool, R_body_tool = path_to_tool(robot)
    lengths, skews = _measure(robot)
    links, R, p, length = [], np.eye(3), np.zeros(3), sum(lengths)
    for body in path:
        p = p + R @ body.T_parent_body[:3, 3]
        R = R @ body.T_parent_body[:3, :3]
        low, high = float(lower[body.joint]), float(upper[body.joint])
        rotates = is_revolute(robot, body)
        length += 0.0 if rotates else max(abs(low), abs(high))
        if low != high:
            links.append(Link(R, p, body.axis, rotates, low, high))
            R, p = np.eye(3), np.zeros(3)
        elif rotates:
            R = R @ rotation_about(body.axis, low)
        else:
            p = p + R @ (low * body.axis)
    return Chain(
        links=tuple(links),
        p_link_tool=p + R @ p_body_tool,
        R_link_tool=R @ R_body_tool,
        skews=len(skews),
        skew=sum(skews),
        length_m=length,
    )


def path_to_tool(robot: Robot) -> tuple[list[Body], Floats, Floats]:
    """Bodies from the world to the tool, and the tool's place [3] and rotation [3, 3] in the last of them."""
    tree = build_tree(robot)
    index = tree.frame_body[robot.tool]
    path = []
    while index != 0:
        path.append(tree.bodies[index])
        index = tree.bodies[index].parent
    T_body_tool = tree.T_body_frame[robot.tool]
    return path[::-1], T_body_tool[:3, 3], T_body_tool[:3, :3]


def is_revolute(robot: Robot, body: Body) -> bool:
    """Whether a body's joint is revolute."""
    return body.joint is not None and robot.joints[body.joint].kind != "prismatic"


@lru_cache(maxsize=64)
def _measure(robot: Robot) -> tuple[list[float], list[float]]:
    """Of each body on the path, and of the tool: its offset's length, m, and what its matrix lacks of a rotation."""
    path, p_body_tool, R_body_tool = path_to_tool(robot)
    offsets = [*(body.T_parent_body[:3, 3] for body in path), p_body_tool]
    rotations = [*(body.T_parent_body[:3, :3] for body in path), R_body_tool]
    return [float(np.linalg.norm(offset)) for offset in offsets], [float(measure_skew(R)) for R in rotations]
