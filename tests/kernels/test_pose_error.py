"""Position and orientation errors against scipy, near the identity, near half a turn, and anywhere."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from ikde.kernels.pose_error import compute_orientation_error, compute_position_error
from ikde.model.pack import pack_targets
from ikde.model.rotation import rotation_about
from ikde.model.target import Target
from tests import reference

few = settings(max_examples=80)
vectors = st.tuples(*[st.floats(-1.0, 1.0)] * 3).filter(lambda v: np.linalg.norm(v) > 0.1)
seeds = st.integers(0, 2**32 - 1)


def random_pose(seed, scale=2.0):
    rng = np.random.default_rng(seed)
    return np.column_stack([Rotation.random(rng=rng).as_matrix(), rng.uniform(-scale, scale, 3)])


def orientation_error(target, T_world_tool):
    return compute_orientation_error(pack_targets([target]), 0, np.ascontiguousarray(T_world_tool))


def turned(T, axis, angle):
    """The pose, turned about an axis [3] of its own."""
    return np.column_stack([T[:, :3] @ rotation_about(np.array(axis) / np.linalg.norm(axis), angle), T[:, 3]])


@few
@given(seed=seeds, other=seeds)
def test_errors_of_random_poses_are_the_twins(seed, other):
    T, goal = random_pose(seed), random_pose(other)
    targets = [
        Target(goal[:, 3]),
        Target(goal[:, 3], axis_world_tool=goal[:, 2]),
        Target(goal[:, 3], R_world_tool=goal[:, :3]),
    ]
    packed = pack_targets(targets)
    for index, target in enumerate(targets):
        position = compute_position_error(packed, index, T)
        assert position == pytest.approx(reference.compute_position_error(T, target), rel=1e-15, abs=1e-16)
        orientation = compute_orientation_error(packed, index, T)
        assert orientation == pytest.approx(reference.compute_orientation_error(T, target), abs=1e-7)
        assert 0.0 <= orientation <= np.pi


@few
@given(seed=seeds, axis=vectors, tiny=st.floats(1e-9, 1e-3))
def test_a_tiny_turn_is_measured_exactly(seed, axis, tiny):
    T = random_pose(seed)
    target = Target(T[:, 3], R_world_tool=T[:, :3])
    error = orientation_error(target, turned(T, axis, tiny))
    assert error == pytest.approx(tiny, abs=2e-15)
    assert error == pytest.approx(reference.compute_orientation_error(turned(T, axis, tiny), target), abs=1e-7)


@few
@given(seed=seeds, axis=vectors, tiny=st.floats(0.0, 1e-3))
def test_a_turn_just_below_half_a_turn_is_measured_exactly(seed, axis, tiny):
    T = random_pose(seed)
    target = Target(T[:, 3], R_world_tool=T[:, :3])
    error = orientation_error(target, turned(T, axis, np.pi - tiny))
    assert np.pi - error == pytest.approx(tiny, abs=3e-15)
    assert error == pytest.approx(reference.compute_orientation_error(turned(T, axis, np.pi - tiny), target), abs=1e-7)


@few
@given(seed=seeds, axis=vectors, angle=st.floats(0.0, np.pi))
def test_the_angle_of_a_turn_is_measured_exactly(seed, axis, angle):
    T = random_pose(seed)
    target = Target(T[:, 3], R_world_tool=T[:, :3])
    assert orientation_error(target, turned(T, axis, angle)) == pytest.approx(angle, abs=3e-15)


@few
@given(seed=seeds, angle=st.floats(-np.pi, np.pi), tilt=st.floats(0.0, np.pi))
def test_an_axis_target_leaves_the_turn_about_the_axis_free(seed, angle, tilt):
    T = random_pose(seed)
    target = Target(T[:, 3], axis_world_tool=T[:, 2])
    tilted = turned(turned(turned(T, (0, 0, 1), angle), (1, 0, 0), tilt), (0, 0, 1), -angle)
    assert orientation_error(target, tilted) == pytest.approx(tilt, abs=3e-15)


@few
@given(seed=seeds, other=seeds)
def test_the_error_between_two_poses_does_not_depend_on_which_is_the_target(seed, other):
    A, B = random_pose(seed), random_pose(other)
    there = orientation_error(Target(A[:, 3], R_world_tool=A[:, :3]), B)
    back = orientation_error(Target(B[:, 3], R_world_tool=B[:, :3]), A)
    assert there == pytest.approx(back, abs=2e-15)


def test_the_right_pose_has_no_error():
    T = np.column_stack([[[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [1.0, 2.0, 3.0]])
    for target in (Target(T[:, 3]), Target(T[:, 3], axis_world_tool=T[:, 2]), Target(T[:, 3], R_world_tool=T[:, :3])):
        assert orientation_error(target, T) == 0.0
        assert compute_position_error(pack_targets([target]), 0, T) == 0.0


def test_the_opposite_axis_is_half_a_turn_away():
    assert orientation_error(Target([0, 0, 0], axis_world_tool=[0, 0, -1]), np.eye(3, 4)) == np.pi


def test_each_row_of_the_targets_is_its_own():
    packed = pack_targets([Target([0, 0, 0]), Target([3, 4, 0])])
    assert [compute_position_error(packed, index, np.eye(3, 4)) for index in range(2)] == [0.0, 5.0]
