"""From one orientation to another on the shortest way, as even in time as a straight line: slerp."""

from typing import Literal

import numpy as np

from ikde.errors import InputError
from ikde.kernels.arrays import Floats
from ikde.model.rotation import quat_wxyz_from_rotation, rotation_from_quat_wxyz, rotation_with_z

PathOrientation = Literal["free", "axis", "pose"]
HALF_TURN_MARGIN = 1e-6  # rad: closer to half a turn, rounding would choose the way


def slerp(orientation: PathOrientation, R: Floats, at: Floats) -> Floats:
    """Rotations [S, 3, 3] at places `at` [S] along a list of rotations.

    Args:
        orientation: `pose` rotates about one axis between neighbours; `axis` moves the z columns on great circles, and
            the rotation about them means nothing; `free` gives identities.
        R: rotations [T, 3, 3] at the places 0, 1, ..., T - 1.
        at: places, 0 to T - 1; at whole numbers what is asked there comes back to rounding.

    Raises:
        InputError: for neighbours half a turn apart; `where` is the row of the second.
    """
    if orientation == "free":
        return np.broadcast_to(np.eye(3), (len(at), 3, 3))
    if orientation == "axis":
        return rotation_with_z(_along(R[:, :, 2], np.pi, at))
    return rotation_from_quat_wxyz(_along(_same_side(quat_wxyz_from_rotation(R)), np.pi / 2, at))


def _same_side(quat_wxyz: Floats) -> Floats:
    """Quaternions [T, 4] of the same rotations, each at most a right angle from the one before."""
    opposite = np.sum(quat_wxyz[1:] * quat_wxyz[:-1], axis=1) < 0.0
    signs = np.where(np.cumsum(opposite) % 2 == 1, -1.0, 1.0)
    return quat_wxyz * np.concatenate([[1.0], signs])[:, None]


def _along(units: Floats, half_turn_rad: float, at: Floats) -> Floats:
    """Unit vectors [S, n] on the great circles through unit vectors [T, n]; `half_turn_rad` apart, there is no way."""
    first = np.clip(np.floor(at).astype(int), 0, max(len(units) - 2, 0))
    last = np.minimum(first + 1, len(units) - 1)
    a, b, share = units[first], units[last], (at - first)[:, None]
    angle = 2.0 * np.arctan2(_norm(a - b), _norm(a + b))  # exact for small angles, unlike the arc cosine
    for (row,) in np.argwhere(angle[:, 0] > half_turn_rad - HALF_TURN_MARGIN)[:1]:
        message = "half a turn from the orientation before it: either way round is shortest; put one in between"
        raise InputError(message, (int(last[row]),))
    slow = angle < 1e-9  # where the chord is the arc
    sine = np.where(slow, 1.0, np.sin(angle))
    weight_a = np.where(slow, 1.0 - share, np.sin((1.0 - share) * angle) / sine)
    weight_b = np.where(slow, share, np.sin(share * angle) / sine)
    between = weight_a * a + weight_b * b
    return between / _norm(between)


def _norm(vectors: Floats) -> Floats:
    return np.linalg.norm(vectors, axis=-1, keepdims=True)
