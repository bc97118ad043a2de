"""All branches of a UR-type arm in plain numpy, and how far they move while the tool stays within tolerances.

The formulas are those of `kernels/closed_form.py` [Hawkins2013], with which nothing is shared. A *slack* bounds how
much a number can change while the tool moves by at most `position_m` and rotates by at most `orientation_rad`: what is
true of a branch and of all within its slack is true of every pose that the tolerances accept. Slacks may be too large,
never too small. A sum moves by what its parts move by; a direction of length l whose end moves by e rotates by at most
asin(e / l); the common perpendicular of two axes at an angle b rotates by at most asin(sin(e) / sin(b)) when one
of them rotates by e (law of sines on the sphere). Where the links or the shoulder only just reach, or only with the
tolerances, two branches end: their angles are then in the middle of what is left, and the slack reaches to both ends.
Where no bound holds, with the wrist's axes in line or nearly so, the slack is NaN.
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
    """[T, 8, 6] rad, in any turn; NaN where there is no branch, nor one of a pose within the tolerances."""
    slack: Floats
    """[T, 8, 6] rad; NaN where nothing is known."""
    missing: NDArray[np.bool_]
    """[T, 8] no pose within the tolerances has this branch."""
    is_own: NDArray[np.bool_]
    """[T, 8] the pose itself has it, not only one within the tolerances."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Wrist:
    """What is known after the shoulder [T, 2] and the wrist: angles 1, 5, 6 and 2 + 3 + 4, without a flip."""

    radius: Floats
    radius_slack: Floats
    angles: Floats  # [4, T, 2]
    slack: Floats  # [4, T, 2]
    missing: NDArray[np.bool_]
    is_own: NDArray[np.bool_]


def find_branches(arm: URArm, T_carrier_tool: Floats, position_m: float, orientation_rad: float) -> Branches:
    """All branches of poses [T, 4, 4]."""
    T_wrist_tool = np.linalg.inv(arm.T_wrist_tool)
    T = np.linalg.inv(arm.T_carrier_base) @ T_carrier_tool @ T_wrist_tool
    moves = position_m + float(np.linalg.norm(T_wrist_tool[:3, 3])) * orientation_rad  # of the wrist centre, at most
    with np.errstate(invalid="ignore", divide="ignore"):
        wrist = _find_wrist(arm, T, moves, orientation_rad)
        elbow, slack, missing, reaches = _find_links(arm, wrist, T[:, 2, 3, None, None], moves)
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
        is_own=np.broadcast_to(reaches[..., None] & wrist.is_own[:, :, None, None], shape).reshape(-1, 8),
    )


def _find_wrist(arm: URArm, T: Floats, moves: float, rotates: float) -> _Wrist:
    x, y = T[:, 0, 3, None], T[:, 1, 3, None]
    across = np.hypot(x, y)
    near, far, is_own = np.maximum(across - moves, arm.d4), across + moves, across >= arm.d4
    least_radius, most_radius = (np.sqrt(length**2 - arm.d4**2) for length in (near, far))
    radius = SIDES * np.where(is_own, np.sqrt(across**2 - arm.d4**2), 0.5 * (least_radius + most_radius))
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
        radius_slack=most_radius - least_radius,
        angles=np.array([one, five, six, sum_234]),
        slack=np.array(slacks),
        missing=np.broadcast_to(far < arm.d4, radius.shape),
        is_own=np.broadcast_to(is_own, radius.shape),
    )


Links = tuple[tuple[Floats, Floats], tuple[Floats, Floats, Floats], NDArray[np.bool_], NDArray[np.bool_]]
"""Angles 2 and 3, slacks of 2, 3 and 4 [T, 2, 2, 2]; where the links reach for no pose, and for the pose [T, 2, 2]."""


def _find_links(arm: URArm, wrist: _Wrist, height: Floats, moves: float) -> Links:
    """The links between axes 2 and 4, which the wrist centre's place and theta2 + theta3 + theta4 settle."""
    sum_234, sum_slack = wrist.angles[3][:, :, None] + np.array([0.0, np.pi]), wrist.slack[3][:, :, None]
    x = wrist.radius[:, :, None] - arm.a1 - arm.a4 * np.cos(sum_234) - arm.d5 * np.sin(sum_234)
    y = height - arm.a4 * np.sin(sum_234) + arm.d5 * np.cos(sum_234)
    slack = np.hypot(wrist.radius_slack[:, :, None], moves) + np.hypot(arm.a4, arm.d5) * sum_slack
    span = np.hypot(x, y)
    longest, shortest = arm.a2 + arm.a3, abs(arm.a2 - arm.a3)
    most, least = _bend(arm, np.maximum(span - slack, shortest)), _bend(arm, np.minimum(span + slack, longest))
    reaches = (span <= longest) & (span >= shortest)
    bend = np.where(reaches, _bend(arm, span), 0.5 * (most + least))
    bend_slack = np.maximum(most - bend, bend - least)
    lean = np.arctan2(arm.a3 * np.sin(bend), arm.a2 + arm.a3 * np.cos(bend))
    two_slack = np.arcsin(slack / span) + arm.a3 / (span - slack) * bend_slack
    side = np.where(np.eye(2, dtype=bool), 1.0, -1.0)[:, None, :]  # [shoulder, flip, elbow]: left/up and right/down
    two, three = np.arctan2(y, x)[..., None] - side * lean[..., None], side * bend[..., None]
    slacks = (two_slack[..., None], bend_slack[..., None], (sum_slack + two_slack + bend_slack)[..., None])
    missing = (span - slack > longest) | (span + slack < shortest)
    return (two, three), slacks, missing, reaches


def _bend(arm: URArm, span: Floats) -> Floats:
    """The angle between the links, in [0, pi], where axes 2 and 4 are `span` m apart; NaN where they cannot be."""
    cosine = (span**2 - arm.a2**2 - arm.a3**2) / (2.0 * arm.a2 * arm.a3)
    within = np.where(np.abs(cosine) < 1.0 + 1e-12, np.clip(cosine, -1.0, 1.0), np.nan)  # ends are met by rounding
    return np.where(span > 0.0, np.arccos(within), np.nan)
