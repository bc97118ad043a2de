"""Naive twin of the closed form of UR-type arms, beside those of `tests/reference.py`."""

import numpy as np
from scipy.spatial.transform import Rotation

from tests.reference import make_transform


def denavit_hartenberg(angle, d, a, alpha):
    """Rz(angle) Tz(d) Tx(a) Rx(alpha) [4, 4]."""
    turn = make_transform(Rotation.from_euler("z", angle).as_matrix(), [0.0, 0.0, d])
    return turn @ make_transform(Rotation.from_euler("x", alpha).as_matrix(), [a, 0.0, 0.0])


def solve_ur_arm(arm, T_carrier_tool):
    """All (theta1 .. theta6) of a UR-type arm by products of matrices and arc cosines [Hawkins2013], with a1 and a4."""
    quarter = np.pi / 2
    T06 = np.linalg.inv(arm.T_carrier_base) @ T_carrier_tool @ np.linalg.inv(arm.T_wrist_tool)
    (px, py), solutions = T06[:2, 3], []
    for shoulder in (1.0, -1.0):
        angle_1 = np.arctan2(py, px) + shoulder * np.arccos(arm.d4 / np.hypot(px, py)) + quarter
        z1 = np.array([np.sin(angle_1), -np.cos(angle_1), 0.0])
        for wrist in (1.0, -1.0):
            angle_5 = wrist * np.arccos(T06[:3, 2] @ z1)
            angle_6 = np.arctan2(-T06[:3, 1] @ z1 / np.sin(angle_5), T06[:3, 0] @ z1 / np.sin(angle_5))
            T45, T56 = (
                denavit_hartenberg(angle_5, arm.d5, 0.0, -quarter),
                denavit_hartenberg(angle_6, 0.0, 0.0, 0.0),
            )
            T01 = denavit_hartenberg(angle_1, 0.0, arm.a1, quarter)
            T14 = np.linalg.inv(T01) @ T06 @ np.linalg.inv(T45 @ T56)
            x, y, _ = (T14 @ np.linalg.inv(denavit_hartenberg(0.0, arm.d4, arm.a4, quarter)))[:3, 3]
            cosine = (x * x + y * y - arm.a2**2 - arm.a3**2) / (2.0 * arm.a2 * arm.a3)
            if abs(cosine) > 1.0:
                continue
            for elbow in (1.0, -1.0):
                angle_3 = elbow * np.arccos(cosine)
                angle_2 = np.arctan2(y, x) - np.arctan2(arm.a3 * np.sin(angle_3), arm.a2 + arm.a3 * np.cos(angle_3))
                T13 = denavit_hartenberg(angle_2, 0.0, arm.a2, 0.0) @ denavit_hartenberg(angle_3, 0.0, arm.a3, 0.0)
                T34 = np.linalg.inv(T13) @ T14
                solutions.append([angle_1, angle_2, angle_3, np.arctan2(T34[1, 0], T34[0, 0]), angle_5, angle_6])
    return np.reshape(solutions, (-1, 6))
