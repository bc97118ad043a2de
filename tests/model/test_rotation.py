"""Rotations against scipy, and the laws of their group."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from ikde.errors import InputError
from ikde.model.rotation import (
    angle_between,
    are_rotations,
    check_rotation,
    is_rotation,
    length,
    quat_wxyz_from_rotation,
    rotation_about,
    rotation_angle,
    rotation_from_quat_wxyz,
    rotation_from_rpy,
    rotation_with_z,
    snap,
)

few = settings(max_examples=80)
angles = st.floats(-np.pi, np.pi)
triples = st.tuples(angles, angles, angles)
vectors = st.tuples(*[st.floats(-1.0, 1.0)] * 3).filter(lambda v: np.linalg.norm(v) > 0.1)
EXACT = {"rtol": 0, "atol": 3e-15}


def make_unit(vector):
    return np.array(vector) / np.linalg.norm(vector)


@few
@given(axis=vectors, angle=st.floats(-10.0, 10.0))
def test_a_turn_about_an_axis_is_scipys(axis, angle):
    unit = make_unit(axis)
    np.testing.assert_allclose(rotation_about(unit, angle), Rotation.from_rotvec(angle * unit).as_matrix(), **EXACT)


@few
@given(axis=vectors, first=angles, second=angles)
def test_turns_about_one_axis_add_up(axis, first, second):
    unit = make_unit(axis)
    both = rotation_about(unit, first) @ rotation_about(unit, second)
    np.testing.assert_allclose(both, rotation_about(unit, first + second), **EXACT)
    np.testing.assert_allclose(rotation_about(unit, -first), rotation_about(unit, first).T, **EXACT)
    np.testing.assert_allclose(rotation_about(unit, first) @ unit, unit, **EXACT)


@few
@given(rpy=triples)
def test_roll_pitch_yaw_turn_about_fixed_axes_as_in_urdf(rpy):
    np.testing.assert_allclose(rotation_from_rpy(np.array(rpy)), Rotation.from_euler("xyz", rpy).as_matrix(), **EXACT)


@pytest.mark.parametrize(
    ("rpy", "moved"), [((np.pi / 2, 0, 0), (0, 0, 1)), ((0, 0, np.pi / 2), (-1, 0, 0)), ((0, np.pi / 2, 0), (0, 1, 0))]
)
def test_right_angles_are_exact(rpy, moved):
    R = rotation_from_rpy(np.array(rpy))
    assert set(R.ravel()) <= {-1.0, 0.0, 1.0}
    np.testing.assert_array_equal(R @ [0.0, 1.0, 0.0], moved)


@few
@given(rpy=triples, scale=st.floats(0.01, 100.0))
def test_a_quaternion_is_w_first_and_of_any_length(rpy, scale):
    rotation = Rotation.from_euler("xyz", rpy)
    x, y, z, w = rotation.as_quat()
    for sign in (1.0, -1.0):
        R = rotation_from_quat_wxyz(sign * scale * np.array([w, x, y, z]))
        np.testing.assert_allclose(R, rotation.as_matrix(), **EXACT)


def test_a_quaternion_of_length_zero_is_no_rotation():
    with pytest.raises(InputError, match="a quaternion of length 0 is no rotation"):
        rotation_from_quat_wxyz(np.zeros(4))
    with pytest.raises(InputError, match="a quaternion of length 0"):
        rotation_from_quat_wxyz(np.full(4, np.nan))


@few
@given(axis=vectors)
def test_rotation_with_z_has_that_z_axis_and_is_a_rotation(axis):
    unit = make_unit(axis)
    R = rotation_with_z(unit)
    np.testing.assert_array_equal(R[:, 2], unit)
    np.testing.assert_allclose(R @ R.T, np.eye(3), **EXACT)
    assert np.linalg.det(R) > 0.0


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("k", range(3))
def test_rotation_with_z_is_exact_for_the_coordinate_axes(k, sign):
    R = rotation_with_z(sign * np.eye(3)[k])
    assert set(R.ravel()) <= {-1.0, 0.0, 1.0}
    np.testing.assert_array_equal(R[:, 2], sign * np.eye(3)[k])


def test_rotation_with_z_of_z_is_the_identity():
    np.testing.assert_array_equal(rotation_with_z(np.array([0.0, 0.0, 1.0])), np.eye(3))


def test_snap_rounds_dust_only():
    R = np.array([[1e-16, 1.0 - 2e-16, -1.0 + 9e-16], [0.5, 2e-15, -3e-16]])
    np.testing.assert_array_equal(snap(R), [[0.0, 1.0, -1.0], [0.5, 2e-15, 0.0]])


@few
@given(rpy=triples)
def test_every_rotation_passes_the_check(rpy):
    check_rotation(rotation_from_rpy(np.array(rpy)))


@pytest.mark.parametrize(
    ("R", "message"),
    [
        (np.eye(4), r"3 x 3 finite numbers, got shape \(4, 4\)"),
        (np.full((3, 3), np.nan), "3 x 3 finite numbers"),
        (2.0 * np.eye(3), "not a rotation matrix"),
        (np.diag([1.0, 1.0, -1.0]), "not a rotation matrix"),
        (np.eye(3) + 1e-5, "not a rotation matrix"),
    ],
)
def test_what_is_no_rotation_is_refused(R, message):
    with pytest.raises(InputError, match=message):
        check_rotation(R)


@few
@given(axis=vectors, angle=st.floats(0.0, np.pi))
def test_the_angle_of_a_turn_is_recovered(axis, angle):
    assert rotation_angle(rotation_about(make_unit(axis), angle)) == pytest.approx(angle, abs=1e-14)


@few
@given(axis=vectors, tiny=st.floats(1e-12, 1e-6))
def test_angles_are_exact_near_zero_and_near_pi(axis, tiny):
    unit = make_unit(axis)
    assert rotation_angle(rotation_about(unit, tiny)) == pytest.approx(tiny, rel=1e-6, abs=1e-15)
    assert np.pi - rotation_angle(rotation_about(unit, np.pi - tiny)) == pytest.approx(tiny, abs=2e-15)


@few
@given(a=triples, b=triples)
def test_the_angle_is_scipys_and_does_not_depend_on_the_order(a, b):
    A, B = rotation_from_rpy(np.array(a)), rotation_from_rpy(np.array(b))
    expected = (Rotation.from_matrix(A).inv() * Rotation.from_matrix(B)).magnitude()
    assert rotation_angle(A.T @ B) == pytest.approx(expected, abs=1e-7)
    assert rotation_angle(B.T @ A) == pytest.approx(rotation_angle(A.T @ B), abs=1e-14)


@few
@given(a=triples, b=triples, c=triples)
def test_angles_obey_the_triangle_inequality(a, b, c):
    A, B, C = (rotation_from_rpy(np.array(x)) for x in (a, b, c))
    assert rotation_angle(A.T @ C) <= rotation_angle(A.T @ B) + rotation_angle(B.T @ C) + 1e-14


@few
@given(a=vectors, b=vectors)
def test_the_angle_between_vectors_is_their_arc(a, b):
    a, b = make_unit(a), make_unit(b)
    assume(np.linalg.norm(a - b) > 1e-6)
    expected = 2.0 * np.arctan2(np.linalg.norm(a - b), np.linalg.norm(a + b))
    assert angle_between(a, b) == pytest.approx(expected, abs=1e-14)
    assert angle_between(a, a) == 0.0
    assert angle_between(a, -a) == pytest.approx(np.pi)


@few
@given(axis=vectors, angle=st.sampled_from([0.0, 1e-9, 1.0, np.pi / 2, np.pi - 1e-9, np.pi, 4.0, 6.0]))
def test_a_quaternion_comes_back_from_its_rotation(axis, angle):
    rotation = Rotation.from_rotvec(angle * make_unit(axis))
    x, y, z, w = rotation.as_quat()
    found = quat_wxyz_from_rotation(np.array([rotation.as_matrix(), np.eye(3)]))
    assert found[0, 0] >= 0.0
    assert abs(found[0] @ [w, x, y, z]) == pytest.approx(1.0, abs=1e-14)
    np.testing.assert_allclose(rotation_from_quat_wxyz(found[0]), rotation.as_matrix(), rtol=0, atol=1e-14)
    assert found[1].tolist() == [1.0, 0.0, 0.0, 0.0]


def test_a_rotation_does_not_hang_on_its_neighbours(rng):
    rpy, quats, axes = rng.uniform(-3, 3, (50, 3)), rng.normal(size=(50, 4)), rng.normal(size=(50, 3))
    axes /= length(axes)[:, None]
    for make, values in (
        (rotation_from_rpy, rpy),
        (rotation_from_quat_wxyz, quats),
        (rotation_with_z, axes),
        (length, axes),
    ):
        assert make(values).tobytes() == np.array([make(value) for value in values]).tobytes()


def test_rotations_are_checked_row_by_row():
    R = np.array([np.eye(3), 2.0 * np.eye(3), np.diag([1.0, 1.0, -1.0]), np.diag([1.0, -1.0, -1.0])])
    assert are_rotations(R).tolist() == [True, False, False, True]
    assert [*map(is_rotation, R)] == [True, False, False, True]
