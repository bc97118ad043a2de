"""All branches of UR-type arms, against the twin made of matrices, and what poses within tolerances do to them."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from ikde.model.branches import find_branches
from ikde.model.closed_form import find_ur_arm
from tests import reference_ur_arm
from tests.ur_robots import SHIPPED, UR_ROBOTS, every_ur_robot, pose, random_arm_q

UR5 = SHIPPED[2]


def turn_apart(a, b):
    return np.abs(np.remainder(a - b + np.pi, 2 * np.pi) - np.pi)


def move(poses, rng, position_m, orientation_rad):
    """Poses [T, 4, 4] beside others: half of them as far as can be."""
    moved, size = poses.copy(), (len(poses), 3)
    share = np.where(np.arange(len(poses)) % 2, 1.0, rng.uniform(0.0, 1.0, len(poses)))[:, None]
    way, axis = (vectors / np.linalg.norm(vectors, axis=1)[:, None] for vectors in rng.normal(size=(2, *size)))
    moved[:, :3, 3] += share * position_m * way
    turned = Rotation.from_rotvec(share * orientation_rad * axis).as_matrix()
    moved[:, :3, :3] = turned @ moved[:, :3, :3]
    return moved


@every_ur_robot
def test_the_branches_are_the_twins(robot, rng):
    arm = find_ur_arm(robot)
    _, poses = random_arm_q(robot, rng, 50)
    branches = find_branches(arm, poses, 1e-5, 1e-4)
    for T, angles, own in zip(poses, branches.angles, branches.is_own, strict=True):
        expected = reference_ur_arm.solve_ur_arm(arm, T)
        found = angles[own]
        assert len(found) == len(expected)
        assert all(turn_apart(expected, own).max(axis=1).min() < 1e-6 for own in found)


@every_ur_robot
@pytest.mark.parametrize("tolerances", [(1e-5, 1e-4), (1e-3, 0.0), (0.0, 1e-3), (3e-3, 1e-2)])
def test_a_pose_within_the_tolerances_moves_no_branch_beyond_its_slack(robot, tolerances, rng):
    arm = find_ur_arm(robot)
    _, poses = random_arm_q(robot, rng, 100)
    found, tightest = find_branches(arm, poses, *tolerances), 0.0
    known = np.isfinite(found.slack).all(axis=-1)
    for _ in range(10):
        moved = find_branches(arm, move(poses, rng, *tolerances), 0.0, 0.0)
        there = known & moved.is_own
        share = turn_apart(moved.angles, found.angles)[there] / found.slack[there]
        assert np.isfinite(moved.angles[there]).all()
        assert there.sum() > 0.5 * known.sum()
        assert not moved.is_own[found.missing].any()
        assert share.max() <= 1.0
        tightest = max(tightest, share.max())
    assert tightest > 0.2


def test_nearly_all_branches_have_a_slack_or_are_missing(rng):
    for robot in UR_ROBOTS:
        _, poses = random_arm_q(robot, rng, 300)
        found = find_branches(find_ur_arm(robot), poses, 1e-5, 1e-4)
        assert np.mean(found.missing | np.isfinite(found.slack).all(axis=-1)) > 0.9
        assert not (found.missing & found.is_own).any()


@pytest.mark.parametrize("value", [0.0, np.pi, 1e-4])
def test_nothing_is_said_near_a_singularity(value, rng):
    """A wrist whose axes are in line: a little beside it there are other branches."""
    arm = find_ur_arm(UR5)
    qs, _ = random_arm_q(UR5, rng, 50)
    qs[:, 4] = arm.signs[4] * (value - arm.offsets[4])
    found = find_branches(arm, pose(arm, qs), 1e-4, 1e-3)
    apart = turn_apart(found.angles, arm.angles(qs)[:, None, :])[:, :, 4]
    own = apart < 1.5e-4 + abs(np.sin(value)) * 1e-3  # NaN is none of them
    assert own.any(axis=1).all()
    assert not found.missing[own].any()
    assert np.isnan(found.slack[own]).any(axis=-1).all()


def stretch(arm, rng, beyond_m):
    """Poses whose links would have to be `beyond_m` longer than they are, as far as that goes along the upper arm."""
    qs, _ = random_arm_q(UR5, rng, 300)
    qs[:, 2] = arm.signs[2] * -arm.offsets[2]
    poses = pose(arm, qs)
    Ts_base = np.linalg.inv(arm.T_carrier_base) @ poses
    one, two = arm.angles(qs)[:, 0], arm.angles(qs)[:, 1]
    way = np.column_stack([np.cos(one) * np.cos(two), np.sin(one) * np.cos(two), np.sin(two)])
    Ts_base[:, :3, 3] += beyond_m * way
    return arm.T_carrier_base @ Ts_base


@pytest.mark.parametrize("beyond_m", [-1e-5, 0.5e-4])
def test_an_arm_that_is_just_stretched_has_the_branches_of_what_the_tolerances_reach(beyond_m, rng):
    """Elbow up and down meet there: they are in the middle of what is left, even if the pose itself is out of reach."""
    arm = find_ur_arm(UR5)
    poses, tolerances = stretch(arm, rng, beyond_m), (1e-4, 0.0)
    found = find_branches(arm, poses, *tolerances)
    folded = np.isfinite(found.slack).all(axis=-1) & ~found.missing & (np.abs(found.angles[..., 2]) < 0.05)
    assert folded.any(axis=1).mean() > 0.9
    if beyond_m > 0.0:
        assert found.is_own[folded].mean() < 0.1  # of another shoulder, by chance
    met = 0
    for _ in range(20):
        moved = find_branches(arm, move(poses, rng, *tolerances), 0.0, 0.0)
        there = folded & moved.is_own
        assert (turn_apart(moved.angles, found.angles)[there] <= found.slack[there]).all()
        met += there.sum()
    assert met > 1000


@pytest.mark.parametrize("beyond_m", [1e-3, -2e-5])
def test_a_wrist_that_just_passes_the_first_axis_has_the_branches_of_what_the_tolerances_reach(beyond_m, rng):
    arm = find_ur_arm(UR5)
    _, poses = random_arm_q(UR5, rng, 2000)
    T = np.linalg.inv(arm.T_carrier_base) @ poses @ np.linalg.inv(arm.T_wrist_tool)
    across = np.hypot(T[:, 0, 3], T[:, 1, 3])
    T[:, :2, 3] *= ((arm.d4 + beyond_m) / across)[:, None]
    poses, tolerances = arm.T_carrier_base @ T @ arm.T_wrist_tool, (abs(beyond_m) * 1.5, 0.0)
    found = find_branches(arm, poses, *tolerances)
    known, met = np.isfinite(found.slack).all(axis=-1) & ~found.missing, 0
    assert found.is_own.any() == (beyond_m > 0.0)
    for _ in range(20):
        moved = find_branches(arm, move(poses, rng, *tolerances), 0.0, 0.0)
        there = known & moved.is_own
        assert (turn_apart(moved.angles, found.angles)[there] <= found.slack[there]).all()
        met += there.sum()
    assert met > 100


def test_nothing_is_said_for_tolerances_that_are_no_longer_small(rng):
    _, poses = random_arm_q(UR5, rng, 20)
    for orientation_rad in (0.5, 1.6, 3.1):
        found = find_branches(find_ur_arm(UR5), poses, 1e-5, orientation_rad)
        assert np.isnan(found.slack).any(axis=-1).all()
        assert not (found.missing & np.isfinite(find_branches(find_ur_arm(UR5), poses, 0.0, 0.0).angles[..., 0])).any()


def test_a_wrist_beside_the_first_axis_is_missing_only_as_far_as_the_tolerances_tell():
    """d4 of the axis: nearer the wrist centre cannot come."""
    arm = find_ur_arm(UR5)

    def at(radius):
        T = np.eye(4)
        T[:3, 3] = radius, 0.0, 0.5
        return (arm.T_carrier_base @ T @ arm.T_wrist_tool)[None]

    assert find_branches(arm, at(arm.d4 - 1e-3), 1e-5, 1e-4).missing.all()
    assert not find_branches(arm, at(arm.d4 - 1e-6), 1e-5, 1e-4).missing.any()
