"""The judge of motions: made ones keep all limits, and each limit is broken on purpose, once."""

from dataclasses import replace

import numpy as np
import pytest

from ikde.errors import InputError
from ikde.model.base_motion import step_base
from ikde.model.collision_model import CollisionModel
from ikde.solver.forward import forward
from ikde.solver.plain import compute_gaps
from ikde.track.limits import MotionLimits
from ikde.track.path import ToolPath
from ikde.track.verify_track import verify_track

V, OMEGA, DT_S = 0.3, 0.5, 0.02


def make_q(robot, samples=11):
    """An arc of the base and even turns of the arm."""
    q = np.tile(robot.home, (samples, 1))
    for k in range(1, samples):
        q[k, :3] = step_base(q[k - 1, :3], np.array(V), np.array(OMEGA), DT_S)
    q[:, 4:] += 0.01 * np.arange(samples)[:, None]
    return q


def judge(robot, q, limits=None, drive="differential", along=None, detector="improved", **told):
    tool = forward(robot, q if along is None else along)["tool"]
    path = ToolPath.through(tool[:, :3, 3], dt_s=DT_S, R_world_tool=tool[:, :3, :3])
    limits = limits or MotionLimits.of(robot, **told)
    return verify_track(CollisionModel.of(robot, detector), path, q, drive=drive, limits=limits)


def test_figures_of_a_made_motion(qiao):
    q = make_q(qiao)
    found = judge(qiao, q)
    assert found.accepted
    np.testing.assert_allclose(found.v, V)
    np.testing.assert_allclose(found.omega, OMEGA)
    np.testing.assert_allclose(found.wheel_speeds, np.tile([1.705, 4.295], (10, 1)))
    np.testing.assert_allclose(found.speeds[:, 4:], 0.5)
    assert np.abs(found.sideways_m_s).max() < 1e-14
    assert (found.largest_axis_error_m, found.largest_orientation_error_rad) == pytest.approx((0, 0), abs=1e-7)
    gaps = compute_gaps(CollisionModel.of(qiao), q)
    assert found.clearance_m == gaps.min()


def test_errors_are_along_the_axes(qiao):
    q = make_q(qiao)
    shifted = q.copy()
    shifted[5, 1] += 2e-6
    found = judge(qiao, shifted, along=q, drive="omnidirectional")
    np.testing.assert_allclose(found.error_m[5], [0, 2e-6, 0], atol=1e-12)
    assert (found.largest_axis_error_m, found.total_error_m) == pytest.approx((2e-6, 2e-6))
    assert (found.violations.error, found.violations.total) == (1, 1)


def test_orientation_counts_where_it_is_asked_for(qiao):
    q = make_q(qiao)
    turned = q.copy()
    turned[3, 8] += 2e-4
    found = judge(qiao, turned, along=q)
    assert found.violations.error == 1
    assert found.largest_orientation_error_rad == pytest.approx(2e-4)


@pytest.mark.parametrize(
    ("told", "name", "count"),
    [
        ({"speed": np.array([0.5] * 8 + [0.49])}, "speed", 10),
        ({"speed": np.array([0.5, 0.29] + [2.0] * 7)}, "speed", 10),
        ({"speed": np.array([0.5, 0.5, 0.49] + [2.0] * 6)}, "speed", 10),
        ({"wheel_speed_rad_s": 4.2}, "wheel", 10),
        ({"max_distance_m": 0.9, "center": "Oc"}, "distance", 11),
    ],
)
def test_each_limit_is_looked_at(qiao, told, name, count):
    found = judge(qiao, make_q(qiao), **told)
    assert getattr(found.violations, name) == count
    assert not found.accepted


def test_acceleration_is_of_neighbouring_segments(qiao):
    q = make_q(qiao)
    q[6:, 7] += 0.002
    found = judge(qiao, q, acceleration=np.full(9, 4.0))
    assert found.violations.acceleration == 2
    assert judge(qiao, q, acceleration=np.full(9, 5.1)).accepted


def test_ranges_can_be_switched_off(qiao):
    q = make_q(qiao)
    q[7, 6] = qiao.upper[6] + 0.01
    loose = np.full(9, 1e3)
    assert judge(qiao, q, speed=loose).violations.range == 1
    assert judge(qiao, q, speed=loose, ranges=False).violations.range == 0


def test_an_arc_bulges_beyond_its_ends(qiao):
    start = np.array([qiao.upper[0] - 1e-6, 0.0, 0.5 * np.pi - 0.015])
    q = np.tile(qiao.home, (2, 1))
    q[0, :3], q[1, :3] = start, step_base(start, np.array(0.5), np.array(1.5), DT_S)
    q[:, 0] += qiao.upper[0] - q[:, 0].max()
    assert judge(qiao, q).violations.range == 1
    assert judge(qiao, q, drive="omnidirectional").violations.range == 0


def test_an_arc_that_only_might_bulge_does_not(qiao):
    """Along the end of its range a base may drive as long as it turns inwards."""
    start = np.array([qiao.upper[0], 0.0, 0.5 * np.pi])
    q = np.tile(qiao.home, (2, 1))
    for omega, violations in ((1.5, 0), (-1.5, 1)):
        q[0, :3], q[1, :3] = start, step_base(start, np.array(0.5), np.array(omega), DT_S)
        assert judge(qiao, q).violations.range == violations


def test_a_place_outside_is_counted_once(qiao):
    q = make_q(qiao)
    robot = replace(qiao, joints=(replace(qiao.joints[0], upper=float(q[-2, 0])), *qiao.joints[1:]))
    assert judge(robot, q).violations.range == 1
    assert judge(robot, q[::-1], speed=None).violations.range == 1


def test_arcs_leave_a_range_where_a_fine_walk_along_them_does(qiao, rng):
    found = []
    for _ in range(300):
        start, v, omega = rng.uniform(-4, 4, 3), rng.uniform(-20, 20), rng.uniform(-300, 300) * rng.choice([1, 1e-9])
        q = np.tile(qiao.home, (2, 1))
        q[0, :3], q[1, :3] = start, step_base(start, np.array(v), np.array(omega), DT_S)
        walk = step_base(start, np.full(300, v), np.full(300, omega), np.linspace(0.0, DT_S, 300))[:, :2]
        lower, upper, axis, room = np.full(2, -99.0), np.full(2, 99.0), rng.integers(2), rng.choice([1e-3, 1e-2])
        if rng.random() < 0.5:
            lower[axis] = q[:, axis].min() - room
        else:
            upper[axis] = q[:, axis].max() + room
        slides = [replace(j, lower=lower[k], upper=upper[k]) for k, j in enumerate(qiao.joints[:2])]
        turns = [replace(j, lower=-20.0, upper=20.0) for j in qiao.joints[2:]]
        beyond = np.maximum(lower - walk, walk - upper).max()
        if abs(beyond) > 2e-4:  # the walk's own coarseness
            found.append(beyond > 0.0)
            robot = replace(qiao, joints=(*slides, *turns))
            assert (judge(robot, q, speed=None, detector="none").violations.range > 0) is bool(found[-1])
    assert 20 < sum(found) < len(found) - 20


def test_sliding_sideways_is_a_violation_of_wheels_only(qiao):
    q = make_q(qiao)
    q[4:, 1] += 1e-5
    assert judge(qiao, q).violations.sideways == 1
    assert judge(qiao, q, drive="omnidirectional").violations.sideways == 0


def test_a_base_without_wheels_is_held_to_its_arc_but_to_no_wheel(qiao, unwheeled):
    q = make_q(qiao)
    found = judge(unwheeled, q)
    assert found.accepted
    np.testing.assert_allclose(found.v, V)
    assert found.wheel_speeds.shape == (10, 2)
    assert np.isnan(found.wheel_speeds).all()
    q[4:, 1] += 1e-5
    assert judge(unwheeled, q).violations.sideways == 1
    with pytest.raises(InputError, match=r"limits.wheel_speed_rad_s: qiao2021 has no wheels"):
        judge(unwheeled, q, wheel_speed_rad_s=4.2)


def test_collisions_are_counted_by_sample(qiao):
    q = make_q(qiao)
    q[2:5, 4] = 2.5
    found = judge(qiao, q, speed=None)
    assert found.violations.collision == 3


def test_at_the_safe_distance_it_is_a_collision(qiao):
    q = make_q(qiao)
    gaps = judge(qiao, q).gaps_m.min(axis=1)
    for safe_m, collisions in ((gaps.min(), 1), (np.nextafter(gaps.min(), 0.0), 0), (gaps.max(), len(q))):
        found = judge(qiao, q, detector=replace(CollisionModel.of(qiao).detector, safe_distance_m=float(safe_m)))
        assert found.violations.collision == collisions
        assert found.accepted is (collisions == 0)


def test_a_range_is_kept_to_1e_9(qiao):
    for outside, count in ((5e-10, 0), (5e-9, 1)):
        q = make_q(qiao)
        q[:, 4:] = qiao.home[4:]
        q[-1, 4] = qiao.upper[4] + outside
        assert judge(qiao, q, speed=None).violations.range == count


def test_without_a_detector_collision_is_not_checked(qiao):
    q = make_q(qiao)
    q[2:5, 4] = 2.5
    found = judge(qiao, q, speed=None, detector="none")
    assert (found.violations.collision, found.clearance_m) == (None, None)
    assert (found.violations.total, found.accepted) == (0, True)


@pytest.mark.parametrize("samples", [0, 1])
def test_nothing_is_no_motion(qiao, samples):
    q = make_q(qiao)
    tool = forward(qiao, q)["tool"]
    path = ToolPath.through(tool[:, :3, 3], dt_s=DT_S)
    told = {"limits": MotionLimits.of(qiao, acceleration=np.ones(9))}
    found = verify_track(CollisionModel.of(qiao), path, q[:samples], drive="differential", **told)
    assert found.accepted
    assert (found.speeds.shape, found.wheel_speeds.shape, len(found.error_m)) == ((0, 9), (0, 2), samples)
    assert (found.clearance_m is None) is (samples == 0)
