"""The arm's Jacobian against differences, and where it is singular."""

import numpy as np

import ikde
from ikde.solver.jacobian import arm_jacobian, smallest_singular_values
from ikde.solver.plain import compute_frames
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
