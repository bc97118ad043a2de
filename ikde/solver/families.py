"""Which of the eight ways a UR-type arm holds itself: shoulder, elbow and wrist, by its geometry.

Stand at the shoulder, the first axis pointing up, and look to the wrist centre, where the last two axes meet:

* `right`: the wrist centre is to the right of the plane through the first axis that the links are parallel to, `left`:
  to its left; if it lies in that plane, the second axis tells where right is;
* `up`: the elbow is above the line from shoulder to wrist, `down`: below;
* `flip`: the fifth joint is rotated the other way, and the fourth and the sixth by half a turn.
"""

from __future__ import annotations

import numpy as np

from ikde.kernels.arrays import Floats, Ints
from ikde.kernels.closed_form import BRANCHES, DOWN, FLIP, RIGHT, SINGULAR
from ikde.model.arguments import RobotLike, read_robot
from ikde.model.closed_form import URArm, find_ur_arm
from ikde.model.robot import Robot
from ikde.solver.joints import JointValues, read_configuration


def name_family(code: int) -> str:
    """The label of a branch's code, such as `left/up/no flip`."""
    shoulder, elbow = "right" if code & RIGHT else "left", "down" if code & DOWN else "up"
    return f"{shoulder}/{elbow}/{'flip' if code & FLIP else 'no flip'}"


FAMILIES = tuple(name_family(code) for code in range(BRANCHES))
"""Labels by code."""


def family(robot: RobotLike, q: JointValues, convention: str | None = None) -> str | None:
    """How a UR-type arm holds itself: shoulder/elbow/wrist, such as `left/up/no flip`.

    Args:
        robot: the robot, its name or the path of its file.
        q: joint values [N] or a mapping by joint name; m and rad.
        convention: how `q` is counted; None for the robot's own.

    Returns:
        One of the eight `solver.families.FAMILIES`; None for a robot whose last six joints are no UR-type arm.

    Raises:
        InputError: for a wrong count, an unknown joint or convention, NaN or infinity.
    """
    robot = read_robot(robot)
    return label_family(robot, read_configuration(robot, q, convention))


def label_family(robot: Robot, q: Floats) -> str | None:
    """As `family`, of a configuration [N] in the robot's own convention that is known to be one."""
    codes = compute_families(robot, q)
    return None if codes is None else FAMILIES[int(codes)]


def compute_families(robot: Robot, q: Floats) -> Ints | None:
    """Codes [...] of configurations `q` [..., N] in the robot's own convention; index `FAMILIES` with them.

    At the borders, where two families meet, it is right, up, no flip. None for a robot without a UR-type arm.
    """
    arm = find_ur_arm(robot)
    if arm is None:
        return None
    angles = arm.angles(q)
    right = _radius_m(arm, angles) >= -SINGULAR
    bend = np.sin(angles[..., 2])
    down = np.where(right, bend, -bend) > SINGULAR
    flip = np.sin(angles[..., 4]) < -SINGULAR
    return RIGHT * right + DOWN * down + FLIP * flip


def _radius_m(arm: URArm, angles: Floats) -> Floats:
    """How far the wrist centre is from axis 1 in the arm's plane [...], behind it negative."""
    upper, fore, wrist = np.moveaxis(np.cumsum(angles[..., 1:4], axis=-1), -1, 0)
    links = arm.a1 + arm.a2 * np.cos(upper) + arm.a3 * np.cos(fore)
    return links + arm.a4 * np.cos(wrist) + arm.d5 * np.sin(wrist)
