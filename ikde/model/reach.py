"""A proved bound on where the tool can be: what lies outside is out of reach, whatever the joints do.

Walk from the world to the tool. Joints with parallel axes form a run: along their common axis their offsets add up
exactly, across it they can at best be stretched into one line. So the tool lies within a ball around a set that is
simple: the box spanned by the leading prismatic joints, widened by the disc of the first run. (With slides oblique to
that run's axis the disc gives way to a ball: clamping to the box is then best for distances from a point only.)
"""

from dataclasses import dataclass

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.robot import Robot
from ikde.model.tree import Body, build_tree

PARALLEL = 1e-9


@dataclass(slots=True)
class _Run:
    """Consecutive revolute joints with parallel axes: offsets along the axis, and across it stretched."""

    axis: Floats
    along: float = 0.0
    across: float = 0.0
    slack: float = 0.0

    def add(self, offset: Floats) -> None:
        parallel = float(offset @ self.axis)
        self.along += parallel
        self.across += float(np.linalg.norm(offset - parallel * self.axis))

    @property
    def length(self) -> float:
        return float(np.hypot(self.along, self.across)) + self.slack


def reach_excess_m(robot: Robot, p_world_tool: Floats, lower: Floats, upper: Floats) -> Floats:
    """Distances in m by which positions [..., 3] are out of reach, or 0 where this bound cannot tell.

    `lower`, `upper` [N]: the joint ranges that hold, after `freeze`. Sound for any tree; sharp for the usual ones.
    """
    chain, p_body_tool = _chain_to_tool(robot)
    first = next((i for i, body in enumerate(chain) if _is_revolute(robot, body)), len(chain))
    lead, rest = chain[:first], chain[first:]
    R, centre, slides = np.eye(3), np.zeros(3), []
    for body in lead:
        centre = centre + R @ body.T_parent_body[:3, 3]
        R = R @ body.T_parent_body[:3, :3]
        slides.append((R @ body.axis, lower[body.joint], upper[body.joint]))
    if not rest:
        gap, slack = _clamp_to_box(p_world_tool - centre - R @ p_body_tool, slides)
        return np.maximum(0.0, _length(gap) - slack)
    centre = centre + R @ rest[0].T_parent_body[:3, 3]
    axis = R @ rest[0].T_parent_body[:3, :3] @ rest[0].axis
    runs = _runs(robot, rest, p_body_tool, lower, upper)
    beyond = sum(run.length for run in runs[1:])
    if any(_is_oblique(direction, axis) for direction, _, _ in slides):
        gap, slack = _clamp_to_box(p_world_tool - centre, slides)
        return np.maximum(0.0, _length(gap) - slack - runs[0].length - beyond)
    gap, slack = _clamp_to_box(p_world_tool - centre - runs[0].along * axis, slides)
    height = gap @ axis
    flat = _length(gap - height[..., None] * axis)
    outside = np.hypot(np.maximum(0.0, flat - runs[0].across), height)
    return np.maximum(0.0, outside - runs[0].slack - slack - beyond)


def arm_length_m(robot: Robot) -> float:
    """Length of the chain from the first joint that turns to the tool, stretched, in m; slides at zero."""
    chain, p_body_tool = _chain_to_tool(robot)
    first = next((i for i, body in enumerate(chain) if _is_revolute(robot, body)), len(chain))
    offsets = [body.T_parent_body[:3, 3] for body in chain[first + 1 :]]
    return float(sum(np.linalg.norm(offset) for offset in [*offsets, p_body_tool]))


def _length(vectors: Floats) -> Floats:
    return np.linalg.norm(vectors, axis=-1)


def _is_oblique(direction: Floats, axis: Floats) -> bool:
    """True unless two unit vectors are parallel or perpendicular."""
    return abs(float(direction @ axis)) > PARALLEL and float(np.linalg.norm(np.cross(direction, axis))) > PARALLEL


def _chain_to_tool(robot: Robot) -> tuple[list[Body], Floats]:
    tree = build_tree(robot)
    index = tree.frame_body[robot.tool]
    chain = []
    while index != 0:
        chain.append(tree.bodies[index])
        index = tree.bodies[index].parent
    return chain[::-1], tree.T_body_frame[robot.tool][:3, 3]


def _is_revolute(robot: Robot, body: Body) -> bool:
    return body.joint is not None and robot.joints[body.joint].kind == "revolute"


def _runs(robot: Robot, chain: list[Body], p_body_tool: Floats, lower: Floats, upper: Floats) -> list[_Run]:
    """Runs of the joints from the first revolute one on; axes are compared at q = 0, where parallel means parallel."""
    R_run_body = np.eye(3)
    runs = [_Run(axis=chain[0].axis)]
    for position, body in enumerate(chain):
        if position > 0:
            R_run_body = R_run_body @ body.T_parent_body[:3, :3]
            axis = R_run_body @ body.axis
            if _is_revolute(robot, body) and np.linalg.norm(np.cross(axis, runs[-1].axis)) > PARALLEL:
                runs.append(_Run(axis=body.axis))
                R_run_body = np.eye(3)
            elif not _is_revolute(robot, body):
                runs[-1].slack += float(max(abs(lower[body.joint]), abs(upper[body.joint])))
        following = chain[position + 1].T_parent_body[:3, 3] if position + 1 < len(chain) else p_body_tool
        runs[-1].add(R_run_body @ following)
    return runs


def _clamp_to_box(offset: Floats, slides: list[tuple[Floats, float, float]]) -> tuple[Floats, float]:
    """What is left of offsets [..., 3] after the best use of orthogonal slides; others are slack in any direction."""
    slack, used = 0.0, []
    for direction, low, high in slides:
        if any(abs(float(direction @ other)) > PARALLEL for other in used):
            slack += max(abs(low), abs(high))
            continue
        used.append(direction)
        offset = offset - direction * np.clip(offset @ direction, low, high)[..., None]
    return offset, slack
