"""Dong and Zhao's claims: what holds, and the counter-example of what does not."""

from dataclasses import replace

import numpy as np
import pytest

from ikde.paper.manipulability_claims import (
    compute_claims,
    compute_rigidity,
    draw_arms,
    find_best_theta1_deg,
    list_singular,
    measure,
    solve_singular_deg,
)
from ikde.paper.tracked_arm import (
    CHAINS,
    TrackedArm,
    compute_base_jacobian,
    compute_jacobian,
    compute_w1,
    compute_w2,
)

ARM = TrackedArm(links_m=(0.3, 0.25, 0.2), arm_offset_m=0.1, track_m=0.4)
PLAIN = replace(ARM, arm_offset_m=0.0)


@pytest.fixture(scope="module")
def claims():
    return {claim.claim: claim for claim in compute_claims(ARM)}


def shown(claim):
    return [entry.value for entry in claim.shown]


def test_every_claim_has_its_verdict(claims):
    assert [claim.verdict for claim in claims.values()] == [
        *(
            "true",
            "true",
            "half true",
            "half true",
            "only for l_m = 0",
            "only for l_m = 0",
            "false",
            "too strong",
            "false",
        )
    ]


def test_the_heading_changes_neither_measure(claims):
    """To 1e-12: w2 of itself; w1, whose determinant loses half its digits near 0, of what its entries allow."""
    for claim in list(claims.values())[:2]:
        assert 0.0 <= shown(claim)[0] < 1e-12
    for arm, theta in draw_arms(ARM, 0.1, 50):
        for heading in (-2.0, 1.0):
            J1, J2 = compute_base_jacobian(arm, theta, heading), compute_jacobian(arm, theta, heading)
            assert measure(J2) == pytest.approx(compute_w2(arm, theta), rel=1e-9, abs=1e-13)
            assert abs(measure(J1) - compute_w1(arm, theta)) <= 1e-12 * np.trace(J1 @ J1.T) ** 2


def test_w1_is_largest_at_0_only_where_the_arm_points_backward(claims):
    """w1 = (l_m + K cos theta1)^2 / b^2 with K = -R: a tie without l_m; with it at 0 if K > 0, else at 180."""
    tie, larger, tie_offset, larger_offset = shown(claims["w1 is largest at theta1 = 0"])
    assert (tie, larger, tie_offset) == (1.0, 0.0, 0.0)
    assert 0.4 < larger_offset < 0.6
    for arm, theta in draw_arms(ARM, 0.1, 40):
        turned = np.tile(theta, (361, 1))
        turned[:, 0] = np.radians(np.arange(-180, 181))
        best = turned[int(compute_w1(arm, turned).argmax()), 0]
        at_90 = compute_w1(arm, [0.5 * np.pi, *theta[1:]])
        backward = compute_w1(arm, [0.0, *theta[1:]]) > compute_w1(arm, [np.pi, *theta[1:]])
        assert abs(best) == pytest.approx(0.0 if backward else np.pi)
        assert at_90 == pytest.approx((0.1 / arm.track_m) ** 2, rel=1e-12)


def test_w2_may_be_largest_elsewhere(claims):
    without, with_offset = shown(claims["so is w2 (implied: it names no theta1)"])
    assert 0.10 < without < 0.20
    assert 0.02 < with_offset < 0.10
    places = [(arm, theta, find_best_theta1_deg(arm, theta)) for arm, theta in draw_arms(ARM, 0.1, 60)]
    arm, theta, place = next(entry for entry in places if entry[2] not in (0.0, 180.0))
    here, front, rear = (compute_w2(arm, [np.radians(at), *theta[1:]]) for at in (place, 0.0, 180.0))
    assert here > 1.0001 * max(front, rear)


def test_listed_configurations_are_singular_without_an_offset_alone(claims):
    listed = [row for row in list_singular(ARM) if row.listed]
    assert len(listed) == 2 + 9
    assert max(row.w1_without_offset for row in listed) < 1e-15
    assert [row.w1_with_offset for row in listed] == pytest.approx([0.1**2 / 0.4**2] * 11, rel=1e-12)
    for name in ("w1 = 0 at theta1 = ±90", "w1 = 0 at theta2 = 90, theta3 and theta4 each 0 or ±180"):
        assert shown(claims[name]) == pytest.approx([0.0, 0.0625, 0.0625], abs=1e-15)


def test_others_are_singular_too(rng):
    """On the whole surface l_m = R cos theta1: also (80.2141, 45.8366, -118.1790) at any theta1 without an offset."""
    unlisted = [row for row in list_singular(ARM) if not row.listed]
    assert [min(row.w1_without_offset, row.w1_with_offset) for row in unlisted] == pytest.approx([0, 0], abs=1e-15)
    assert unlisted[0].w1_without_offset < 1e-15 < unlisted[0].w1_with_offset
    assert unlisted[1].w1_with_offset < 1e-15 < unlisted[1].w1_without_offset
    for first in rng.uniform(-np.pi, np.pi, 5):
        assert compute_w1(PLAIN, [first, *np.radians([80.2141, 45.8366, -118.1790])]) < 1e-12


def test_for_any_other_angles_there_is_a_singular_theta2(rng):
    solved = 0
    for third, fourth in rng.uniform(-180, 180, (50, 2)):
        try:
            second = solve_singular_deg(ARM, (10.0, 0.0, third, fourth))
        except ValueError as error:
            assert "are wanted" in str(error)
            continue
        solved += 1
        assert compute_w1(ARM, np.radians([10.0, second, third, fourth])) < 1e-15
    assert solved > 40


def test_where_w1_is_0_the_base_still_moves_e_along_a_line(claims):
    largest, least = shown(claims["where w1 = 0 the platform contributes nothing to E in the plane"])
    assert largest > 0.7
    assert least < 1e-12


def test_mirror_images_are_no_single_optimum(claims):
    mirror, half_turn, with_offset = shown(claims["there is one optimum (implied)"])
    assert mirror < 1e-11
    assert half_turn < 1e-11
    assert with_offset > 10.0


def test_the_printed_chain_changes_its_length_and_the_rigid_ones_do_not():
    rows = [compute_rigidity(replace(ARM, chain=chain)) for chain in CHAINS]
    assert [row["is_rigid"] for row in rows] == [False, True, True, True]
    assert [round(1e3 * (row["largest_m"] - row["least_m"]), 6) for row in rows] == [pytest.approx(500, abs=5), 0, 0, 0]


def test_random_arms_are_the_same_for_every_offset():
    first, again = draw_arms(ARM, 0.0, 5), draw_arms(ARM, 0.1, 5)
    for (a, theta), (b, same) in zip(first, again, strict=True):
        assert (a.links_m, a.track_m, b.arm_offset_m) == (b.links_m, b.track_m, 0.1)
        assert theta.tolist() == same.tolist()
