"""UR-type arms, found by their geometry: six revolute joints whose inverse kinematics has a closed form.

The last six joints towards the tool rotate about axes of which the second, third and fourth are parallel, the first is
perpendicular to the second, the fifth to the fourth, and the sixth perpendicular to the fifth and meets it, as in
Universal Robots' arms [Hawkins2013]. Names, zeros, signs, and where the arm is mounted do not matter. The first axis
may pass beside the second (a1), the fifth beside the fourth (a4): the formulas stay the same.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ikde.kernels.arrays import COORDINATE, PARENT, PRISMATIC, ClosedFormArrays, Floats, RobotArrays
from ikde.model.pack import pack_floats, pack_indices, pack_robot
from ikde.model.robot import Robot
from ikde.model.rotation import snap
from ikde.model.tree import transform

ALIGNED = 1e-9  # how far from parallel, perpendicular or meeting axes may be; m or rad
MIN_LENGTH_M = 1e-6  # a shorter link is no link
QUARTER_TURNS = (1, 0, 0, 1, -1, 0)  # of alpha in the Denavit-Hartenberg model
CHECKED, AGREEMENT = 20, 1e-9  # configurations at which an arm is checked, and how far it may be off; m and rad


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class URArm:
    """A UR-type arm as its closed form sees it: the angles theta = sign * q + offset of a Denavit-Hartenberg model.

    T_carrier_tool = T_carrier_base . A1(theta1) .. A6(theta6) . T_wrist_tool, where A = Rz(theta) Tz(d) Tx(a) Rx(alpha)
    with a = (a1, a2, a3, a4, 0, 0), d = (0, 0, 0, d4, d5, 0), alpha = (90, 0, 0, 90, -90, 0) deg, and a2, a3 > 0; what
    comes before the shoulder and after the wrist centre is in the two transforms. The base's z axis is joint 1's; where
    a length leaves a choice, axes point so that d4, d5 and the tool's height over the wrist are not negative.
    """

    carrier: int
    """Body that carries joint 1, as `pack_robot` counts and aligns bodies; 0 is the world."""
    coordinates: tuple[int, ...]
    """Index into q of each of the six joints."""
    T_carrier_base: Floats
    """[4, 4] m"""
    T_wrist_tool: Floats
    """[4, 4] m"""
    a1: float
    a2: float
    a3: float
    a4: float
    d4: float
    d5: float
    signs: Floats
    """[6] 1 or -1"""
    offsets: Floats
    """[6] rad"""

    def angles(self, q: Floats) -> Floats:
        """The model's angles [..., 6] in rad for configurations `q` [..., N] of the robot."""
        return self.signs * q[..., list(self.coordinates)] + self.offsets

    def tool_pose(self, angles: Floats) -> Floats:
        """T_carrier_tool [..., 4, 4] for the model's angles [..., 6]."""
        a = (self.a1, self.a2, self.a3, self.a4, 0.0, 0.0)
        d = (0.0, 0.0, 0.0, self.d4, self.d5, 0.0)
        T = self.T_carrier_base
        for k in range(6):
            T = T @ _denavit_hartenberg(angles[..., k], d[k], a[k], QUARTER_TURNS[k])
        return T @ self.T_wrist_tool


@lru_cache(maxsize=64)
def find_ur_arm(robot: Robot) -> URArm | None:
    """The UR-type arm that ends in the robot's tool, or None if its last six joints do not form one."""
    arrays = pack_robot(robot)
    chain = _last_six(arrays)
    if chain is None:
        return None
    Ts_carrier_body = np.array(_poses(arrays, chain, np.zeros(6)))
    if not _has_ur_axes(Ts_carrier_body[:6]):
        return None
    arm = _measure(arrays, chain, Ts_carrier_body)
    return arm if arm is not None and _agrees(arrays, chain, arm) else None


def find_still_arm(robot: Robot, lower: Floats, upper: Floats) -> URArm | None:
    """The robot's UR-type arm if nothing but its joints may move inside ranges [N]: eight branches are then all."""
    arm = find_ur_arm(robot)
    return arm if arm is not None and np.delete(upper - lower, arm.coordinates).max(initial=0.0) == 0.0 else None


def pack_ur_arm(arm: URArm, weights: Floats | None = None) -> ClosedFormArrays:
    """Pack an arm for the kernels; `weights` [N]: how much a radian of each joint counts as motion, by default 1."""
    own = np.ones(6) if weights is None else weights[list(arm.coordinates)]
    squares, scale = arm.a2 * arm.a2 + arm.a3 * arm.a3, 0.5 / (arm.a2 * arm.a3)
    return ClosedFormArrays(
        coordinates=pack_indices(arm.coordinates),
        transforms=pack_floats([np.linalg.inv(T)[:3] for T in (arm.T_carrier_base, arm.T_wrist_tool)]),
        lengths=pack_floats([arm.a1, arm.a2, arm.a3, arm.a4, arm.d4, arm.d5, squares, scale]),
        angles=pack_floats([arm.signs, arm.offsets, own]),
    )


def _last_six(arrays: RobotArrays) -> list[int] | None:
    """The bodies of the last six joints towards the tool, the first one first; None unless all of them are revolute."""
    body = int(arrays.frame_body[-1])
    chain: list[int] = []
    while body != 0 and len(chain) < 6:
        if arrays.bodies[body, PRISMATIC]:
            return None
        chain.append(body)
        body = int(arrays.bodies[body, PARENT])
    return chain[::-1] if len(chain) == 6 else None


def _denavit_hartenberg(angle: Floats, d: float, a: float, quarter_turns: int) -> Floats:
    """Rz(angle) Tz(d) Tx(a) Rx(quarter_turns * 90 deg) [..., 4, 4]; `quarter_turns` is -1, 0 or 1."""
    s, c, s_alpha, c_alpha = np.sin(angle), np.cos(angle), quarter_turns, 1 - abs(quarter_turns)
    T = np.zeros((*angle.shape, 4, 4))
    T[..., 0, 0], T[..., 0, 1], T[..., 0, 2], T[..., 0, 3] = c, -s * c_alpha, s * s_alpha, a * c
    T[..., 1, 0], T[..., 1, 1], T[..., 1, 2], T[..., 1, 3] = s, c * c_alpha, -c * s_alpha, a * s
    T[..., 2, 1], T[..., 2, 2], T[..., 2, 3], T[..., 3, 3] = s_alpha, c_alpha, d, 1.0
    return T


def _poses(arrays: RobotArrays, chain: list[int], q: Floats) -> list[Floats]:
    """T_carrier_body of the six bodies and then T_carrier_tool, [..., 4, 4] each, for joint values [..., 6]."""
    T, poses = np.eye(4), []
    for k, body in enumerate(chain):
        T = T @ _homogeneous(arrays.T_parent_body[body]) @ _denavit_hartenberg(q[..., k], 0.0, 0.0, 0)
        poses.append(T)
    return [*poses, T @ _homogeneous(arrays.T_body_frame[-1])]


def _homogeneous(T: Floats) -> Floats:
    return np.vstack([T, [0.0, 0.0, 0.0, 1.0]])


def _has_ur_axes(Ts_carrier_body: Floats) -> bool:
    """Whether six axes stand to each other as a UR arm's; each relation outlives every motion of the joints."""
    z, p = Ts_carrier_body[:, :3, 2], Ts_carrier_body[:, :3, 3]
    parallel = [np.linalg.norm(np.cross(z[i], z[j])) for i, j in ((1, 2), (1, 3))]
    perpendicular = [abs(z[i] @ z[j]) for i, j in ((0, 1), (3, 4), (4, 5))]
    gap = abs((p[5] - p[4]) @ np.cross(z[4], z[5]))
    return bool(max(*parallel, *perpendicular, gap) <= ALIGNED)


def _measure(arrays: RobotArrays, chain: list[int], Ts_carrier_body: Floats) -> URArm | None:
    """Read lengths, signs, zeros and the two transforms off the axes at q = 0."""
    axes, p, T_carrier_tool = Ts_carrier_body[:6, :3, 2], Ts_carrier_body[:6, :3, 3], Ts_carrier_body[6]
    # Where axes 5 and 6 meet: z5 and z6 are perpendicular, so the way along z5 does not depend on z6.
    wrist = p[4] + axes[4] * ((p[5] - p[4]) @ axes[4])
    up = axes[0]
    shoulder = p[0] + up * ((p[1] - p[0]) @ up)
    z1 = axes[1] * _sign((wrist - shoulder) @ axes[1])
    x1 = np.cross(up, z1)
    plane = np.array([x1, up])  # the links move in the plane of x1 and up; z1 points out of it
    p2, p3, p4, p5 = (plane @ (point - shoulder) for point in (*p[1:4], wrist))
    upper, fore, beyond = p3 - p2, p4 - p3, p5 - p4
    z4 = axes[4] * _sign(beyond @ (plane @ axes[4]))
    z5 = axes[5] * _sign((T_carrier_tool[:3, 3] - wrist) @ axes[5])
    x4 = np.cross(z1, z4)
    if min(np.linalg.norm(upper), np.linalg.norm(fore)) < MIN_LENGTH_M:
        return None
    angles = np.array([0.0, _angle(upper), _angle(fore), _angle(plane @ x4)])  # of x1, x2, x3 and x4 in the plane
    angle_5 = np.arctan2(-z5 @ x4, z5 @ z1)
    x5 = x4 * np.cos(angle_5) + z1 * np.sin(angle_5)
    T_carrier_base = transform(snap(np.column_stack([x1, -z1, up])), shoulder)
    T_carrier_wrist = transform(snap(np.column_stack([x5, np.cross(z5, x5), z5])), wrist)
    canonical = np.array([up, z1, z1, z1, z4, z5])
    return URArm(
        carrier=int(arrays.bodies[chain[0], PARENT]),
        coordinates=tuple(int(arrays.bodies[body, COORDINATE]) for body in chain),
        T_carrier_base=T_carrier_base,
        T_wrist_tool=np.linalg.inv(T_carrier_wrist) @ T_carrier_tool,
        a1=float(p2[0]),
        a2=float(np.linalg.norm(upper)),
        a3=float(np.linalg.norm(fore)),
        a4=float(beyond @ (plane @ x4)),
        d4=float((wrist - shoulder) @ z1),
        d5=float(beyond @ (plane @ z4)),
        signs=np.array([_sign(a @ b) for a, b in zip(canonical, axes, strict=True)]),
        offsets=np.array([0.0, *np.diff(angles), angle_5, 0.0]),
    )


def _agrees(arrays: RobotArrays, chain: list[int], arm: URArm) -> bool:
    """Whether the model puts the tool where the tree does, in configurations all over the place."""
    q = np.pi * np.sin(np.outer(7.0 * np.arange(CHECKED) + 1.0, np.arange(1.0, 7.0)))
    off = arm.tool_pose(arm.signs * q + arm.offsets) - _poses(arrays, chain, q)[6]
    return bool(np.abs(off).max() <= AGREEMENT)


def _sign(value: float) -> float:
    """1 or -1; 1 for what is 0 but for rounding."""
    return -1.0 if value < -ALIGNED else 1.0


def _angle(vector: Floats) -> float:
    return float(np.arctan2(vector[1], vector[0]))
