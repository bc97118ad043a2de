"""Rows of tasks against finite differences of where frames, bases and joints stand."""

import numpy as np
import pytest

from ikde.errors import InputError
from ikde.io.robots import load_robot
from ikde.model.rotation import rotation_about, rotation_angle
from ikde.model.target import Target
from ikde.solver.jacobian import frame_jacobian
from ikde.solver.plain import compute_frames
from ikde.track.task_rows import make_rows, rotation_vector
from ikde.track.velocity_task import VelocityTask


def rows_at(robot, q, task):
    return make_rows(robot, q, task, compute_frames(robot, q))


def draw(robot, seed):
    rng = np.random.default_rng(seed)
    lower, upper = robot.drawn
    return rng, rng.uniform(np.maximum(lower, -3), np.minimum(upper, 3))


@pytest.mark.parametrize("name", ["ur5", "qiao2021", "ur5e_mecanum"])
def test_errors_shrink_as_the_rows_say(name):
    """The error of a place changes by -matrix dq, of a rotation where it is small."""
    robot = load_robot(name)
    rng, q = draw(robot, 1)
    T = compute_frames(robot, q)[robot.tool]
    near = rotation_about(np.array([0.6, 0.0, 0.8]), 1e-5) @ T[:3, :3]
    goal = T[:3, 3] + [0.1, 0.2, -0.1]
    tasks = [
        VelocityTask.tool(goal),
        VelocityTask.tool(Target(goal, R_world_tool=near)),
        VelocityTask.tool(Target(goal, axis_world_tool=near[:, 2])),
        VelocityTask.tool(goal, frame=robot.frames[-3].name),
        VelocityTask.joints({robot.joint_names[-2]: 0.3, robot.joint_names[-1]: 0.1}),
        *([VelocityTask.base((0.3, 0.1, q[2] + 0.2)), VelocityTask.base((0.3, 0.1))] if name != "ur5" else []),
    ]
    for task in tasks:
        rows, step = rows_at(robot, q, task), 1e-6 * rng.standard_normal(len(q))
        ahead, behind = rows_at(robot, q + step, task), rows_at(robot, q - step, task)
        np.testing.assert_allclose(0.5 * (behind.error - ahead.error), rows.matrix @ step, atol=3e-11)
        np.testing.assert_allclose(rows.wanted, rows.error, atol=1e-15)


def test_the_frames_rows_are_those_of_the_public_jacobian():
    robot = load_robot("qiao2021")
    _, q = draw(robot, 2)
    for frame in (robot.tool, "O3"):
        rows = rows_at(robot, q, VelocityTask.tool(twist=np.arange(6.0), frame=frame))
        np.testing.assert_allclose(rows.matrix, frame_jacobian(robot, q, frame), atol=1e-15)
        np.testing.assert_array_equal(rows.wanted, np.arange(6.0))
    fixed = rows_at(
        load_robot("ur5"), np.zeros(6), VelocityTask.tool(twist=np.ones(3), frame=load_robot("ur5").frames[0].name)
    )
    assert fixed.matrix.shape == (3, 6)


def test_wishes_are_shortened_all_parts_alike():
    robot = load_robot("ur5")
    q = robot.home
    T = compute_frames(robot, q)[robot.tool]
    goal = Target(T[:3, 3] + [0.3, 0.0, 0.4], R_world_tool=rotation_about(np.array([0, 0, 1.0]), 0.8) @ T[:3, :3])
    rows = rows_at(robot, q, VelocityTask.tool(goal, gain=2.0, max_speed=0.1, twist=[0, 0, 0.01]))
    np.testing.assert_allclose(rows.wanted - [0, 0, 0.01, 0, 0, 0], 0.2 * rows.error, atol=1e-12)
    assert rows_at(robot, q, VelocityTask.tool(goal, gain=2.0, max_speed=1.0)).wanted[0] == pytest.approx(0.6)
    turning = Target(T[:3, 3], R_world_tool=goal.R_world_tool)
    assert np.linalg.norm(rows_at(robot, q, VelocityTask.tool(turning, max_speed=0.03)).wanted) == pytest.approx(0.1)
    joints = rows_at(robot, q, VelocityTask.joints({robot.joint_names[0]: q[0] + 2.0}, max_speed=0.5))
    assert joints.wanted[0] == pytest.approx(0.5)


def test_a_continuous_joint_takes_the_short_way():
    robot = load_robot("ur5e_mecanum")
    q = np.array([0.0, 0.0, 3.0, *robot.home[3:]])
    assert rows_at(robot, q, VelocityTask.base((0, 0, -3.0))).wanted[2] == pytest.approx(2 * np.pi - 6.0)
    assert rows_at(robot, q, VelocityTask.joints({"heading": -3.0})).wanted[0] == pytest.approx(2 * np.pi - 6.0)
    assert rows_at(robot, q, VelocityTask.joints({"wrist_3_joint": -6.0})).wanted[0] == pytest.approx(-6.0 - q[8])


@pytest.mark.parametrize("angle", [0.0, 1e-9, 0.3, 2.0, 3.0, np.pi - 1e-6, np.pi])
def test_rotation_vectors(angle):
    for direction in np.vstack([np.eye(3), np.random.default_rng(0).standard_normal((20, 3))]):
        R = rotation_about(direction / np.linalg.norm(direction), angle)
        found = rotation_vector(R)
        assert np.linalg.norm(found) == pytest.approx(angle, abs=1e-9)
        back = rotation_about(found / max(np.linalg.norm(found), 1e-300), np.linalg.norm(found))
        assert rotation_angle(back @ R.T) < 1e-9


def test_an_axis_that_points_the_other_way_is_turned():
    robot = load_robot("ur5")
    T = compute_frames(robot, robot.home)[robot.tool]
    rows = rows_at(robot, robot.home, VelocityTask.tool(Target(T[:3, 3], axis_world_tool=-T[:3, 2])))
    assert np.linalg.norm(rows.error) == pytest.approx(np.pi)


@pytest.mark.parametrize(
    ("name", "task", "words"),
    [
        ("ur5", VelocityTask.tool((0, 0, 0), frame="wrist_9"), "frame: ur5 has no frame 'wrist_9'"),
        ("ur5", VelocityTask.base((0, 0)), "base: ur5 has no planar base"),
        ("ur5", VelocityTask.joints({"elbo": 1}), "joints: ur5 has no joint 'elbo'"),
    ],
)
def test_what_does_not_fit_the_robot_is_said_in_a_line(name, task, words):
    robot = load_robot(name)
    with pytest.raises(InputError, match=f"^{words}"):
        rows_at(robot, robot.home, task)
