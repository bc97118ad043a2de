"""Wheels, conventions and Jacobians of [Zhang2022] against other code and finite differences."""

from dataclasses import replace

import numpy as np
import pytest

import ikde
from ikde.model.wheels import ground_speed, slip_ratio, twist_by_wheels, wheels_by_twist
from ikde.paper.mecanum_arm import chain, links_modified, links_standard, rotation_about_z
from tests.paper.zhang import ARM, NUMBERS, START

RNG = np.random.default_rng(0)


def test_wheels_as_they_are_meant():
    forward, inverse = twist_by_wheels(ARM.wheels), wheels_by_twist(ARM.wheels)
    np.testing.assert_allclose(forward @ inverse, np.eye(3), atol=1e-15)
    np.testing.assert_allclose(forward, np.linalg.pinv(inverse), atol=1e-15)
    reach = 0.24 + 0.36
    expected = np.array([[1, -1, -reach], [1, 1, -reach], [1, -1, reach], [1, 1, reach]]) / 0.0825
    np.testing.assert_allclose(inverse, expected, atol=1e-12)


def test_whole_half_sizes_halve_the_turn():
    """The list of symbols says width and length; (1) needs half of both."""
    whole = replace(ARM.wheels, half_track_m=0.48, half_wheelbase_m=0.72)
    turning = wheels_by_twist(ARM.wheels) @ [0, 0, 1.0]
    assert (twist_by_wheels(whole) @ turning)[2] == pytest.approx(0.5, abs=1e-12)


def test_slip_and_its_inverse():
    """(14) solved for the ground's speed, beside (15)."""
    assert ground_speed(np.ones(1), 0.8)[0] == pytest.approx(0.2)
    assert slip_ratio(np.ones(1), np.full(1, 0.2))[0] == pytest.approx(0.8)
    for s in (-0.8, -0.1, 0.0, 0.5, 0.8):
        assert slip_ratio(np.ones(1), ground_speed(np.ones(1), s))[0] == pytest.approx(s)
    assert NUMBERS["published"]["slip"]["ratio"] == 0.8


def test_conventions_of_table_2():
    """The standard convention is the modified one with a and alpha a row down; read row by row with (5) it is not."""
    q = RNG.uniform(-3, 3, (50, 6))
    standard = chain(links_standard(ARM.a, ARM.d, ARM.alpha, q))[:, -1]
    down = chain(links_modified(np.r_[0, ARM.a[:-1]], ARM.d, np.r_[0, ARM.alpha[:-1]], q))[:, -1]
    np.testing.assert_allclose(down, standard, atol=1e-14)  # of the last row a and alpha are 0
    row_by_row = chain(links_modified(ARM.a, ARM.d, ARM.alpha, q))[:, -1]
    gaps = np.linalg.norm((row_by_row - standard)[:, :3, 3], axis=1)
    assert 0.7 < np.median(gaps) < 0.95
    assert 1.2 < gaps.max() < 2.0


def test_the_robot_file_is_this_arm():
    """But for d of joint 4, 0.1333 in the manufacturer's table, which is 0.3 mm."""
    robot = ikde.load_robot("ur5e_mecanum")
    right = replace(ARM, d=np.array([*ARM.d[:3], NUMBERS["derived"]["d4_m"], *ARM.d[4:]]))
    for _ in range(20):
        platform, q = RNG.uniform(-2, 2, 3), RNG.uniform(-3, 3, 6)
        both = np.r_[platform, q]
        tool = ikde.forward(robot, both)["tool"][:3, 3]
        np.testing.assert_allclose(right.place(platform, q).tool, tool, atol=1e-12)
        assert np.linalg.norm(ARM.place(platform, q).tool - tool) == pytest.approx(0.0003, abs=1e-9)
        J1, J2 = right.tasks_by_wheels(right.place(platform, q))
        np.testing.assert_allclose(J1, ikde.jacobian(robot, both, by="actuators")[:3], atol=1e-12)
        base = ikde.jacobian(robot, both, by="actuators", frame="platform")
        np.testing.assert_allclose(J2, base[[0, 1, 5]], atol=1e-12)


def test_jacobians_against_finite_differences():
    for _ in range(10):
        platform, q, x, h = RNG.uniform(-1, 1, 3), RNG.uniform(-3, 3, 6), RNG.standard_normal(10), 1e-6
        place = ARM.place(platform, q)
        J1, J2 = ARM.tasks_by_wheels(place)
        (ahead, q_ahead), (behind, q_behind) = (ARM.advance(platform, q, x, step) for step in (h, -h))
        change = ARM.place(ahead, q_ahead).tool - ARM.place(behind, q_behind).tool
        np.testing.assert_allclose(J1 @ x, change / (2 * h), atol=1e-8)
        np.testing.assert_allclose(J2 @ x, (ahead - behind) / (2 * h), atol=1e-8)


def test_many_places_are_each_as_alone():
    platform, q = RNG.uniform(-1, 1, (4, 3)), RNG.uniform(-3, 3, (4, 6))
    many = ARM.place(platform, q)
    for k in range(4):
        for part, own in zip(many, ARM.place(platform[k], q[k]), strict=True):
            np.testing.assert_allclose(part[k], own, atol=1e-15)


def test_nine_speeds_as_ten_actuators():
    """No wheel works against another, and platform and tool move as the nine speeds say."""
    platform, q, x = RNG.uniform(-1, 1, 3), START, RNG.standard_normal(9)
    place = ARM.place(platform, q)
    ten = ARM.to_wheels(place.heading, x)
    assert abs(ten[:4] @ [1, -1, -1, 1]) < 1e-13
    for by_wheels, by_platform in zip(ARM.tasks_by_wheels(place), ARM.tasks_by_platform(place), strict=True):
        np.testing.assert_allclose(by_wheels @ ten, by_platform @ x, atol=1e-13)


def test_slipping_wheels_turn_the_twist_nowhere():
    x = np.r_[RNG.standard_normal(4), np.zeros(6)]
    whole, _ = ARM.advance(np.zeros(3), START, x, 1e-3)
    part, _ = ARM.advance(np.zeros(3), START, x, 1e-3, np.full(1, 0.2))
    np.testing.assert_allclose(part, 0.2 * whole, atol=1e-5)


def test_rotations_about_z():
    np.testing.assert_allclose(rotation_about_z(np.array(0.3)) @ [1, 0, 0], [np.cos(0.3), np.sin(0.3), 0], atol=1e-15)
