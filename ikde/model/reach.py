"""A proved bound on where the tool can be: what lies outside is out of reach, whatever the joints do.

Walk from the world to the tool. Joints with parallel axes form a run: along their common axis their offsets and slides
add up exactly, across it they can at best be stretched into one line. So the tool lies within a ball around a convex
set that is simple: what the leading prismatic joints span, widened by the cylinder of the first run. Its distance is
approached from below: a plane that parts a point from the whole set proves how far out the point is at least.
"""

from dataclasses import dataclass

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.robot import Robot
from ikde.model.rotation import measure_skew
from ikde.model.tree import Body, build_tree

PARALLEL = 1e-9  # between axes of one run; by how far they are not is added to what the run can reach
SWEEPS = 60  # of the search for the nearest point; two are enough where slides are at right angles
CONVERGED, ROUNDING = 1e-13, 2e-15  # of all lengths
TINY_M = 1e-300
SKEW = 3.0  # rad: how far a matrix may turn directions, times what it lacks of a rotation

Slide = tuple[Floats, float, float]
"""A direction [3] of length 1, and how far along it something can be at least and at most, m."""


@dataclass(slots=True)
class _Run:
    """Revolute joints with parallel axes, and slides between them: sums along the axis, and across it stretched; m."""

    axis: Floats
    low: float = 0.0
    high: float = 0.0
    across: float = 0.0
    total: float = 0.0
    tilt: float = 0.0
    """Sum of the angles between the axes, rad."""

    def add(self, offset: Floats) -> None:
        self.slide(offset, 1.0, 1.0)

    def slide(self, direction: Floats, lower: float, upper: float) -> None:
        parallel = float(direction @ self.axis)
        ends = parallel * lower, parallel * upper
        self.low, self.high = self.low + min(ends), self.high + max(ends)
        farthest = max(abs(lower), abs(upper))
        self.across += farthest * float(np.linalg.norm(direction - parallel * self.axis))
        self.total += farthest * float(np.linalg.norm(direction))

    @property
    def length(self) -> float:
        return float(np.hypot(max(abs(self.low), abs(self.high)), self.across))


def reach_excess_m(robot: Robot, p_world_tool: Floats, lower: Floats, upper: Floats) -> Floats:
    """Distances in m by which positions [..., 3] are out of reach, or 0 where this bound cannot tell.

    `lower`, `upper` [N]: the joint ranges that hold, after `freeze`; those of turns do not count. Sound for any tree;
    sharp for the usual ones.
    """
    chain, p_body_tool, _ = chain_to_tool(robot)
    first = next((i for i, body in enumerate(chain) if _is_revolute(robot, body)), len(chain))
    lead, rest = chain[:first], chain[first:]
    R, centre, slides = np.eye(3), np.zeros(3), []
    for body in lead:
        centre = centre + R @ body.T_parent_body[:3, 3]
        R = R @ body.T_parent_body[:3, :3]
        slides.append((R @ body.axis, lower[body.joint], upper[body.joint]))
    skew = SKEW * sum(float(measure_skew(body.T_parent_body[:3, :3])) for body in chain)
    askew = skew * sum(max(abs(low), abs(high)) for _, low, high in slides)
    if not rest:
        return _bound_distance(p_world_tool - centre - R @ p_body_tool, slides, np.zeros(3), 0.0, askew)
    centre = centre + R @ rest[0].T_parent_body[:3, 3]
    axis = R @ rest[0].T_parent_body[:3, :3] @ rest[0].axis
    runs = _runs(robot, rest, p_body_tool, lower, upper)
    askew += (2.0 * sum(run.tilt for run in runs) + skew) * sum(run.total for run in runs)
    ball = sum(run.length for run in runs[1:]) + askew
    slides.append((axis, runs[0].low, runs[0].high))
    return _bound_distance(p_world_tool - centre, slides, axis, runs[0].across, ball)


def _bound_distance(offset: Floats, slides: list[Slide], axis: Floats, disc: float, ball: float) -> Floats:
    """At least how far offsets [..., 3] are from all sums of slides, a disc across `axis`, and a ball (radii in m)."""
    left, taken, flat = np.array(offset), [np.zeros(offset.shape[:-1]) for _ in slides], np.zeros_like(offset)
    lengths = _length(offset) + disc + ball + sum(max(abs(low), abs(high)) for _, low, high in slides)
    bound = np.zeros(offset.shape[:-1])
    for _ in range(SWEEPS):
        for k, (direction, low, high) in enumerate(slides):
            left = left + taken[k][..., None] * direction
            taken[k] = np.clip(left @ direction, low, high)
            left = left - taken[k][..., None] * direction
        left = left + flat
        across = left - (left @ axis)[..., None] * axis
        flat = across * np.minimum(1.0, disc / np.maximum(_length(across), TINY_M))[..., None]
        left = left - flat
        distance = _length(left)
        bound = _parting_plane(offset, left / np.maximum(distance, TINY_M)[..., None], slides, axis, disc)
        if np.all(distance - bound <= CONVERGED * lengths):
            break
    return np.maximum(0.0, bound - ball - ROUNDING * lengths)


def _parting_plane(offset: Floats, normal: Floats, slides: list[Slide], axis: Floats, disc: float) -> Floats:
    """How far beyond all sums of slides and disc offsets [..., 3] lie along unit vectors `normal` [..., 3], m."""
    beyond = np.sum(offset * normal, axis=-1)
    for direction, low, high in slides:
        along = normal @ direction
        beyond = beyond - np.maximum(along * low, along * high)
    return beyond - disc * _length(normal - (normal @ axis)[..., None] * axis)


def arm_length_m(robot: Robot) -> float:
    """Length of the chain from the first joint that turns to the tool, stretched, in m; slides at zero."""
    chain, p_body_tool, _ = chain_to_tool(robot)
    first = next((i for i, body in enumerate(chain) if _is_revolute(robot, body)), len(chain))
    offsets = [body.T_parent_body[:3, 3] for body in chain[first + 1 :]]
    return float(sum(np.linalg.norm(offset) for offset in [*offsets, p_body_tool]))


def _length(vectors: Floats) -> Floats:
    return np.linalg.norm(vectors, axis=-1)


def chain_to_tool(robot: Robot) -> tuple[list[Body], Floats, Floats]:
    """Bodies from the world to the tool, and the tool's place [3] and rotation [3, 3] in the last of them."""
    tree = build_tree(robot)
    index = tree.frame_body[robot.tool]
    chain = []
    while index != 0:
        chain.append(tree.bodies[index])
        index = tree.bodies[index].parent
    T_body_tool = tree.T_body_frame[robot.tool]
    return chain[::-1], T_body_tool[:3, 3], T_body_tool[:3, :3]


def _is_revolute(robot: Robot, body: Body) -> bool:
    return body.joint is not None and robot.joints[body.joint].kind != "prismatic"


def _runs(robot: Robot, chain: list[Body], p_body_tool: Floats, lower: Floats, upper: Floats) -> list[_Run]:
    """Runs of the joints from the first revolute one on; axes are compared at q = 0, where parallel means parallel."""
    R_run_body = np.eye(3)
    runs = [_Run(axis=chain[0].axis)]
    for position, body in enumerate(chain):
        if position > 0:
            R_run_body = R_run_body @ body.T_parent_body[:3, :3]
            axis = R_run_body @ body.axis
            apart = float(np.linalg.norm(np.cross(axis, runs[-1].axis)))
            if not _is_revolute(robot, body):
                runs[-1].slide(axis, float(lower[body.joint]), float(upper[body.joint]))
            elif apart <= PARALLEL:
                runs[-1].tilt += apart
            else:
                runs.append(_Run(axis=body.axis))
                R_run_body = np.eye(3)
        following = chain[position + 1].T_parent_body[:3, 3] if position + 1 < len(chain) else p_body_tool
        runs[-1].add(R_run_body @ following)
    return runs
