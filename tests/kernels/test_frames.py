"""Forward kinematics and the Jacobian against naive twins and finite differences."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from ikde.kernels.frames import compute_frames, compute_jacobian, compute_origins
from ikde.model.pack import frame_names, pack_robot
from tests import reference
from tests.conftest import random_q
from tests.kernels.arrays import run_bodies, run_tool
from tests.random_robots import random_robot

SEEDS = range(30)


@pytest.mark.parametrize("seed", SEEDS)
def test_bodies_equal_products_of_matrices(seed, rng):
    robot = random_robot(seed)
    for q in random_q(robot, rng, 5):
        expected = reference.compute_bodies(pack_robot(robot), q)[:, :3]
        np.testing.assert_allclose(run_bodies(robot, q), expected, rtol=0, atol=1e-14)


@pytest.mark.parametrize("seed", SEEDS)
def test_frames_equal_products_of_matrices_over_the_robot(seed, rng):
    robot = random_robot(seed)
    q = random_q(robot, rng)
    out_T = np.full((len(frame_names(robot)), 3, 4), np.nan)
    compute_frames(pack_robot(robot), run_bodies(robot, q), out_T)
    expected = reference.compute_frames(robot, q)
    for name, T in zip(frame_names(robot), out_T, strict=True):
        np.testing.assert_allclose(T, expected[name][:3], rtol=0, atol=1e-14, err_msg=name)


@pytest.mark.parametrize("seed", SEEDS)
def test_origins_are_those_of_the_frames(seed, rng):
    robot = random_robot(seed)
    packed, T_world_body = pack_robot(robot), run_bodies(robot, random_q(robot, rng))
    frames, origins = np.zeros((2, len(frame_names(robot)), 3, 4))
    compute_frames(packed, T_world_body, frames)
    compute_origins(packed, T_world_body, origins)
    np.testing.assert_allclose(origins[:, :, 3], frames[:, :, 3], rtol=0, atol=1e-14)
    assert not origins[:, :, :3].any()


def test_frames_of_shipped_robots_equal_the_twin(any_robot, rng):
    for q in random_q(any_robot, rng, 20):
        T = run_tool(any_robot, run_bodies(any_robot, q))
        expected = reference.compute_frames(any_robot, q)[any_robot.tool][:3]
        np.testing.assert_allclose(T, expected, rtol=0, atol=1e-14)


def test_bodies_keep_rotations_orthonormal(any_robot, rng):
    R = run_bodies(any_robot, random_q(any_robot, rng))[:, :, :3]
    np.testing.assert_allclose(R @ R.transpose(0, 2, 1), np.broadcast_to(np.eye(3), R.shape), rtol=0, atol=1e-14)


def run_jacobian(robot, q):
    T_world_body = run_bodies(robot, q)
    out_jacobian = np.full((6, len(q)), np.nan)
    compute_jacobian(pack_robot(robot), T_world_body, run_tool(robot, T_world_body), out_jacobian)
    return out_jacobian


@pytest.mark.parametrize("seed", SEEDS)
def test_jacobian_equals_its_formula(seed, rng):
    robot = random_robot(seed)
    q = random_q(robot, rng)
    np.testing.assert_allclose(run_jacobian(robot, q), reference.compute_jacobian(robot, q), rtol=0, atol=1e-13)


def differentiate_tool(robot, q, step=1e-6):
    """Central differences of the twin's tool pose: [6, N]."""
    columns = []
    for unit in np.eye(len(q)):
        before = reference.compute_frames(robot, q - step * unit)[robot.tool]
        after = reference.compute_frames(robot, q + step * unit)[robot.tool]
        turn = Rotation.from_matrix(after[:3, :3] @ before[:3, :3].T).as_rotvec()
        columns.append(np.concatenate([after[:3, 3] - before[:3, 3], turn]) / (2.0 * step))
    return np.array(columns).T


@pytest.mark.parametrize("seed", range(10))
def test_jacobian_equals_finite_differences(seed, rng):
    robot = random_robot(seed)
    q = random_q(robot, rng)
    np.testing.assert_allclose(run_jacobian(robot, q), differentiate_tool(robot, q), rtol=0, atol=1e-8)
