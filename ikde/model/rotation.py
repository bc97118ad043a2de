"""Rotation matrices: made from what users write, checked, and compared. Plain numpy, radians."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ikde.errors import InputError
from ikde.kernels.arrays import Floats

TOLERANCE = 1e-6  # how far R R^T may be from the identity before it is no rotation
ROUNDED = 1e-14  # how far it is of products of rotations in double precision


def rotation_about(axis: Floats, angle_rad: ArrayLike) -> Floats:
    """Rotation matrices [..., 3, 3] about a unit `axis` [3] by angles [...] (Rodrigues)."""
    x, y, z = axis
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    angle = np.asarray(angle_rad, dtype=float)[..., None, None]
    return np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * (K @ K)


def rotation_from_rpy(rpy_rad: Floats) -> Floats:
    """Rotations [..., 3, 3] from roll, pitch, yaw [..., 3] about the fixed x, y, z axes, as URDF defines them:
    Rz(yaw) Ry(pitch) Rx(roll)."""
    roll, pitch, yaw = np.moveaxis(np.asarray(rpy_rad, dtype=float), -1, 0)
    x, y, z = np.eye(3)
    return snap(rotation_about(z, yaw) @ rotation_about(y, pitch) @ rotation_about(x, roll))


def rotation_from_quat_wxyz(quat_wxyz: Floats) -> Floats:
    """Rotations [..., 3, 3] from quaternions [..., 4], w first; they are normalised.

    Raises `InputError` for a zero quaternion.
    """
    w, x, y, z = np.moveaxis(np.asarray(quat_wxyz, dtype=float), -1, 0)
    norm = np.sqrt(w * w + x * x + y * y + z * z)
    if not np.all(norm > 1e-12):
        raise InputError("a quaternion of length 0 is no rotation; expected one of another length")
    w, x, y, z = w / norm, x / norm, y / norm, z / norm
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


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
    """Some rotations [..., 3, 3] whose z axes are the unit vectors `axis` [..., 3].

    Exact for coordinate axes, the identity for z itself.
    """
    axis = np.asarray(axis, dtype=float)
    helper = np.eye(3)[(np.argmax(np.abs(axis), axis=-1) + 2) % 3]
    x = np.cross(helper, axis)
    x = x / length(x)[..., None]
    return np.stack([x, np.cross(axis, x), axis], axis=-1)


def length(vectors: Floats) -> Floats:
    """Lengths [...] of vectors [..., 3]: element by element, so that a vector's bits do not depend on others."""
    x, y, z = np.moveaxis(vectors, -1, 0)
    return np.sqrt(x * x + y * y + z * z)


def snap(R: Floats) -> Floats:
    """Round entries within 1e-15 of -1, 0, 1 onto them, so that right angles are exact."""
    nearest = np.rint(R)
    return np.where(np.abs(R - nearest) < 1e-15, nearest, R)


def check_rotation(R: Floats) -> None:
    """Raise `InputError` unless `R` is a rotation matrix [3, 3]."""
    if R.shape != (3, 3) or not np.all(np.isfinite(R)):
        raise InputError(f"a rotation matrix is 3 x 3 finite numbers, got shape {R.shape}")
    if not are_rotations(R):
        raise InputError("not a rotation matrix: R R^T must be the identity and det R = +1")


def are_rotations(R: Floats) -> NDArray[np.bool_]:
    """Whether finite matrices [..., 3, 3] are rotations [...]."""
    return (measure_skew(R) <= TOLERANCE) & (np.linalg.det(R) >= 0.0)


def is_rotation(R: Floats) -> bool:
    """The same of one finite matrix [3, 3], in a tenth of the time."""
    a, b, c = R.tolist()
    x, y, z = b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]
    return _measure_rows(a, b, c) <= TOLERANCE and a[0] * x + a[1] * y + a[2] * z >= 0.0


def straighten(R: Floats) -> Floats:
    """The rotation nearest to one of rounded numbers [3, 3]; `R` itself, to the bit, if it is one in double precision.

    Distances that are compared assume rotations: one of single precision moves the corner of a hall by 1e-6 m.
    """
    if _measure_rows(*R.tolist()) <= ROUNDED:
        return R
    U, _, Vt = np.linalg.svd(R)
    return U @ Vt


def _measure_rows(a: list[float], b: list[float], c: list[float]) -> float:
    """Largest entry of R R^T - 1 of a matrix of three rows."""
    pairs = ((a, a, 1.0), (b, b, 1.0), (c, c, 1.0), (a, b, 0.0), (a, c, 0.0), (b, c, 0.0))
    return max(abs(u[0] * v[0] + u[1] * v[1] + u[2] * v[2] - one) for u, v, one in pairs)


def measure_skew(R: Floats) -> Floats:
    """Largest entry [...] of R R^T - 1, of matrices [..., 3, 3]: 0 for rotations."""
    return np.abs(R @ np.swapaxes(R, -1, -2) - np.eye(3)).max(axis=(-1, -2))


def rotation_angle(R: Floats) -> Floats:
    """Norm of the rotation vector of `R` [..., 3, 3] in [0, pi] rad, exact near 0 and near pi."""
    vector = np.stack([R[..., 2, 1] - R[..., 1, 2], R[..., 0, 2] - R[..., 2, 0], R[..., 1, 0] - R[..., 0, 1]], axis=-1)
    trace = np.trace(R, axis1=-2, axis2=-1)
    return np.arctan2(np.linalg.norm(vector, axis=-1), trace - 1.0)


def angle_between(a: Floats, b: Floats) -> Floats:
    """Angle between unit vectors [..., 3] in [0, pi] rad."""
    return np.arctan2(np.linalg.norm(np.cross(a, b), axis=-1), np.sum(a * b, axis=-1))
