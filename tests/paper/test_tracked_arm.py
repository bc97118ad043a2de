"""Dong and Zhao's equations: written out as they print them, against derivatives, and against closed forms."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from ikde.paper.tracked_arm import (
    CHAINS,
    PRINTED,
    RIGID,
    Chain,
    TrackedArm,
    compute_base_jacobian,
    compute_curvature,
    compute_end,
    compute_jacobian,
    compute_reach,
    compute_slope,
    compute_w1,
    compute_w2,
)

LENGTHS = {"links_m": (0.3, 0.25, 0.2), "arm_offset_m": 0.1, "track_m": 0.4}
ARM = TrackedArm(**LENGTHS)
every_chain = pytest.mark.parametrize("chain", CHAINS, ids=lambda chain: chain.name)


def postures(rng, count=200):
    """Rows theta [count, 4] and headings [count]."""
    return rng.uniform(-np.pi, np.pi, (count, 4)), rng.uniform(-np.pi, np.pi, count)


def read_print(l1, l2, l3, l4, lm, b, theta, heading):
    """Q [2, 4] below (10), A [3, 6] of (11) and J1 [2, 2] of (12), letter by letter."""
    t1, t2, t3, t4 = theta
    c, s, a, z = np.cos(t1), np.sin(t1), np.cos(heading), np.sin(heading)
    c2, c23, c234 = np.cos([t2, t2 + t3, t2 + t3 + t4])
    s2, s23, s234 = np.sin([t2, t2 + t3, t2 + t3 + t4])
    L = l3 + l4
    Q11 = s * (l1 * c2 - l2 * c23 - L * c234)
    Q12 = c * (l1 * s2 - l2 * s23 - L * s234)
    Q13 = -c * (l2 * s23 + L * s234)
    Q14 = -c * (L * s234)
    Q21 = -c * (l1 * c2 - l2 * c23 - L * c234)
    Q22 = s * (l1 * s2 - l2 * s23 - L * s234)
    Q23 = -s * (l2 * s23 + L * s234)
    Q24 = -s * (L * s234)
    A = [
        [
            *(a * (0.5 + Q11 / b) + z * (lm - Q21) / b, a * (0.5 - Q11 / b) - z * (lm - Q21) / b),
            *(a * Q - z * P for Q, P in ((Q11, Q21), (Q12, Q22), (Q13, Q23), (Q14, Q24))),
        ],
        [
            *(z * (0.5 + Q11 / b) - a * (lm - Q21) / b, z * (0.5 - Q11 / b) + a * (lm - Q21) / b),
            *(z * Q + a * P for Q, P in ((Q11, Q21), (Q12, Q22), (Q13, Q23), (Q14, Q24))),
        ],
        [0, 0, 0, l1 * c2 + l2 * c23 - L * c234, l2 * c23 - L * c234, -L * c234],
    ]
    J1 = np.array([[a, -z], [z, a]]) @ [[0.5 + Q11 / b, 0.5 - Q11 / b], [-lm / b + Q21 / b, lm / b - Q21 / b]]
    return np.array(A), J1, lm - Q21


def drive(arm, theta, heading, speeds, dt):
    """E after `dt` s of constant speeds of the tracks and joints [6], from P at the origin; dt may be complex."""
    right, left, *rates = speeds
    omega, v = (right - left) / arm.track_m, 0.5 * (right + left)
    end = heading + omega * dt
    if omega:
        x, y = v / omega * (np.sin(end) - np.sin(heading)), v / omega * (np.cos(heading) - np.cos(end))
    else:
        x, y = v * dt * np.cos(heading), v * dt * np.sin(heading)
    return compute_end(arm, np.array([x, y, end]), theta + np.array(rates) * dt)


def test_the_jacobians_are_those_that_are_printed(rng):
    for theta, heading in zip(*postures(rng), strict=True):
        A, J1, across = read_print(0.3, 0.25, 0.12, 0.08, 0.1, 0.4, theta, heading)
        np.testing.assert_allclose(compute_jacobian(ARM, theta, heading), A, rtol=0, atol=1e-14)
        np.testing.assert_allclose(compute_base_jacobian(ARM, theta, heading), J1, rtol=0, atol=1e-14)
        assert compute_w1(ARM, theta) == pytest.approx((across / 0.4) ** 2, rel=1e-12, abs=1e-15)


@every_chain
def test_j2_is_the_derivative_of_e_by_speeds_of_tracks_and_joints(chain, rng):
    """(1) to (11): complex steps to rounding; central differences along driven arcs to 1.6e-8 relative."""
    arm = replace(ARM, chain=chain)
    for theta, heading in zip(*postures(rng, 30), strict=True):
        J = compute_jacobian(arm, theta, heading)
        exact, central = np.empty((3, 6)), np.empty((3, 6))
        for k, speeds in enumerate(np.eye(6)):
            exact[:, k] = drive(arm, theta, heading, speeds, 1e-30j).imag / 1e-30
            there, back = (drive(arm, theta, heading, speeds, side * 1e-6) for side in (1, -1))
            central[:, k] = (there - back) / 2e-6
        np.testing.assert_allclose(J, exact, rtol=0, atol=1e-14)
        np.testing.assert_allclose(J, central, rtol=0, atol=1.6e-8 * np.abs(J).max())


def test_first_two_columns_of_j2_are_j1(rng):
    theta, heading = postures(rng)
    J1, J2 = compute_base_jacobian(ARM, theta, heading), compute_jacobian(ARM, theta, heading)
    np.testing.assert_array_equal(J2[:, :2, :2], J1)
    assert not J2[:, 2, :3].any()


def test_the_constraint_6_holds_while_it_drives():
    """The middle of the axle never moves along the axle; M, behind it, does."""
    still = replace(ARM, links_m=(0.0, 0.0, 0.0))
    for offset, slips in ((0.0, False), (0.1, True)):
        moved = (
            drive(replace(still, arm_offset_m=offset), np.zeros(4), 0.7, (0.8, 0.3, 0, 0, 0, 0), 1e-30j).imag / 1e-30
        )
        across = moved[0] * np.sin(0.7) - moved[1] * np.cos(0.7)
        assert (abs(across) > 0.01) == slips


def test_square_of_13_is_the_square_of_j1s_determinant(rng):
    theta, heading = postures(rng)
    J1 = compute_base_jacobian(ARM, theta, heading)
    R = compute_reach(ARM, theta).outward
    np.testing.assert_allclose(np.linalg.det(J1), (0.1 - R * np.cos(theta[:, 0])) / 0.4, rtol=0, atol=1e-14)
    np.testing.assert_allclose(compute_w1(ARM, theta), np.linalg.det(J1) ** 2, rtol=0, atol=1e-13)
    unsquared = np.abs(0.1 - R * np.cos(theta[:, 0])) / 0.4**2  # as the second line is printed, with 1/b^2
    assert np.abs(compute_w1(ARM, theta) - unsquared).max() > 1.0


def test_w1_is_the_distance_of_e_from_the_axle_over_the_track(rng):
    theta, heading = postures(rng)
    base = np.column_stack([*rng.uniform(-1, 1, (2, len(theta))), heading])
    E = compute_end(ARM, base, theta)
    ahead = np.column_stack([np.cos(heading), np.sin(heading)])
    distance = ((E[:, :2] - base[:, :2]) * ahead).sum(axis=1)
    np.testing.assert_allclose(compute_w1(ARM, theta), (distance / 0.4) ** 2, rtol=0, atol=1e-13)


@every_chain
def test_w2_in_closed_form_is_the_determinant(chain, rng):
    arm, (theta, heading) = replace(ARM, chain=chain), postures(rng)
    J = compute_jacobian(arm, theta, heading)
    size = np.trace(J @ J.swapaxes(1, 2), axis1=1, axis2=2) ** 3
    gap = np.abs(compute_w2(arm, theta) - np.linalg.det(J @ J.swapaxes(1, 2)))
    assert (gap / size).max() < 1e-14
    theta[:, 0] = 0.0
    reach = compute_reach(arm, theta)
    R, r, k = reach.outward, np.array(reach.d_outward), np.array(reach.d_upward)
    plane = (0.5 + (r * r).sum(axis=0)) * (k * k).sum(axis=0) - (r * k).sum(axis=0) ** 2
    at_zero = (2 * (0.1 - R) ** 2 / 0.4**2 + R**2) * plane
    np.testing.assert_allclose(compute_w2(arm, theta), at_zero, rtol=1e-12)


def test_j2_in_the_plane_of_the_arm(rng):
    """Rows outward, sideward, upward after turning by theta1 + heading, for any theta1."""
    for theta, heading in zip(*postures(rng, 50), strict=True):
        reach, (c1, s1) = compute_reach(ARM, theta), (np.cos(theta[0]), np.sin(theta[0]))
        R, lm, b, both = reach.outward, 0.1, 0.4, theta[0] + heading
        rotation = np.array([[np.cos(both), np.sin(both), 0], [-np.sin(both), np.cos(both), 0], [0, 0, 1]])
        expected = [
            [c1 / 2 - lm * s1 / b, c1 / 2 + lm * s1 / b, 0, *reach.d_outward],
            [-s1 / 2 + (R - lm * c1) / b, -s1 / 2 - (R - lm * c1) / b, R, 0, 0, 0],
            [0, 0, 0, *reach.d_upward],
        ]
        np.testing.assert_allclose(rotation @ compute_jacobian(ARM, theta, heading), expected, rtol=0, atol=1e-14)


def test_z_of_7_with_l3_alone_is_not_what_9_derives(rng):
    """With l3 + l4 in z (9) is exact; with l3 it is off by up to l4."""
    theta, _ = postures(rng)
    B = np.array(compute_reach(ARM, theta).d_upward).T
    for links, off in (((0.3, 0.25, 0.2), 0.0), ((0.3, 0.25, 0.12), 0.08)):
        height = [
            compute_reach(replace(ARM, links_m=links), theta + 1e-30j * unit).upward.imag for unit in np.eye(4)[1:]
        ]
        gap = np.abs(B - np.array(height).T / 1e-30).max()
        assert gap == pytest.approx(off, abs=1e-14 if off == 0.0 else 1e-3)


def test_7_is_not_a_rigid_arm():
    turning = np.linspace(0, 2 * np.pi, 100_001)
    theta = np.column_stack([0 * turning, turning, 0 * turning + 0.7, 0 * turning + 0.5])
    reach = compute_reach(ARM, theta)
    length = np.hypot(reach.outward, reach.upward)
    assert (round(length.min(), 3), round(length.max(), 3)) == (0.044, 0.544)
    straight = theta * [1, 1, 0, 0]
    step = compute_reach(ARM, straight + 1e-30j * np.eye(4)[1])
    slope = (step.outward**2 + step.upward**2).imag / 1e-30
    np.testing.assert_allclose(slope, 4 * 0.25 * (0.3 - 0.2) * np.sin(2 * turning), rtol=0, atol=1e-15)


def test_a_chain_is_rigid_with_one_sign_in_both_or_opposite_in_all(rng):
    turning = rng.uniform(-np.pi, np.pi, (40, 4)) * [0, 1, 0, 0] + [0, 0, 0.7, 0.5]
    signs = list(product((1, -1), repeat=3))
    rigid = 0
    for outward, upward in product(signs, repeat=2):
        chain = Chain(name="", outward=outward, upward=upward)
        reach = compute_reach(replace(ARM, chain=chain), turning)
        stays = bool(np.ptp(np.hypot(reach.outward, reach.upward)) < 1e-12)
        assert stays == chain.is_rigid == (upward in (outward, tuple(-sign for sign in outward)))
        rigid += stays
    assert rigid == 16
    assert [chain.is_rigid for chain in CHAINS] == [False, True, True, True]
    assert (CHAINS[0], CHAINS[1]) == (PRINTED, RIGID)


def test_slope_and_curvature_are_those_of_log_w2(rng):
    for theta in postures(rng, 10)[0]:
        steps = 1e-6 * np.eye(4)
        ups, downs = (np.log(compute_w2(ARM, theta + side * steps)) for side in (1, -1))
        np.testing.assert_allclose(compute_slope(ARM, theta), (ups - downs) / 2e-6, rtol=1e-5, atol=1e-5)
        bent = [(compute_slope(ARM, theta + s) - compute_slope(ARM, theta - s)) / 2e-6 for s in steps]
        np.testing.assert_allclose(compute_curvature(ARM, theta), bent, rtol=1e-3, atol=1e-3)
