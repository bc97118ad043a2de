"""The equations of Dong and Zhao's tracked mobile manipulator in plain numpy: their Jacobians and both measures.

P is the middle of the wheels' axle, M the foot of the arm, `arm_offset_m` behind it; E, the arm's end, is moved by four
of its joints. Angles are in rad, lengths in m, speeds in m/s and rad/s; theta is [..., 4], theta1 .. theta4. Numbers in
brackets are the paper's equations. A `Chain` says how links point: `PRINTED` as (7) has them, which is no rigid arm,
`RIGID` as one that can be built.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ikde.kernels.arrays import Floats


@dataclass(frozen=True, slots=True, kw_only=True)
class Chain:
    """The signs of the three links, outward and upward: a rigid chain has the same in both, or the opposite in all."""

    name: str
    outward: tuple[int, int, int]
    upward: tuple[int, int, int]

    @property
    def is_rigid(self) -> bool:
        """Whether its links keep their angles while one joint turns."""
        return len({a * b for a, b in zip(self.outward, self.upward, strict=True)}) == 1


PRINTED = Chain(name="as printed", outward=(-1, 1, 1), upward=(1, 1, -1))
RIGID = Chain(name="rigid", outward=(1, 1, 1), upward=(1, 1, 1))
FIRST_BACKWARD = Chain(name="rigid, link 1 backward", outward=(-1, 1, 1), upward=(-1, 1, 1))
LAST_DOWNWARD = Chain(name="rigid, link 3 reversed", outward=(1, 1, -1), upward=(1, 1, -1))
CHAINS = (PRINTED, RIGID, FIRST_BACKWARD, LAST_DOWNWARD)


@dataclass(frozen=True, slots=True, kw_only=True)
class TrackedArm:
    """Lengths of the vehicle, of which none is printed; the third link is l3 + l4, which never stand apart."""

    links_m: tuple[float, float, float]
    arm_offset_m: float  # l_m, from P backward to M
    track_m: float  # b, between the wheels
    chain: Chain = PRINTED


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Reach:
    """Where E is in the plane of the arm, seen from M, and the derivatives by theta2, theta3, theta4; arrays [...]."""

    outward: Floats  # R
    upward: Floats
    d_outward: tuple[Floats, Floats, Floats]  # r2, r3, r4
    d_upward: tuple[Floats, Floats, Floats]  # k2, k3, k4: (9)'s B12, B13, B14


def compute_reach(arm: TrackedArm, theta: ArrayLike) -> Reach:
    """E in the plane of the arm; `theta` may be complex."""
    second = np.asarray(theta)[..., 1]
    third = second + np.asarray(theta)[..., 2]
    angles = (second, third, third + np.asarray(theta)[..., 3])
    c, s = [np.cos(angle) for angle in angles], [np.sin(angle) for angle in angles]
    out, up = (np.multiply(arm.links_m, signs).tolist() for signs in (arm.chain.outward, arm.chain.upward))
    return Reach(
        outward=out[0] * c[0] + out[1] * c[1] + out[2] * c[2],
        upward=up[0] * s[0] + up[1] * s[1] + up[2] * s[2],
        d_outward=_sum_from_each(-out[0] * s[0], -out[1] * s[1], -out[2] * s[2]),
        d_upward=_sum_from_each(up[0] * c[0], up[1] * c[1], up[2] * c[2]),
    )


def _sum_from_each(first: Floats, second: Floats, third: Floats) -> tuple[Floats, Floats, Floats]:
    """A joint moves its own link and all behind it."""
    return first + second + third, second + third, third


def compute_end(arm: TrackedArm, base: Floats, theta: ArrayLike) -> Floats:
    """E [..., 3] in the world (1, 7) for P and the heading, `base` [..., 3]."""
    x, y, heading = np.moveaxis(np.asarray(base), -1, 0)
    reach, yaw = compute_reach(arm, theta), np.asarray(theta)[..., 0] + heading
    return np.stack(
        [
            x - arm.arm_offset_m * np.cos(heading) + reach.outward * np.cos(yaw),
            y - arm.arm_offset_m * np.sin(heading) + reach.outward * np.sin(yaw),
            reach.upward + 0.0 * heading,
        ],
        axis=-1,
    )


def compute_arm_jacobian(arm: TrackedArm, theta: ArrayLike) -> Floats:
    """Q [..., 2, 4] below (10): velocity of E over M by theta1' + heading', theta2' .. theta4', in the base's frame."""
    reach, first = compute_reach(arm, theta), np.asarray(theta)[..., 0]
    c, s = np.cos(first), np.sin(first)
    Q = np.empty((*np.shape(first), 2, 4), dtype=np.result_type(theta, float))
    Q[..., 0, 0], Q[..., 1, 0] = -reach.outward * s, reach.outward * c
    for k, r in enumerate(reach.d_outward, start=1):
        Q[..., 0, k], Q[..., 1, k] = r * c, r * s
    return Q


def compute_base_jacobian(arm: TrackedArm, theta: ArrayLike, heading: Floats | float = 0.0) -> Floats:
    """J1 [..., 2, 2] of (12): velocity of E in the plane by the speeds of the right and the left wheel."""
    Q, b = compute_arm_jacobian(arm, theta), arm.track_m
    along, across = Q[..., 0, 0] / b, (arm.arm_offset_m - Q[..., 1, 0]) / b
    J = np.stack([np.stack([0.5 + along, 0.5 - along], axis=-1), np.stack([-across, across], axis=-1)], axis=-2)
    return _turn(heading) @ J


def compute_jacobian(arm: TrackedArm, theta: ArrayLike, heading: Floats | float = 0.0) -> Floats:
    """J2 [..., 3, 6] of (11): velocity of E by v_r, v_l, theta1', theta2', theta3', theta4'."""
    Q = compute_arm_jacobian(arm, theta)
    J = np.zeros((*Q.shape[:-2], 3, 6), dtype=Q.dtype)
    J[..., :2, :2] = compute_base_jacobian(arm, theta, heading)
    J[..., :2, 2:] = _turn(heading) @ Q
    J[..., 2, 3:] = np.stack(compute_reach(arm, theta).d_upward, axis=-1)
    return J


def _turn(heading: Floats | float) -> Floats:
    c, s = np.cos(heading), np.sin(heading)
    return np.stack([np.stack([c, -s], axis=-1), np.stack([s, c], axis=-1)], axis=-2)


def compute_w1(arm: TrackedArm, theta: ArrayLike) -> Floats:
    """det(J1 J1^T) [...] of (13), with its square: the distance of E from the wheels' axle, over the track, squared."""
    across = arm.arm_offset_m - compute_reach(arm, theta).outward * np.cos(np.asarray(theta)[..., 0])
    return (across / arm.track_m) ** 2


def compute_w2(arm: TrackedArm, theta: ArrayLike) -> Floats:
    """det(J2 J2^T) [...] of (15), written out in the plane of the arm; `theta` may be complex."""
    reach, first = compute_reach(arm, theta), np.asarray(theta)[..., 0]
    c, s, R = np.cos(first), np.sin(first), reach.outward
    turn, ahead = arm.arm_offset_m * s / arm.track_m, (R - arm.arm_offset_m * c) / arm.track_m
    (r2, r3, r4), (k2, k3, k4) = reach.d_outward, reach.d_upward
    outward = 0.5 * c**2 + 2.0 * turn**2 + r2**2 + r3**2 + r4**2
    sideward = 0.5 * s**2 + 2.0 * ahead**2 + R**2
    upward = k2**2 + k3**2 + k4**2
    outward_sideward = -0.5 * c * s - 2.0 * turn * ahead
    outward_upward = r2 * k2 + r3 * k3 + r4 * k4
    return upward * (outward * sideward - outward_sideward**2) - outward_upward**2 * sideward


def compute_slope(arm: TrackedArm, theta: ArrayLike) -> Floats:
    """The gradient [..., 4] of log w2 by theta, a radian, exact to rounding (complex steps)."""
    steps = np.asarray(theta)[..., None, :] + 1e-30j * np.eye(4)
    w = compute_w2(arm, steps)
    return w.imag / w.real / 1e-30


def compute_curvature(arm: TrackedArm, theta: ArrayLike) -> Floats:
    """The second derivatives [..., 4, 4] of log w2, from central differences of its slope."""
    step, at = 1e-5, np.asarray(theta)[..., None, :]
    up, down = (compute_slope(arm, at + side * np.eye(4)) for side in (step, -step))
    bent = (up - down) / (2.0 * step)
    return 0.5 * (bent + np.swapaxes(bent, -1, -2))
