"""Jacobians of tool and frames by joints, twist and wheels against differences; where an arm is singular."""

import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from ikde.model.actuators import actuator_names, speeds_by
from ikde.model.base_motion import find_planar_base, move_base
from ikde.solver.jacobian import arm_jacobian, smallest_singular_values
from ikde.solver.plain import compute_frames
from tests.conftest import random_q
from tests.track.measured import wave


def test_it_is_the_derivative_of_the_tool(any_robot):
    q, step = any_robot.home + 0.1, 1e-6
    chain = [joint for joint in range(len(q)) if any_robot.joint_names[joint] not in ("d_x", "d_y", "q_z")]
    jacobian = arm_jacobian(any_robot, q, ("d_x", "d_y", "q_z"))
    here = compute_frames(any_robot, q)[any_robot.tool]
    assert jacobian.shape == (6, len(chain))
    for column, joint in zip(jacobian.T, chain, strict=True):
        moved = q.copy()
        moved[joint] += step
        there = compute_frames(any_robot, moved)[any_robot.tool]
        turn = here[:3, :3].T @ (there[:3, :3] - here[:3, :3]) / step
        np.testing.assert_allclose(column[:3], here[:3, :3].T @ (there[:3, 3] - here[:3, 3]) / step, atol=1e-5)
        np.testing.assert_allclose(column[3:], [turn[2, 1], turn[0, 2], turn[1, 0]], atol=1e-5)


def moved_by(robot, q, speeds, names, dt_s):
    """Joint values after `dt_s` of constant speeds of actuators: the base on its exact arc, joints linearly."""
    base, q_dot = find_planar_base(robot), speeds_by(robot, q, "actuators") @ speeds
    after = q + dt_s * q_dot
    if base[0] >= 0:
        c, s = np.cos(q[base[2]]), np.sin(q[base[2]])
        x, y, turn = q_dot[base]
        after[base] = move_base(q[base], np.array([c * x + s * y, c * y - s * x, turn]), dt_s)
    return after


@pytest.mark.parametrize("name", ikde.robot_names())
def test_by_actuators_it_is_the_derivative_of_the_tool_of_every_robot(name, rng):
    robot, step = ikde.load_robot(name), 2e-5
    q, names = random_q(robot, rng), actuator_names(robot, "actuators")
    frame, axes = robot.frames[-1].name if name == "ur5" else "tool", "world"
    T, J = ikde.forward(robot, q)[frame], ikde.jacobian(robot, q, frame=frame, axes=axes, by="actuators")
    assert J.shape == (6, len(names))
    for column, speeds in zip(J.T, np.eye(len(names)), strict=True):
        ends = [ikde.forward(robot, moved_by(robot, q, speeds, names, sign * step))[frame] for sign in (1.0, -1.0)]
        v = (ends[0] - ends[1])[:3, 3] / (2.0 * step)
        W = (ends[0] - ends[1])[:3, :3] @ T[:3, :3].T / (2.0 * step)
        omega = 0.5 * np.array([W[2, 1] - W[1, 2], W[0, 2] - W[2, 0], W[1, 0] - W[0, 1]])
        np.testing.assert_allclose(column, [*v, *omega], rtol=0, atol=1e-8)


def test_axes_and_many_configurations(qiao, rng):
    q = random_q(qiao, rng, 6).reshape(2, 3, 9)
    world = ikde.jacobian(qiao, q, by="twist")
    own, R = ikde.jacobian(qiao, q, axes="frame", by="twist"), ikde.forward(qiao, q)["tool"][..., :3, :3]
    assert (world.shape, own.shape) == ((2, 3, 6, 8), (2, 3, 6, 8))
    np.testing.assert_allclose(R @ own[..., :3, :], world[..., :3, :], rtol=0, atol=1e-14)
    np.testing.assert_allclose(R @ own[..., 3:, :], world[..., 3:, :], rtol=0, atol=1e-14)
    np.testing.assert_array_equal(world[1, 2], ikde.jacobian("qiao2021", q[1, 2], by="twist"))
    assert not ikde.jacobian(qiao, q, frame="O3")[..., 6:].any()  # what comes behind a frame does not move it


def test_what_is_asked_wrongly_is_refused(qiao):
    for words, message in (
        ({"frame": "tol"}, "frame: qiao2021 has no frame 'tol' .did you mean 'tool'"),
        ({"axes": "tool"}, "axes: expected one of world, frame, got 'tool'"),
        ({"by": "wheels"}, "by: expected one of joints, twist, actuators, got 'wheels'"),
    ):
        with pytest.raises(InputError, match=message):
            ikde.jacobian(qiao, qiao.home, **words)


def test_a_stretched_arm_is_singular():
    robot = ikde.load_robot("ur5")
    bent = np.array([0.0, -1.2, 1.5, -1.0, 1.0, 0.0])
    stretched = np.array([0.0, -1.2, 0.0, -1.0, 1.0, 0.0])
    least = smallest_singular_values(robot, np.array([bent, stretched]))
    assert least[0] > 0.05
    assert least[1] < 1e-9


def test_a_singularity_counts_only_for_what_is_asked():
    robot = ikde.load_robot("ur5")
    flat_wrist = np.array([0.0, -1.2, 1.5, -1.0, 0.0, 0.0])
    least = {
        asked: smallest_singular_values(robot, flat_wrist, orientation=asked) for asked in ("free", "axis", "pose")
    }
    assert max(least["pose"], least["axis"]) < 1e-9
    assert least["free"] > 0.05


def test_an_arm_with_too_few_joints_is_always_singular(qiao):
    q, fixed = wave(qiao, 6, 0.3)[2:5], ("d_x", "d_y", "q_z", "q1")
    assert (smallest_singular_values(qiao, q, fixed, "axis") > 0.0).all()
    assert (smallest_singular_values(qiao, q, fixed, "pose") == 0.0).all()


def test_the_base_is_left_out(qiao):
    q = wave(qiao, 6, 0.3)[2:5]
    whole, arm = smallest_singular_values(qiao, q), smallest_singular_values(qiao, q, ("d_x", "d_y", "q_z"))
    assert np.all(arm != whole)
    assert arm.shape == (3,)
