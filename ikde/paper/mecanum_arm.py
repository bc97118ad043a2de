"""The robot of [Zhang2022] as plain matrices, many configurations side by side: four mecanum wheels and Table 2's arm.

Speeds are those of ten actuators, wheels A to D (front left, rear left, rear right, front right) and six joints, as the
paper has them, or nine with the platform's X, Y and heading in place of the wheels.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.base_motion import move_base
from ikde.model.robot import Wheels
from ikde.model.wheels import twist_by_wheels, wheels_by_twist


def links_standard(a: Floats, d: Floats, alpha: Floats, theta: Floats) -> Floats:
    """Rz(theta) Tz(d) Tx(a) Rx(alpha) [..., 4, 4]: the standard convention of Denavit and Hartenberg."""
    c, s, ca, sa = np.cos(theta), np.sin(theta), np.cos(alpha), np.sin(alpha)
    return _fill([[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d], [0, 0, 0, 1]], theta)


def links_modified(a: Floats, d: Floats, alpha: Floats, theta: Floats) -> Floats:
    """Rx(alpha) Tx(a) Rz(theta) Tz(d) [..., 4, 4]: the modified convention, (4) and (5), whose a and alpha are those of
    the row before.
    """
    c, s, ca, sa = np.cos(theta), np.sin(theta), np.cos(alpha), np.sin(alpha)
    return _fill([[c, -s, 0, a], [s * ca, c * ca, -sa, -d * sa], [s * sa, c * sa, ca, d * ca], [0, 0, 0, 1]], theta)


def _fill(rows: list[list[Any]], like: Floats) -> Floats:
    T = np.empty((*np.shape(like), 4, 4))
    for i, row in enumerate(rows):
        for k, value in enumerate(row):
            T[..., i, k] = value
    return T


def chain(links: Floats) -> Floats:
    """T_base_link [..., n + 1, 4, 4] of links [..., n, 4, 4], the base itself first (6)."""
    Ts = np.empty((*links.shape[:-3], links.shape[-3] + 1, 4, 4))
    Ts[..., 0, :, :] = np.eye(4)
    for k in range(links.shape[-3]):
        Ts[..., k + 1, :, :] = Ts[..., k, :, :] @ links[..., k, :, :]
    return Ts


class Place(NamedTuple):
    """Where the tool is, and what moves it."""

    tool: Floats
    """[..., 3] m, in the world"""
    by_platform: Floats
    """[..., 3, 3]: velocity of the tool by X', Y' and phi'"""
    by_joints: Floats
    """[..., 3, 6]"""
    heading: Floats
    """[...]"""


@dataclass(frozen=True, slots=True, kw_only=True)
class MecanumArm:
    """Lengths of platform and arm."""

    a: Floats
    d: Floats
    alpha: Floats
    mount: Floats
    wheels: Wheels

    @classmethod
    def of(cls, numbers: Mapping[str, Any]) -> "MecanumArm":
        """From `zhang2022.yaml`: Table 2 with its signs, and what was calibrated."""
        published, derived, chosen = (numbers[kind] for kind in ("published", "derived", "calibrated"))
        return cls(
            a=np.array(published["table_2"]["a_m"], dtype=float),
            d=np.array(published["table_2"]["d_m"], dtype=float),
            alpha=0.5 * np.pi * np.array(derived["alpha_quarter_turns"]),
            mount=np.array(chosen["mount_m"]),
            wheels=Wheels(
                radius_m=0.5 * published["wheel_diameter_m"],
                half_track_m=chosen["half_track_m"],
                half_wheelbase_m=chosen["half_wheelbase_m"],
            ),
        )

    def place(self, platform: Floats, q: Floats) -> Place:
        """The tool (7) with the platform at X, Y, heading [..., 3] and the joints at [..., 6]."""
        Ts, R = chain(links_standard(self.a, self.d, self.alpha, q)), rotation_about_z(platform[..., 2])
        tip = Ts[..., 6, :3, 3]
        axes, arms = Ts[..., :6, :3, 2], tip[..., None, :] - Ts[..., :6, :3, 3]
        from_middle = (R @ (tip + self.mount)[..., None])[..., 0]
        by_platform = np.broadcast_to(np.diag([1.0, 1.0, 0.0]), (*platform.shape[:-1], 3, 3)).copy()
        by_platform[..., 0, 2], by_platform[..., 1, 2] = -from_middle[..., 1], from_middle[..., 0]
        shift = np.concatenate([platform[..., :2], np.zeros((*platform.shape[:-1], 1))], axis=-1)
        return Place(shift + from_middle, by_platform, R @ _cross(axes, arms).mT, platform[..., 2])

    def tasks_by_platform(self, place: Place) -> tuple[Floats, Floats]:
        """Of (19), R1 the tool and R2 the platform: their Jacobians [..., 3, 9] by X', Y', phi' and the joints."""
        J1 = np.concatenate([place.by_platform, place.by_joints], axis=-1)
        return J1, np.broadcast_to(np.eye(3, 9), J1.shape)

    def tasks_by_wheels(self, place: Place) -> tuple[Floats, Floats]:
        """The same by the ten actuators [..., 3, 10], as the paper has them (13, 17, 18)."""
        Jc = rotation_about_z(place.heading) @ twist_by_wheels(self.wheels)
        J1 = np.concatenate([place.by_platform @ Jc, place.by_joints], axis=-1)
        return J1, np.concatenate([Jc, np.zeros((*Jc.shape[:-1], 6))], axis=-1)

    def to_wheels(self, heading: Floats, x: Floats) -> Floats:
        """Nine speeds [..., 9] as those of ten actuators [..., 10], which then never work against each other (1)."""
        twist = (rotation_about_z(heading).mT @ x[..., :3, None])[..., 0]
        return np.concatenate([twist @ wheels_by_twist(self.wheels).T, x[..., 3:]], axis=-1)

    def advance(
        self, platform: Floats, q: Floats, actuators: Floats, dt_s: float, rolling: Floats | float = 1.0
    ) -> tuple[Floats, Floats]:
        """Where platform [..., 3] and joints [..., 6] are after `dt_s` of ten speeds [..., 10]: the exact arc.

        `rolling` [..., 1]: how much of each wheel's way the floor sees, 1 without slip.
        """
        twist = (actuators[..., :4] * rolling) @ twist_by_wheels(self.wheels).T
        return move_base(platform, twist, dt_s), q + dt_s * actuators[..., 4:]


def rotation_about_z(angle: Floats) -> Floats:
    """Rotations [..., 3, 3] about z by angles [...], rad."""
    R = np.zeros((*np.shape(angle), 3, 3))
    R[..., 0, 0] = R[..., 1, 1] = np.cos(angle)
    R[..., 1, 0] = np.sin(angle)
    R[..., 0, 1], R[..., 2, 2] = -R[..., 1, 0], 1.0
    return R


def _cross(a: Floats, b: Floats) -> Floats:
    """Cross products [..., 3], in a third of numpy's time."""
    x, y, z, u, v, w = a[..., 0], a[..., 1], a[..., 2], b[..., 0], b[..., 1], b[..., 2]
    return np.stack([y * w - z * v, z * u - x * w, x * v - y * u], axis=-1)
