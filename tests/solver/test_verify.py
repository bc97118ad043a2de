"""The judge: errors against known displacements, limits exactly on the bound, and all three needed to accept."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import ikde
from ikde.errors import InputError
from ikde.model.collision_model import CollisionModel
from ikde.solver.verify import compute_orientation_errors, verify_many
from tests.conftest import random_q

ANGLES = (0.0, 1e-12, 1e-7, 0.3, np.pi / 2, 3.0, np.pi - 1e-9, np.pi)


def tool_pose(robot, q):
    return ikde.forward(robot, q)[robot.tool]


def turned(R, axis, angle):
    return R @ Rotation.from_rotvec(angle * np.array(axis)).as_matrix()


def here(robot, q):
    return ikde.Target(tool_pose(robot, q)[:3, 3])


@pytest.mark.parametrize("offset", [(0, 0, 0), (3e-3, 0, -4e-3), (0, 1.0, 0)])
def test_the_position_error_is_the_distance(qiao, offset):
    target = ikde.Target(tool_pose(qiao, qiao.home)[:3, 3] + np.array(offset))
    graded = ikde.verify(qiao, target, qiao.home)
    assert graded.position_error_m == pytest.approx(np.linalg.norm(offset), abs=1e-15)
    assert graded.orientation_error_rad == 0.0


@pytest.mark.parametrize("axis", [(1, 0, 0), (0, 1, 0), (0, 0, 1), (0.6, 0, 0.8), (-0.48, 0.6, 0.64)])
@pytest.mark.parametrize("angle", ANGLES)
def test_a_pose_off_by_a_known_angle_is_off_by_that_angle(qiao, axis, angle):
    T = tool_pose(qiao, qiao.home)
    target = ikde.Target(T[:3, 3], R_world_tool=turned(T[:3, :3], axis, angle))
    graded = ikde.verify(qiao, target, qiao.home)
    assert graded.orientation_error_rad == pytest.approx(angle, abs=2e-15 if angle < 3.0 else 1e-14)
    assert graded.position_error_m == 0.0


@pytest.mark.parametrize("angle", ANGLES)
def test_an_axis_target_sees_tilt_and_not_the_turn_about_the_axis(qiao, angle):
    T = tool_pose(qiao, qiao.home)
    turned_about_z = turned(T[:3, :3], (0, 0, 1), angle)
    tilted = turned(T[:3, :3], (0.6, 0.8, 0), angle)
    for R, expected in ((turned_about_z, 0.0), (tilted, angle)):
        target = ikde.Target(T[:3, 3], axis_world_tool=2.5 * R[:, 2])
        assert ikde.verify(qiao, target, qiao.home).orientation_error_rad == pytest.approx(expected, abs=1e-14)


def test_a_position_target_has_no_orientation_error(rng):
    R = Rotation.random(rng=rng).as_matrix()
    assert compute_orientation_errors([ikde.Target((0, 0, 0))], (R)[None])[0] == 0.0


@pytest.mark.parametrize("side", ["lower", "upper"])
@pytest.mark.parametrize("index", range(9))
def test_exactly_on_a_limit_is_inside_and_one_bit_beyond_is_not(qiao, side, index):
    q = qiao.home
    q[index] = getattr(qiao, side)[index]
    assert ikde.verify(qiao, here(qiao, q), q, collision="none").accepted
    q[index] = np.nextafter(q[index], -np.inf if side == "lower" else np.inf)
    graded = ikde.verify(qiao, here(qiao, q), q, collision="none")
    assert graded.within_tolerance
    assert graded.outside_limits == (qiao.joint_names[index],)
    assert not graded.accepted


def test_the_tolerance_itself_is_within(qiao):
    T = tool_pose(qiao, qiao.home)
    target = ikde.Target(T[:3, 3] + [0, 0, 1e-3], R_world_tool=turned(T[:3, :3], (1, 0, 0), 1e-3))
    graded = ikde.verify(qiao, target, qiao.home)
    exact = {
        "position_tolerance_m": graded.position_error_m,
        "orientation_tolerance_rad": graded.orientation_error_rad,
    }
    assert ikde.verify(qiao, target, qiao.home, settings=ikde.SolveSettings(**exact)).within_tolerance
    for name, value in exact.items():
        tighter = ikde.SolveSettings(**exact | {name: float(np.nextafter(value, 0.0))})
        assert not ikde.verify(qiao, target, qiao.home, settings=tighter).accepted


@pytest.mark.parametrize("reachable", [True, False])
@pytest.mark.parametrize("inside", [True, False])
@pytest.mark.parametrize("free", [True, False])
def test_only_all_three_are_accepted(qiao, reachable, inside, free):
    q = qiao.home
    if not inside:
        q[0] = 5.1
    if not free:
        q[4:6] = 2.6, 2.6
    target = here(qiao, q) if reachable else ikde.Target((0, 0, 9))
    graded = ikde.verify(qiao, target, q)
    assert graded.within_tolerance is reachable
    assert (graded.outside_limits == ()) is inside
    assert graded.collision is not free
    assert graded.accepted is (reachable and inside and free)


def test_clearance_and_pairs_are_those_of_check(qiao):
    q = qiao.home
    q[4:6] = 2.6, 2.6
    graded, checked = ikde.verify(qiao, here(qiao, q), q), ikde.check(qiao, q)
    assert graded.clearance_m == checked.clearance_m < 0.0
    assert graded.closest_pair == (checked.pairs[0].a, checked.pairs[0].b)
    assert graded.colliding_pairs == tuple((pair.a, pair.b) for pair in checked.pairs if pair.collides)


def test_touching_at_the_safe_distance_collides(qiao):
    clearance = ikde.check(qiao, qiao.home).clearance_m
    judge = replace(qiao.detectors["improved"], safe_distance_m=clearance)
    graded = ikde.verify(qiao, here(qiao, qiao.home), qiao.home, collision=judge)
    assert graded.collision
    assert not graded.accepted


def test_without_a_detector_collision_is_not_checked(qiao):
    graded = ikde.verify(qiao, here(qiao, qiao.home), qiao.home, collision="none")
    assert (graded.clearance_m, graded.closest_pair, graded.collision) == (None, None, None)
    assert graded.accepted


def test_joint_values_may_be_named_and_counted_classically(qiao):
    said = ikde.to_convention(qiao, qiao.home, "classical")
    named = dict(zip(qiao.joint_names, said, strict=True))
    assert ikde.verify(qiao, here(qiao, qiao.home), named, convention="classical").accepted


@pytest.mark.parametrize("q", [[0.0] * 8, [np.nan] * 9, {"q1": 0.0}])
def test_bad_values_are_refused(qiao, q):
    with pytest.raises(InputError):
        ikde.verify(qiao, ikde.Target((0, 0, 1)), q)


def test_in_bulk_every_row_is_its_own_verification(any_robot, rng):
    Q = random_q(any_robot, rng, 12)
    T = ikde.forward(any_robot, any_robot.home)[any_robot.tool]
    kinds = [{}, {"axis_world_tool": T[:3, 0]}, {"R_world_tool": T[:3, :3]}]
    targets = [ikde.Target(T[:3, 3], **kinds[k % 3]) for k in range(12)]
    verdicts = verify_many(CollisionModel.of(any_robot), targets, Q, ikde.SolveSettings())
    for k, (target, q) in enumerate(zip(targets, Q, strict=True)):
        row, single = verdicts.row(k), ikde.verify(any_robot, target, q)
        assert row.position_error_m == pytest.approx(single.position_error_m, abs=1e-14)
        assert row.orientation_error_rad == pytest.approx(single.orientation_error_rad, abs=1e-14)
        assert row.clearance_m == pytest.approx(single.clearance_m, abs=1e-14)
        assert (row.closest_pair, row.colliding_pairs, row.accepted) == (
            *(single.closest_pair, single.colliding_pairs, single.accepted),
        )
