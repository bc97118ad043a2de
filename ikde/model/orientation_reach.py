"""A proved bound on how the tool can be turned: whatever is farther off is out of reach, wherever the tool is.

A direction that is fixed in the tool keeps its angle to the axis of the last joint that turns it. Seen from the axis
before, that angle lies in an interval, given by the angle between the two axes; and so on to the first joint, whose
axis does not move. Ranges of joints do not count, but a joint that may not turn at all is part of its link.
"""

from dataclasses import dataclass

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.reach import SKEW, chain_to_tool
from ikde.model.robot import Robot
from ikde.model.rotation import angle_between, measure_skew, rotation_about
from ikde.model.target import Target

ROUNDING_RAD = 1e-14  # of each joint


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Turns:
    """The joints that turn the tool, from the world on."""

    axes: list[Floats]
    """Of each joint [3], in the frame that the one before moves."""
    own: list[Floats]
    """The same [3], in the frame that the joint itself moves."""
    R_last_tool: Floats
    """[3, 3] from the frame that the last of them moves to the tool."""
    slack_rad: float
    """What rounding, and matrices that are no exact rotations, may add up to."""


def orientation_excess_rad(robot: Robot, target: Target, lower: Floats, upper: Floats) -> float:
    """By how much the tool's orientation must miss a target at least, in rad, or 0 where this bound cannot tell.

    `lower`, `upper` [N]: the joint ranges that hold, after `freeze`; of turns it only counts whether they are points.
    """
    if target.kind == "position":
        return 0.0
    turns = _find_turns(robot, lower, upper)
    directions = [np.array([0.0, 0.0, 1.0])]
    if target.kind == "pose":
        last = [turns.R_last_tool.T @ turns.own[-1]] if turns.own else []
        directions += [*np.eye(3)[:2], *last]
    excess = max(_excess_rad(turns, direction, target.R_world_tool @ direction) for direction in directions)
    return max(0.0, excess - turns.slack_rad - SKEW * float(measure_skew(target.R_world_tool)))


def _find_turns(robot: Robot, lower: Floats, upper: Floats) -> _Turns:
    chain, _, R_body_tool = chain_to_tool(robot)
    axes, own, R, slack = [], [], np.eye(3), 0.0
    for body in chain:
        slack += ROUNDING_RAD + SKEW * float(measure_skew(body.T_parent_body[:3, :3]))
        R = R @ body.T_parent_body[:3, :3]
        joint = body.joint
        if joint is None or robot.joints[joint].kind == "prismatic":
            continue
        if lower[joint] == upper[joint]:
            R = R @ rotation_about(body.axis, lower[joint])
            continue
        axes.append(R @ body.axis)
        own.append(body.axis)
        R = np.eye(3)
    slack += SKEW * float(measure_skew(R_body_tool))
    return _Turns(axes=axes, own=own, R_last_tool=R @ R_body_tool, slack_rad=slack)


def _excess_rad(turns: _Turns, direction: Floats, wanted: Floats) -> float:
    """How far off a `direction` [3] of the tool stays from one in the world that is `wanted` [3], in rad."""
    here = turns.R_last_tool @ direction
    if not turns.axes:
        return float(angle_between(here, wanted))
    low = high = float(angle_between(turns.own[-1], here))
    for axis, before in zip(turns.axes[:0:-1], turns.own[-2::-1], strict=True):
        between = float(angle_between(before, axis))
        low, high = (max(0.0, low - between, between - high), min(np.pi, high + between, 2.0 * np.pi - between - low))
    asked = float(angle_between(turns.axes[0], wanted))
    return max(low - asked, asked - high)
