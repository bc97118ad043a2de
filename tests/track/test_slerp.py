"""Slerp: the shortest way, even in time, for poses and for axes."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation, Slerp

from ikde.errors import InputError
from ikde.model.rotation import rotation_from_rpy, rotation_with_z
from ikde.track.slerp import slerp

few = settings(max_examples=50)


@few
@given(st.integers(0, 10**6), st.integers(2, 6))
def test_poses_turn_as_scipy_turns_them(seed, count):
    rotations = Rotation.random(count, random_state=seed)
    at = np.linspace(0, count - 1, 17)
    expected = Slerp(np.arange(count), rotations)(at).as_matrix()
    np.testing.assert_allclose(slerp("pose", rotations.as_matrix(), at), expected, atol=1e-12)


@few
@given(st.integers(0, 10**6))
def test_axes_move_on_great_circles_at_an_even_rate(seed):
    axes = np.random.default_rng(seed).normal(size=(2, 3))
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    between = slerp("axis", rotation_with_z(axes), np.linspace(0, 1, 9))[:, :, 2]
    np.testing.assert_allclose(between[[0, -1]], axes, atol=1e-14)
    np.testing.assert_allclose(between @ np.cross(*axes), 0.0, atol=1e-12)
    steps = np.linalg.norm(np.diff(between, axis=0), axis=1)
    np.testing.assert_allclose(steps, steps[0], rtol=1e-9)


def test_a_turn_too_small_to_see_is_not_lost():
    R = rotation_from_rpy(np.array([[0, 0, 0], [0, 0, 2e-10]]))
    np.testing.assert_allclose(slerp("pose", R, np.array([0.5]))[0, 1, 0], 1e-10, rtol=1e-6)


def test_one_orientation_is_kept():
    R = rotation_from_rpy(np.array([[0.1, 0.2, 0.3]]))
    np.testing.assert_allclose(slerp("pose", R, np.zeros(3)), np.repeat(R, 3, axis=0), atol=1e-15)


def test_nothing_asked_is_nothing_turned():
    np.testing.assert_array_equal(slerp("free", np.zeros((2, 3, 3)), np.array([0.5])), [np.eye(3)])


@pytest.mark.parametrize("orientation", ["axis", "pose"])
def test_half_a_turn_has_no_shortest_way(orientation):
    R = rotation_from_rpy(np.array([[0, 0, 0], [1, 0, 0], [1 + np.pi, 0, 0]]))
    with pytest.raises(InputError, match=r"^\[2\]: half a turn from the orientation before it"):
        slerp(orientation, R, np.array([0.5, 1.5]))
    slerp(orientation, R[:2], np.array([0.5]))
