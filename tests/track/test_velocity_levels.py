"""What is sought, and tasks that are there in part."""

import numpy as np
import pytest

from ikde.io.robots import load_robot
from ikde.model.actuators import speeds_by
from ikde.solver.plain import compute_frames
from ikde.track.limits import MotionLimits
from ikde.track.task_rows import make_rows
from ikde.track.velocity_levels import Problem, find_way, solve_tasks
from ikde.track.velocity_task import VelocityTask


def make_problem(robot, q, tasks):
    rows = [make_rows(robot, q, task, compute_frames(robot, q)) for task in tasks]
    way = find_way(robot, q, MotionLimits.of(robot), np.ones(len(q)))
    return Problem(rows, [[k] for k in range(len(tasks))], way, None, 0.05)


def test_a_base_is_sought_by_its_twist():
    for name, columns in (("ur5", 6), ("qiao2021", 8), ("ur5e_mecanum", 9)):
        robot = load_robot(name)
        assert (
            find_way(robot, robot.home, MotionLimits.of(robot), np.ones(len(robot.joints))).mapping.shape[1] == columns
        )


@pytest.mark.parametrize("name", ["ur5", "qiao2021", "ur5e_mecanum"])
def test_at_any_heading_they_make_the_speeds_of_the_joints(name):
    robot = load_robot(name)
    for heading in (0.0, 0.7, -2.5):
        q = robot.home.copy()
        if name != "ur5":
            q[2] = heading
        way = find_way(robot, q, MotionLimits.of(robot), np.ones(len(q)))
        np.testing.assert_allclose(way.mapping, speeds_by(robot, q, "twist"), atol=1e-15)


def test_what_is_held_is_not_sought():
    robot = load_robot("qiao2021")
    speed = MotionLimits.of(robot).speed.copy()
    speed[[4, 6]] = 0.0
    way = find_way(robot, robot.home, MotionLimits.of(robot, speed=speed), np.arange(1.0, 10.0))
    assert way.mapping.shape == (9, 6)
    assert not way.mapping[[4, 6]].any()
    np.testing.assert_array_equal(way.weights, [1, 3, 4, 6, 8, 9])


def test_a_task_in_part_comes_in_without_a_jump():
    robot = load_robot("ur5e_mecanum")
    q = robot.home
    T = compute_frames(robot, q)["tool"]
    tasks = [
        VelocityTask.tool(T[:3, 3] + [2.0, 0, 0]),
        VelocityTask.base((1.0, 0.5, 0.2)),
        VelocityTask.joints({"elbow_joint": 2.0}),
    ]
    problem = make_problem(robot, q, tasks)
    without, whole = solve_tasks(problem, [0.0, 1.0, 1.0]).x, solve_tasks(problem, [1.0, 1.0, 1.0]).x
    np.testing.assert_allclose(solve_tasks(problem, [1e-9, 1.0, 1.0]).x, without, atol=1e-7)
    np.testing.assert_allclose(solve_tasks(problem, [1.0 - 1e-9, 1.0, 1.0]).x, whole, atol=1e-7)
    shares = [solve_tasks(problem, [share, 1.0, 1.0]).x for share in np.linspace(0, 1, 11)]
    steps = np.abs(np.diff(shares, axis=0)).max(axis=1)
    assert steps.max() < 0.2 * np.abs(whole - without).max()
    both = solve_tasks(problem, [0.5, 0.5, 1.0]).x
    assert np.isfinite(both).all()
    assert not np.allclose(both, whole)


def test_no_task_at_all_is_standing_still():
    robot = load_robot("ur5")
    problem = make_problem(robot, robot.home, [VelocityTask.joints({robot.joint_names[0]: 1.0})])
    np.testing.assert_array_equal(solve_tasks(problem, [0.0]).x, np.zeros(6))
