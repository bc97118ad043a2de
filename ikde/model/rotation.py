"""Rotation matrices: made from what users write, checked, and compared. Plain numpy, radians."""

import numpy as np

from ikde.errors import InputError
from ikde.kernels.arrays import Floats

TOLERANCE = 1e-6  # how far R R^T may be from the identity before it is no rotation


def rotation_about(axis: Floats, angle_rad: float) -> Floats:
    """Rotation matrix about a unit `axis` [3] (Rodrigues)."""
    x, y, z = axis
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle_rad) * K + (1.0 - np.cos(angle_rad)) * (K @ K)


def rotation_from_rpy(rpy_rad: Floats) -> Floats:
    """Rotation from roll, pitch, yaw about the fixed x, y, z axes, as URDF defines them: Rz(yaw) Ry(pitch) Rx(roll)."""
    roll, pitch, yaw = rpy_rad
    x, y, z = np.eye(3)
    return snap(rotation_about(z, yaw) @ rotation_about(y, pitch) @ rotation_about(x, roll))


def rotation_from_quat_wxyz(quat_wxyz: Floats) -> Floats:
    """Rotation from a quaternion, w first; it is normalised. Raises `InputError` for a zero quaternion."""
    norm = float(np.linalg.norm(quat_wxyz))
    if not norm > 1e-12:
        raise InputError("a quaternion of length 0 is no rotation; expected w x y z with a non-zero length")
    w, x, y, z = np.asarray(quat_wxyz) / norm
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def quat_wxyz_from_rotation(R: Floats) -> Floats:
    """Unit quaternions [..., 4], w first and not negative, of rotations `R` [..., 3, 3]; exact to rounding everywhere.

    4 q q^T stands in the entries of R; its row with the largest diagonal, normalised, is q up to sign.
    """
    x, y, z = np.diagonal(R, axis1=-2, axis2=-1).transpose(-1, *range(R.ndim - 2))
    wx, wy, wz = R[..., 2, 1] - R[..., 1, 2], R[..., 0, 2] - R[..., 2, 0], R[..., 1, 0] - R[..., 0, 1]
    xy, xz, yz = R[..., 0, 1] + R[..., 1, 0], R[..., 0, 2] + R[..., 2, 0], R[..., 1, 2] + R[..., 2, 1]
    rows = [
        [1.0 + x + y + z, wx, wy, wz],
        [wx, 1.0 + x - y - z, xy, xz],
        [wy, xy, 1.0 - x + y - z, yz],
        [wz, xz, yz, 1.0 - x - y + z],
    ]
    products = np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)
    largest = np.argmax(np.diagonal(products, axis1=-2, axis2=-1), axis=-1)
    quat = np.take_along_axis(products, largest[..., None, None], axis=-2)[..., 0, :]
    quat = quat / np.linalg.norm(quat, axis=-1, keepdims=True)
    return np.where(quat[..., :1] < 0.0, -quat, quat)


def rotation_with_z(axis: Floats) -> Floats:
    """Some rotation whose z axis is the unit vector `axis`; exact for coordinate axes, the identity for z itself."""
    axis = np.asarray(axis, dtype=float)
    helper = np.eye(3)[(int(np.argmax(np.abs(axis))) + 2) % 3]
    x = np.cross(helper, axis)
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(axis, x), axis])


def snap(R: Floats) -> Floats:
    """Round entries within 1e-15 of -1, 0, 1 onto them, so that right angles are exact."""
    nearest = np.rint(R)
    return np.where(np.abs(R - nearest) < 1e-15, nearest, R)


def check_rotation(R: Floats) -> None:
    """Raise `InputError` unless `R` is a rotation matrix [3, 3]."""
    if R.shape != (3, 3) or not np.all(np.isfinite(R)):
        raise InputError(f"a rotation matrix is 3 x 3 finite numbers, got shape {R.shape}")
    if np.abs(R @ R.T - np.eye(3)).max() > TOLERANCE or np.linalg.det(R) < 0:
        raise InputError("not a rotation matrix: R R^T must be the identity and det R = +1")


def rotation_angle(R: Floats) -> Floats:
    """Norm of the rotation vector of `R` [..., 3, 3] in [0, pi] rad, exact near 0 and near pi."""
    vector = np.stack([R[..., 2, 1] - R[..., 1, 2], R[..., 0, 2] - R[..., 2, 0], R[..., 1, 0] - R[..., 0, 1]], axis=-1)
    trace = np.trace(R, axis1=-2, axis2=-1)
    return np.arctan2(np.linalg.norm(vector, axis=-1), trace - 1.0)


def angle_between(a: Floats, b: Floats) -> Floats:
    """Angle between unit vectors [..., 3] in [0, pi] rad."""
    return np.arctan2(np.linalg.norm(np.cross(a, b), axis=-1), np.sum(a * b, axis=-1))
