"""All branches of a UR-type arm in plain numpy, and how far they move while the tool stays within tolerances.

The formulas are those of `kernels/closed_form.py` [Hawkins2013], with which nothing is shared. A *slack* bounds how
much a number can change while the tool moves by at most `position_m` and rotates by at most `orientation_rad`: what is
true of a branch and of all within its slack is true of every pose that the tolerances accept. Slacks may be too large,
never too small. A sum moves by what its parts move by; a direction of length l whose end moves by e rotates by at most
asin(e / l); the common perpendicular of two axes at an angle b rotates by at most asin(sin(e) / sin(b)) when one
of them rotates by e (law of sines on the sphere). Where no bound holds, at a singularity or near one, the slack is NaN.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ikde.kernels.arrays import Floats
from ikde.model.closed_form import URArm

MAX_SLACK = 0.5  # rad: for larger ones the sines above would not grow with their angles
SIDES = np.array([-1.0, 1.0])  # of the shoulder: left, right


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Branches:
    """Eight branches of T poses: left and right, each without and with a flip, each up and down."""

    angles: Floats
    """[T, 8, 6] rad, in any turn; NaN where there is no branch."""
    slack: Floats
    """[T, 8, 6] rad; NaN where nothing is known."""
    missing: NDArray[np.bool_]
    """[T, 8] no pose within the tolerances has this branch."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Wrist:
    """What is known after the shoulder [T, 2] and the wrist: angles 1, 5, 6 and 2 + 3 + 4, without a flip."""

    radius: Floats
    radius_slack: Floats
    angles: Floats  # [4, T, 2]
    slack: Floats  # [4, T, 2]
    missing: NDArray[np.bool_]


def find_branches(arm: URArm, T_carrier_tool: Floats, position_m: float, orientation_rad: float) -> Branches:
    """All branches of poses [T, 4, 4]."""
    T_wrist_tool = np.linalg.inv(arm.T_wrist_tool)
    T = np.linalg.inv(arm.T_carrier_base) @ T_carrier_tool @ T_wrist_tool
    moves = position_m + float(np.linalg.norm(T_wrist_tool[:3, 3])) * orientation_rad  # of the wrist centre, at most
    with np.errstate(invalid="ignore", divide="ignore"):
        wrist = _find_wrist(arm, T, moves, orientation_rad)
        elbow, slack, missing = _find_links(arm, wrist, T[:, 2, 3, None, None], moves)
    flip, shape = np.pi * np.array([0.0, 1.0])[:, None], (len(T), 2, 2, 2)
    one, five, six, sum_234 = (angle[:, :, None, None] for angle in wrist.angles)
    one_slack, five_slack, six_slack, _ = (np.broadcast_to(own[:, :, None, None], shape) for own in wrist.slack)
    two, three = elbow
    four = sum_234 + flip - two - three
    angles = (one, two, three, four, five * np.array([1.0, -1.0])[:, None], six + flip)
    slacks = (one_slack, *slack, five_slack, six_slack)
    return Branches(
        angles=np.stack([np.broadcast_to(angle, shape) for angle in angles], axis=-1).reshape(-1, 8, 6),
        slack=np.stack([np.broadcast_to(own, shape) for own in slacks], axis=-1).reshape(-1, 8, 6),
        missing=np.broadcast_to(missing[..., None] | wrist.missing[:, :, None, None], shape).reshape(-1, 8),
    )


def _find_wrist(arm: URArm, T: Floats, moves: float, rotates: float) -> _Wrist:
    x, y = T[:, 0, 3, None], T[:, 1, 3, None]
    across = np.hypot(x, y)
    near, far = across - moves, across + moves
    radius = SIDES * np.sqrt(across**2 - arm.d4**2)
    one = np.arctan2(y, x) + np.arctan2(arm.d4, radius)
    one_slack = np.arcsin(moves / across) + np.arcsin(arm.d4 / near) - np.arcsin(arm.d4 / far)
    s, c = np.sin(one)[..., None], np.cos(one)[..., None]
    along, out = c * T[:, None, 0, :3] + s * T[:, None, 1, :3], s * T[:, None, 0, :3] - c * T[:, None, 1, :3]
    sine, five = np.hypot(out[..., 0], out[..., 1]), np.arctan2(np.hypot(out[..., 0], out[..., 1]), out[..., 2])
    six = np.arctan2(-out[..., 1], out[..., 0])
    s6, c6 = -out[..., 1] / sine, out[..., 0] / sine
    sum_234 = np.arctan2(-(s6 * along[..., 0] + c6 * along[..., 1]), s6 * T[:, None, 2, 0] + c6 * T[:, None, 2, 1])
    five_slack = one_slack + rotates
    least = np.minimum(np.sin(five - five_slack), np.sin(five + five_slack))
    least = np.where((least > 0.0) & (five_slack < MAX_SLACK), least, np.nan)
    axis_slack = np.arcsin(np.sin(one_slack) / least) + np.arcsin(np.sin(rotates) / least)  # of axis 5
    slacks = np.broadcast_arrays(one_slack, five_slack, axis_slack + rotates, axis_slack + one_slack)
    return _Wrist(
        radius=radius,
        radius_slack=np.sqrt(far**2 - arm.d4**2) - np.sqrt(near**2 - arm.d4**2),
        angles=np.array([one, five, six, sum_234]),
        slack=np.array(slacks),
        missing=np.broadcast_to(far < arm.d4, radius.shape),
    )


Links = tuple[tuple[Floats, Floats], tuple[Floats, Floats, Floats], NDArray[np.bool_]]
"""Angles 2 and 3, slacks of 2, 3 and 4 [T, 2, 2, 2], and where the links do not reach [T, 2, 2]."""


def _find_links(arm: URArm, wrist: _Wrist, height: Floats, moves: float) -> Links:
    """The links between axes 2 and 4, which the wrist centre's place and theta2 + theta3 + theta4 settle."""
    sum_234, sum_slack = wrist.angles[3][:, :, None] + np.array([0.0, np.pi]), wrist.slack[3][:, :, None]
    x = wrist.radius[:, :, None] - arm.a1 - arm.a4 * np.cos(sum_234) - arm.d5 * np.sin(sum_234)
    y = height - arm.a4 * np.sin(sum_234) + arm.d5 * np.cos(sum_234)
    slack = np.hypot(wrist.radius_slack[:, :, None], moves) + np.hypot(arm.a4, arm.d5) * sum_slack
    span = np.hypot(x, y)
    bend, most, least = (_bend(arm, length) for length in (span, span - slack, span + slack))
    bend_slack = np.maximum(most - bend, bend - least)
    lean = np.arctan2(arm.a3 * np.sin(bend), arm.a2 + arm.a3 * np.cos(bend))
    two_slack = np.arcsin(slack / span) + arm.a3 / (span - slack) * bend_slack
    side = np.where(np.eye(2, dtype=bool), 1.0, -1.0)[:, None, :]  # [shoulder, flip, elbow]: left/up and right/down
    two, three = np.arctan2(y, x)[..., None] - side * lean[..., None], side * bend[..., None]
    slacks = (two_slack[..., None], bend_slack[..., None], (sum_slack + two_slack + bend_slack)[..., None])
    missing = (span - slack > arm.a2 + arm.a3) | (span + slack < abs(arm.a2 - arm.a3))
    return (two, three), slacks, missing


def _bend(arm: URArm, span: Floats) -> Floats:
    """The angle between the links, in [0, pi], where axes 2 and 4 are `span` m apart; NaN where they cannot be."""
    cosine = (span**2 - arm.a2**2 - arm.a3**2) / (2.0 * arm.a2 * arm.a3)
    return np.where(span > 0.0, np.arccos(cosine), np.nan)
