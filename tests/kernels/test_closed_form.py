"""The closed form of UR-type arms against the robot's own kinematics and a twin made of matrices and arc cosines."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from ikde.model.closed_form import find_ur_arm
from tests import reference, reference_ur_arm
from tests.random_robots import make_frame, make_robot
from tests.ur_robots import SHIPPED, any_turn, every_ur_robot, pose, random_arm_q, random_ur_robot, solve


def differences(a, b):
    """Largest angle between rows [n, 6] and a row [6], up to whole turns."""
    return np.abs(np.remainder(a - b + np.pi, 2 * np.pi) - np.pi).max(axis=1)


@every_ur_robot
def test_every_solution_reproduces_the_pose(robot, rng):
    arm = find_ur_arm(robot)
    _, poses = random_arm_q(robot, rng, 300)
    for T, solutions in zip(poses, solve(robot, poses)[0], strict=True):
        assert len(solutions) > 0
        assert np.abs(pose(arm, solutions) - T).max() < 2e-14


@every_ur_robot
def test_the_configuration_that_made_the_pose_is_among_them(robot, rng):
    qs, poses = random_arm_q(robot, rng, 2000)
    found = [differences(solutions, q).min() for q, solutions in zip(qs, solve(robot, poses)[0], strict=True)]
    assert np.mean(np.array(found) < 1e-9) >= 0.999


@every_ur_robot
def test_the_solutions_are_the_twins(robot, rng):
    arm = find_ur_arm(robot)
    _, poses = random_arm_q(robot, rng, 50)
    for T, solutions in zip(poses, solve(robot, poses, any_turn(robot))[0], strict=True):
        expected = reference_ur_arm.solve_ur_arm(arm, T)
        assert len(solutions) == len(expected)
        assert all(differences(expected, angles).min() < 1e-6 for angles in arm.signs * solutions + arm.offsets)


@every_ur_robot
def test_codes_are_distinct_and_in_order(robot, rng):
    _, poses = random_arm_q(robot, rng, 200)
    for codes in solve(robot, poses)[1]:
        order = [(code & 1, code & 4, code & 2) for code in codes.tolist()]
        assert order == sorted(set(order))


@pytest.mark.parametrize("seed", range(6))
def test_limits_leave_out_what_no_turn_brings_inside(seed, rng):
    robot = random_ur_robot(seed)
    arm = find_ur_arm(robot)
    centre, half = rng.uniform(-6, 6, len(robot.joints)), rng.uniform(1.5, 5.0, len(robot.joints))
    ranges = np.array([centre - half, centre + half])
    middle, wide = ranges.mean(axis=0)[list(arm.coordinates)], half[list(arm.coordinates)]
    _, poses = random_arm_q(robot, rng, 200)
    every, every_code = solve(robot, poses, any_turn(robot))
    inside, codes = solve(robot, poses, ranges)
    for k in range(len(poses)):
        turned = every[k] - 2 * np.pi * np.rint((every[k] - middle) / (2 * np.pi))
        fits = np.all(np.abs(turned - middle) <= wide, axis=1)
        np.testing.assert_allclose(inside[k], turned[fits], rtol=0, atol=1e-13)
        np.testing.assert_array_equal(codes[k], every_code[k][fits])


@pytest.mark.parametrize("seed", range(6))
def test_a_joint_stands_in_the_turn_nearest_to_where_it_should(seed, rng):
    robot = random_ur_robot(seed)
    arm = find_ur_arm(robot)
    joints = list(arm.coordinates)
    limits = np.array([rng.uniform(-7.0, -4.0, len(robot.joints)), rng.uniform(4.0, 7.0, len(robot.joints))])
    _, poses = random_arm_q(robot, rng, 50)
    middle, lower, upper = solve(robot, poses, limits)[0], *limits[:, joints]
    turns = 2 * np.pi * np.arange(-3, 4)[:, None]
    changed = 0
    for near in rng.uniform(*limits, (5, len(robot.joints))):
        for rows, others in zip(solve(robot, poses, limits, near)[0], middle, strict=True):
            assert len(rows) == len(others)
            for q, other in zip(rows, others, strict=True):
                every = other + turns
                distances = np.where((every >= lower) & (every <= upper), np.abs(every - near[joints]), np.inf)
                nearest = every[distances.argmin(axis=0), range(6)]
                np.testing.assert_allclose(q, nearest, rtol=0, atol=1e-13)
                changed += np.any(np.abs(q - other) > 6.0)
    assert changed > 0


def test_a_joint_at_its_limit_is_set_on_it(rng):
    robot = random_ur_robot(1)
    arm = find_ur_arm(robot)
    for q in random_arm_q(robot, rng, 20)[0]:
        limits = any_turn(robot)
        limits[1, list(arm.coordinates)] = q
        limits[0, list(arm.coordinates)] = q - 1e-6
        solutions, _ = solve(robot, pose(arm, q)[None], limits)
        assert len(solutions[0]) == 1
        assert np.all(solutions[0][0] <= q)
        np.testing.assert_allclose(solutions[0][0], q, rtol=0, atol=1e-11)


@every_ur_robot
@pytest.mark.parametrize("angle", [0.0, np.pi, 1e-14, 1e-9, 1e-5])
def test_parallel_wrist_axes_keep_the_pose(robot, angle, rng):
    arm = find_ur_arm(robot)
    qs, _ = random_arm_q(robot, rng, 50)
    qs[:, 4] = arm.signs[4] * (angle - arm.offsets[4])
    poses = pose(arm, qs)
    solutions, _ = solve(robot, poses, any_turn(robot))
    # Where joint 6 is free, two of its values are looked at; random arms can be too short for both.
    assert np.mean([len(rows) > 0 for rows in solutions]) >= (1.0 if robot in SHIPPED else 0.9)
    for T, rows in zip(poses, solutions, strict=True):
        assert np.all(np.abs(pose(arm, rows) - T) < 3e-12)


@every_ur_robot
@pytest.mark.parametrize("angle", [0.0, 1e-9, 1e-4, np.pi, np.pi - 1e-4])
def test_a_stretched_or_folded_elbow_keeps_the_pose(robot, angle, rng):
    arm = find_ur_arm(robot)
    qs, _ = random_arm_q(robot, rng, 50)
    qs[:, 2] = arm.signs[2] * (angle - arm.offsets[2])
    poses = pose(arm, qs)
    for T, rows in zip(poses, solve(robot, poses, any_turn(robot))[0], strict=True):
        assert len(rows) > 0
        assert np.abs(pose(arm, rows) - T).max() < 3e-12


@every_ur_robot
@pytest.mark.parametrize("beside", [0.0, 1e-13, 1e-7])
def test_a_wrist_as_near_to_the_first_axis_as_can_be_keeps_the_pose(robot, beside, rng):
    arm = find_ur_arm(robot)
    radius, poses = np.hypot(arm.d4, beside), []
    for turn in rng.uniform(-np.pi, np.pi, 50):
        p = [radius * np.cos(turn), radius * np.sin(turn), rng.uniform(-0.5, 0.5)]
        T_base_wrist = reference.make_transform(Rotation.random(rng=rng).as_matrix(), p)
        poses.append(arm.T_carrier_base @ T_base_wrist @ arm.T_wrist_tool)
    solutions, _ = solve(robot, np.array(poses), any_turn(robot))
    assert sum(map(len, solutions)) > 0
    for T, rows in zip(poses, solutions, strict=True):
        assert np.all(np.abs(pose(arm, rows) - T) < 3e-12)


@pytest.mark.parametrize("radius", [0.0, 1e-13, 1e-6])
def test_a_wrist_on_the_first_axis_keeps_the_pose(radius, rng):
    """Without d4 the wrist centre can be on axis 1: joint 1 is free and takes the middle of its range, or is near."""
    robot = robot_without_d4()
    arm = find_ur_arm(robot)
    assert arm.d4 == pytest.approx(0.0, abs=1e-15)
    poses = []
    for height in rng.uniform(0.2, 0.5, 30):
        T_base_wrist = reference.make_transform(Rotation.random(rng=rng).as_matrix(), [radius, 0.0, height])
        poses.append(arm.T_carrier_base @ T_base_wrist @ arm.T_wrist_tool)
    for T, rows in zip(poses, solve(robot, np.array(poses))[0], strict=True):
        assert len(rows) > 0
        assert np.abs(pose(arm, rows) - T).max() < 3e-12
        if radius < 1e-12:
            np.testing.assert_allclose(rows[:, 0], 0.5, rtol=0, atol=1e-15)
            near = solve(robot, T[None], near=np.full(6, -1.25))[0][0]
            np.testing.assert_allclose(near[:, 0], -1.25, rtol=0, atol=1e-15)


def robot_without_d4():
    """An arm whose wrist centre can reach axis 1; joint 1 goes from -1.5 to 2.5."""
    axes = [(0, 0, 1), (0, 1, 0), (0, 1, 0), (0, 1, 0), (0, 0, 1), (0, 1, 0)]
    steps = [(0, 0, 0.3), (0, 0, 0), (0, 0, 0.4), (0, 0, 0.35), (0, 0, 0.1), (0, 0, 0)]
    parents = ["world", *(f"f{k}" for k in range(5))]
    frames = [make_frame(f"f{k}", parents[k], steps[k], joint=f"j{k}", axis=axes[k]) for k in range(6)]
    kinds = {f"j{k}": "revolute" for k in range(6)}
    robot = make_robot(kinds, [*frames, make_frame("tool", "f5", (0, 0.1, 0))], lower=-3.0, upper=3.0)
    first = replace(robot.joints[0], lower=-1.5, upper=2.5)
    return replace(robot, joints=(first, *robot.joints[1:]))


@pytest.mark.parametrize("robot", SHIPPED, ids=lambda robot: robot.name)
def test_what_is_out_of_reach_or_no_number_has_no_solution(robot):
    arm = find_ur_arm(robot)
    far, near, lost = (reference.make_transform(np.eye(3), p) for p in ([3.0, 0, 0], [0.01, 0.01, 0.3], [np.nan, 0, 0]))
    poses = np.array([arm.T_carrier_base @ T @ arm.T_wrist_tool for T in (far, near, lost)])
    assert [len(rows) for rows in solve(robot, poses)[0]] == [0, 0, 0]


def test_a_second_run_gives_the_same_bits(rng):
    _, poses = random_arm_q(SHIPPED[0], rng, 50)
    for first, second in zip(solve(SHIPPED[0], poses)[0], solve(SHIPPED[0], poses)[0], strict=True):
        np.testing.assert_array_equal(first, second)
