"""All configurations of a UR-type arm that put its tool at a pose, in closed form [Hawkins2013].

The arm is a `ClosedFormArrays`; `model.closed_form.URArm` describes it. First come sines and cosines, the *sides* of
all angles, then the angles, all at once, then the joints. Each side is computed from what the ones before it have
settled, so that an angle which is badly determined near a singularity does not spoil the pose.

What branches takes numbers, what takes arrays runs straight on: around a branch numba counts the users of an array, and
that cost 0.35 of 0.6 us.
"""

import math
from typing import NamedTuple

import numpy as np

from ikde.kernels.arrays import Floats, Ints
from ikde.kernels.jit import inline_kernel
from ikde.kernels.trig import full_angle, sin_cos

BRANCHES = 8
ANGLES = 20  # theta1, theta5, theta6, theta2 + theta3 + theta4 of each shoulder, then three of each shoulder and wrist
RIGHT, DOWN, FLIP = 1, 2, 4  # bits of a branch's code; `solver.families` describes them
SLACK = 1e-12  # rad, or a share: how far a cosine may be beyond 1, and a joint beyond its limit, to be set on it
SINGULAR = 1e-12  # sine of theta5 below which theta6 is free; m from axis 1 below which theta1 is
TWO_PI = 2.0 * math.pi
A1, A2, A3, A4, D4, D5, SQUARES, SCALE = range(8)  # of `ClosedFormArrays.lengths`
# Indices without a sign, for being arguments: numba compiles a function anew for every literal integer.
Q1, Q2, Q3, Q4, Q5, Q6 = (np.uint64(k) for k in range(6))
X, Y, Z = (np.uint64(k) for k in range(3))


class Room(NamedTuple):
    """What an attempt of an arm that stands still writes to."""

    T_world_carrier: Floats  # [3, 4]
    T_carrier_tool: Floats  # [3, 4]
    sides: Floats  # [2, ANGLES]
    solutions: Floats  # [BRANCHES, 6] rad
    codes: Ints  # [BRANCHES]
    far: Floats  # [BRANCHES] the least is tried first
    q: Floats  # [N]


@inline_kernel
def find_base_wrist_row(arm, row, T_carrier_tool):
    """One row of T_base_wrist = T_base_carrier @ T_carrier_tool @ T_tool_wrist: four numbers."""
    A, T = arm.transforms, T_carrier_tool
    x = A[0, row, 0] * T[0, 0] + A[0, row, 1] * T[1, 0] + A[0, row, 2] * T[2, 0]
    y = A[0, row, 0] * T[0, 1] + A[0, row, 1] * T[1, 1] + A[0, row, 2] * T[2, 1]
    z = A[0, row, 0] * T[0, 2] + A[0, row, 1] * T[1, 2] + A[0, row, 2] * T[2, 2]
    p = A[0, row, 0] * T[0, 3] + A[0, row, 1] * T[1, 3] + A[0, row, 2] * T[2, 3] + A[0, row, 3]
    return (
        x * A[1, 0, 0] + y * A[1, 1, 0] + z * A[1, 2, 0],
        x * A[1, 0, 1] + y * A[1, 1, 1] + z * A[1, 2, 1],
        x * A[1, 0, 2] + y * A[1, 1, 2] + z * A[1, 2, 2],
        x * A[1, 0, 3] + y * A[1, 1, 3] + z * A[1, 2, 3] + p,
    )


@inline_kernel
def find_centre(arm, ranges):
    """Theta1 where joint 1 is at ranges[2]."""
    return arm.angles[0, 0] * ranges[2, arm.coordinates[0]] + arm.angles[1, 0]


@inline_kernel
def find_shoulder(px, py, radius, d4, square, fallback):
    """Sides of theta1 for a wrist centre at (px, py), `radius` along x1, sign included, and d4 along z1.

    On axis 1, where theta1 is free, it is `fallback`. `square`: px^2 + py^2.
    """
    if square < SINGULAR * SINGULAR:
        return sin_cos(fallback)
    return (py * radius + px * d4) / square, (px * radius - py * d4) / square


@inline_kernel
def find_wrist(rows, s1, c1, s_free, c_free):
    """Sides of theta5 >= 0, theta6 and the angle theta2 + theta3 + theta4.

    Where axes 4 and 6 are parallel, that angle is free: (s_free, c_free), of any length, are its sides. `rows`: of
    T_base_wrist.
    """
    (xx, yx, zx, _), (xy, yy, zy, _), (xz, yz, _, _) = rows
    # Components of the wrist's axes along x1 and, out of the arm's plane, along z1.
    x, y = c1 * xx + s1 * xy, c1 * yx + s1 * yy
    x_out, y_out, z_out = s1 * xx - c1 * xy, s1 * yx - c1 * yy, s1 * zx - c1 * zy
    s5 = math.sqrt(x_out * x_out + y_out * y_out)
    if s5 < SINGULAR:
        s6, c6 = -(c_free * y + s_free * yz), c_free * x + s_free * xz
        length = math.sqrt(s6 * s6 + c6 * c6)
        s6, c6 = (s6 / length, c6 / length) if length > 0.0 else (0.0, 1.0)
    else:
        s6, c6 = -y_out / s5, x_out / s5
    # Axis 5 is -y5 = -(s6 x6 + c6 y6) = (sin, -cos of the angle), however uncertain theta6 was.
    return s5, z_out, s6, c6, -(s6 * x + c6 * y), s6 * xz + c6 * yz


@inline_kernel
def clip_cosine(value):
    """A cosine that may be off by rounding, in [-1, 1]; NaN for what is no cosine."""
    return min(max(value, -1.0), 1.0) if abs(value) <= 1.0 + SLACK else math.nan


@inline_kernel
def write_sides(k, s, c, out_sides):
    """Write one sine and cosine."""
    out_sides[0, k], out_sides[1, k] = s, c


@inline_kernel
def write_links(arm, k, x, y, out_sides):
    """Sides of the links' three angles when axis 4 is at (x, y) in the arm's plane; NaN if they do not reach that far.

    The bend theta3 >= 0, the direction of axis 4, and the angle between it and the upper arm, from column `k` on.
    """
    c3 = clip_cosine((x * x + y * y - arm.lengths[SQUARES]) * arm.lengths[SCALE])
    s3 = math.sqrt((1.0 - c3) * (1.0 + c3))
    write_sides(k, s3, c3, out_sides)
    write_sides(k + 1, y, x, out_sides)
    write_sides(k + 2, arm.lengths[A3] * s3, arm.lengths[A2] + arm.lengths[A3] * c3, out_sides)


@inline_kernel
def write_shoulder(arm, ranges, rows, square, right, radius, out_sides):
    """Sides of the ten angles of one shoulder: `ANGLES` says where. `radius`: of the wrist centre along x1, signed."""
    d4, a4, d5 = arm.lengths[D4], arm.lengths[A4], arm.lengths[D5]
    px, py, height = rows[0][3], rows[1][3], rows[2][3]
    s1, c1 = find_shoulder(px, py, radius, d4, square, find_centre(arm, ranges))
    ahead = radius - arm.lengths[A1]
    # A free angle puts the wrist centre in line with axes 2 and 4: as near and as far as the links can be asked to go.
    s_free, c_free = height * a4 + ahead * d5, ahead * a4 - height * d5
    s5, c5, s6, c6, s_234, c_234 = find_wrist(rows, s1, c1, s_free, c_free)
    k, links = 4 * right, 8 + 6 * right
    write_sides(k, s1, c1, out_sides)
    write_sides(k + 1, s5, c5, out_sides)
    write_sides(k + 2, s6, c6, out_sides)
    write_sides(k + 3, s_234, c_234, out_sides)
    x, y = a4 * c_234 + d5 * s_234, a4 * s_234 - d5 * c_234  # from axis 4 to the wrist centre, without a flip
    write_links(arm, links, ahead - x, height - y, out_sides)
    write_links(arm, links + 3, ahead + x, height + y, out_sides)


@inline_kernel
def fit_joint(arm, ranges, joint, angle):
    """(joint value for an angle of the model, in the turn inside its range nearest ranges[2]; whether there is one)."""
    k = arm.coordinates[joint]
    lower, upper = ranges[0, k], ranges[1, k]
    value = arm.angles[0, joint] * (angle - arm.angles[1, joint])
    value -= TWO_PI * np.rint((value - ranges[2, k]) * (1.0 / TWO_PI))
    value -= TWO_PI if value > upper + SLACK else 0.0
    value += TWO_PI if value < lower - SLACK else 0.0
    inside = (value >= lower - SLACK) & (value <= upper + SLACK)
    return min(max(value, lower), upper), inside


@inline_kernel
def solve_ur_arm(arm, ranges, T_carrier_tool, work, out_q, out_branch):
    """Write every configuration of the arm that puts its tool at a pose, and return how many there are.

    `ranges` [3, N]: rows lower and upper limit of all the robot's joints, rad, and the centre, `near` or the middle:
    what is beyond the limits is left out, and a joint stands in the turn nearest the centre. `T_carrier_tool` [3, 4] m:
    the tool in the body that carries joint 1. `work` [2, ANGLES]. `out_q` [8, 6]: the six joints; `out_branch` [8]
    int64: the code of each row. Left comes before right, no flip before flip, up before down; two shoulders or elbows
    that coincide count once.

    If joint 1 is free (the wrist centre on axis 1), it takes the centre; if joint 6 is (axes 4 and 6 parallel),
    the wrist centre takes its place in line with axes 2 and 4, on either side.
    """
    rows = (
        find_base_wrist_row(arm, X, T_carrier_tool),
        find_base_wrist_row(arm, Y, T_carrier_tool),
        find_base_wrist_row(arm, Z, T_carrier_tool),
    )
    px, py, d4 = rows[0][3], rows[1][3], arm.lengths[D4]
    square = px * px + py * py
    radial = square - d4 * d4
    if not radial >= -2.0 * SLACK * square - SINGULAR * SINGULAR:
        return 0
    radius = math.sqrt(max(radial, 0.0))
    first = 1 if radius == 0.0 else 0
    for right in range(first, 2):
        write_shoulder(arm, ranges, rows, square, right, radius if right else -radius, work)
    for k in range(work.shape[1]):  # not ANGLES: a loop of unknown length is vectorised, a short one unrolled
        work[0, k] = full_angle(work[0, k], work[1, k])
    count = 0
    for right in range(first, 2):
        q1, fits_1 = fit_joint(arm, ranges, Q1, work[0, 4 * right])
        angle_5, angle_6, angle_234 = work[0, 4 * right + 1], work[0, 4 * right + 2], work[0, 4 * right + 3]
        for flip in range(2):
            half_turn = math.pi * flip
            q5, fits_5 = fit_joint(arm, ranges, Q5, (1.0 - 2.0 * flip) * angle_5)
            q6, fits_6 = fit_joint(arm, ranges, Q6, angle_6 + half_turn)
            k = 8 + 6 * right + 3 * flip
            bend, direction, ahead = work[0, k], work[0, k + 1], work[0, k + 2]
            if not (fits_1 & fits_5 & fits_6 & (bend >= 0.0)):
                continue
            straight = (bend == 0.0) | (bend == math.pi)
            for elbow in range(1 if straight else 2):
                side = 1.0 if elbow == right else -1.0
                angle_2, angle_3 = direction - side * ahead, side * bend
                q2, fits_2 = fit_joint(arm, ranges, Q2, angle_2)
                q3, fits_3 = fit_joint(arm, ranges, Q3, angle_3)
                q4, fits_4 = fit_joint(arm, ranges, Q4, angle_234 + half_turn - angle_2 - angle_3)
                if fits_2 & fits_3 & fits_4:
                    out_q[count, 0], out_q[count, 1], out_q[count, 2] = q1, q2, q3
                    out_q[count, 3], out_q[count, 4], out_q[count, 5] = q4, q5, q6
                    out_branch[count] = RIGHT * right + DOWN * elbow + FLIP * flip
                    count += 1
    return count
