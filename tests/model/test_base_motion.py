"""Bases: which robots have one that carries all that can collide; arcs and twists are each other's inverse."""

from dataclasses import replace

import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from ikde.model.base_motion import (
    NO_BASE,
    base_joints,
    base_twist,
    dead_reckon,
    find_base_frame,
    find_planar_base,
    find_wheels,
    move_base,
    need_base,
    step_base,
    twist_at,
    usual_drive,
)
from ikde.model.robot import SphereRow, Wheels
from tests.random_robots import make_frame, make_robot


def make_base(*, axes=((1, 0, 0), (0, 1, 0), (0, 0, 1)), shift=(0, 0, 0.1), kinds=("prismatic",) * 2 + ("revolute",)):
    """Three joints in a row with a mast on top."""
    frames = [
        make_frame("along", "world", joint="x", axis=axes[0]),
        make_frame("across", "along", joint="y", axis=axes[1]),
        make_frame("platform", "across", shift, joint="turn", axis=axes[2]),
        make_frame("tool", "platform", (0.2, 0, 1.0)),
    ]
    return make_robot(dict(zip(("x", "y", "turn"), kinds, strict=True)), frames)


def test_robots_with_a_base_and_without(qiao):
    for robot in (qiao, ikde.load_robot("qiao2021_dh"), make_base()):
        assert find_planar_base(robot).tolist() == [0, 1, 2]
    for name in ("ur5", "panda"):
        assert find_planar_base(ikde.load_robot(name)).tolist() == NO_BASE.tolist() == [-1, -1, -1]


def test_how_far_it_may_go_does_not_matter(qiao):
    joints = tuple(replace(joint, lower=joint.home, upper=joint.home) for joint in qiao.joints[:3])
    assert find_planar_base(replace(qiao, joints=(*joints, *qiao.joints[3:]))).tolist() == [0, 1, 2]


def test_axes_kinds_and_places_must_be_those_of_a_plane():
    for wrong in (
        {"axes": ((1, 0, 0), (0, 0, 1), (0, 1, 0))},
        {"axes": ((0, 1, 0), (1, 0, 0), (0, 0, 1))},
        {"axes": ((1, 0, 0), (0, 1, 0), (0, 0, -1))},
        {"kinds": ("prismatic", "revolute", "revolute")},
        {"shift": (0.3, 0, 0.1)},
    ):
        assert find_planar_base(make_base(**wrong)).tolist() == [-1, -1, -1]


def test_it_carries_all_that_can_collide(qiao):
    post = SphereRow(component="post", start="world", end="world", radius_m=0.1)
    spheres = {"improved": (*qiao.approximations["improved"], post)}
    told = {"approximations": spheres, "detectors": {"improved": qiao.detectors["improved"]}}
    unseen = replace(qiao, **told)
    assert find_planar_base(unseen).tolist() == [0, 1, 2]
    seen = {"formula_22": (*qiao.pair_lists["formula_22"], ("post", "LT"))}
    assert find_planar_base(replace(unseen, pair_lists=seen)).tolist() == [-1, -1, -1]


def test_a_twist_is_what_an_arc_was_driven_with(rng):
    start = rng.uniform(-1, 1, (200, 3))
    v, omega = rng.uniform(-1, 1, 200), rng.uniform(-3, 3, 200)
    omega[:3] = 0.0, 1e-9, -1e-5
    end = step_base(start, v, omega, 0.3)
    found = base_twist(start, end, 0.3)
    np.testing.assert_allclose(found[0], v, atol=1e-12)
    np.testing.assert_allclose(found[1], omega, atol=1e-12)
    np.testing.assert_allclose(found[2], 0.0, atol=1e-14)


def test_half_an_arc_twice_is_the_arc(rng):
    start, v, omega = rng.uniform(-1, 1, 3), np.array(0.7), np.array(-2.0)
    once = step_base(start, v, omega, 0.4)
    np.testing.assert_allclose(step_base(step_base(start, v, omega, 0.2), v, omega, 0.2), once, atol=1e-15)


def test_a_quarter_turn():
    end = step_base(np.zeros(3), np.array(0.5 * np.pi), np.array(0.5 * np.pi), 1.0)
    np.testing.assert_allclose(end, [1.0, 1.0, 0.5 * np.pi], atol=1e-15)


def test_sliding_sideways_is_told():
    residual = base_twist(np.array([0, 0, 0.3]), np.array([-np.sin(0.3), np.cos(0.3), 0.3]), 0.5)[2]
    assert residual == pytest.approx(2.0)


def test_what_is_refused(qiao):
    with pytest.raises(InputError, match="no planar base"):
        find_wheels(ikde.load_robot("panda"), "differential")
    with pytest.raises(InputError, match="expected one of differential, omnidirectional"):
        find_wheels(qiao, "tracked")


def test_a_base_stays_one_with_narrow_ranges(qiao):
    joints = tuple(replace(joint, lower=-0.5, upper=0.5) if joint.name == "q_z" else joint for joint in qiao.joints)
    narrow = replace(qiao, joints=joints)
    assert find_wheels(narrow, "differential").tolist() == [0, 1, 2]
    assert base_joints(narrow) == ("d_x", "d_y", "q_z")


def test_a_base_that_slides_runs_on_an_arc_as_well(rng):
    start, twist = rng.uniform(-1, 1, (50, 3)), rng.uniform(-2, 2, (50, 3))
    twist[0, 2] = 0.0
    straight = twist * [1.0, 0.0, 1.0]
    driven = step_base(start, twist[:, 0], twist[:, 2], 0.3)
    np.testing.assert_allclose(move_base(start, straight, 0.3), driven, rtol=0, atol=1e-15)
    half = move_base(start, twist, 0.15)
    np.testing.assert_allclose(move_base(half, twist, 0.15), move_base(start, twist, 0.3), rtol=0, atol=1e-14)
    quarter = move_base(np.zeros(3), np.array([0.0, 0.5 * np.pi, 0.5 * np.pi]), 1.0)
    np.testing.assert_allclose(quarter, [-1.0, 1.0, 0.5 * np.pi], rtol=0, atol=1e-15)


def test_dead_reckoning_closes_a_turn_to_rounding():
    """[Zhang2022, eq. 2] with the old heading in each step is up to 5.4 mm off in a turn of 60 s, in steps of 0.1 s."""
    twist = np.array([0.05, 0.02, 2.0 * np.pi / 60.0])
    places = dead_reckon(np.zeros(3), np.tile(twist, (600, 1)), 0.1)
    assert np.hypot(*places[-1, :2]) < 1e-13
    np.testing.assert_allclose(places[300, :2], [-0.38197186, 0.95492966], rtol=0, atol=1e-8)
    old = sum(turned(twist[:2], heading) * 0.1 for heading in places[:-1, 2])
    assert np.hypot(*old) < 1e-12  # a whole turn closes in any case ...
    late = sum(turned(twist[:2], heading) * 0.1 for heading in places[:300, 2]) - places[300, :2]
    assert 4e-3 < np.hypot(*late) < 6e-3  # ... half of one does not


def turned(vector, angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c * vector[0] - s * vector[1], s * vector[0] + c * vector[1]])


def test_the_arms_foot_behind_the_wheels_axle_moves_sideways(rng):
    """[DongZhao, eq. 1, 2, 6]: M lies l_m behind the axle's middle; the axle never slips sideways."""
    l_m, b, heading = 0.1, 0.4, 0.7
    vr, vl = rng.uniform(-1, 1, 2)
    twist = np.array([0.5 * (vr + vl), 0.0, (vr - vl) / b])
    foot = turned(twist_at(twist, np.array([-l_m, 0.0]))[:2], heading)
    printed = [
        0.5 * (vr + vl) * np.cos(heading) + l_m * np.sin(heading) * (vr - vl) / b,
        0.5 * (vr + vl) * np.sin(heading) - l_m * np.cos(heading) * (vr - vl) / b,
    ]
    np.testing.assert_allclose(foot, printed, rtol=0, atol=1e-15)
    vx, vy = turned(twist[:2], heading)
    assert vx * np.sin(heading) - vy * np.cos(heading) == pytest.approx(0.0, abs=1e-15)


def test_wheels_belong_to_their_drive(qiao):
    four = Wheels(radius_m=0.08, half_track_m=0.3, half_wheelbase_m=0.4)
    mecanum = replace(qiao, wheels=four)
    assert (usual_drive(mecanum), find_wheels(mecanum, "mecanum").tolist()) == ("mecanum", [-1, -1, -1])
    assert find_wheels(replace(qiao, wheels=None), "mecanum").tolist() == [-1, -1, -1]
    with pytest.raises(InputError, match="drive: qiao2021 has mecanum wheels: expected mecanum or omnidirectional"):
        find_wheels(mecanum, "differential")
    with pytest.raises(InputError, match="the wheels of qiao2021 give no `half_wheelbase`, which mecanum wheels have"):
        find_wheels(qiao, "mecanum")


def test_a_robot_says_itself_how_its_base_drives(qiao):
    assert usual_drive(qiao) == "differential"
    assert usual_drive(replace(qiao, drive="omnidirectional")) == "omnidirectional"
    assert usual_drive(replace(ikde.load_robot("ur5"), drive="differential")) == "omnidirectional"  # it has no base


def test_a_base_that_must_be_there_is_named(qiao):
    assert need_base(qiao) == (0, 1, 2)
    with pytest.raises(InputError, match=r"base: ur5 has no planar base \(x, y, yaw\)"):
        need_base(ikde.load_robot("ur5"))


def test_a_base_stands_at_its_joints(qiao):
    q = qiao.home.copy()
    q[:3] = 0.3, -0.7, 1.0
    assert ikde.forward(qiao, q)[find_base_frame(qiao)][:2, 3] == pytest.approx((0.3, -0.7))
