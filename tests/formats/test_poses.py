"""Positions and orientations as users write them."""

import numpy as np
import pytest

from ikde.errors import InputError
from ikde.formats.entries import OrientationEntry, UnitsEntry
from ikde.formats.poses import make_orientation, read_orientation, read_position

MM_DEG = UnitsEntry(length="mm", angle="deg")


def test_orientations_are_what_target_takes():
    half_turn = np.diag([-1.0, -1.0, 1.0])
    np.testing.assert_allclose(make_orientation("rpy", np.array([0, 0, np.pi]))["R_world_tool"], half_turn, atol=1e-15)
    np.testing.assert_array_equal(make_orientation("quat_wxyz", np.array([0, 0, 0, 9.0]))["R_world_tool"], half_turn)
    np.testing.assert_array_equal(make_orientation("axis", [0, 0, 2])["axis_world_tool"], [0, 0, 2])


def test_a_quaternion_of_length_zero_is_refused():
    with pytest.raises(InputError, match="quaternion of length 0"):
        make_orientation("quat_wxyz", np.zeros(4))


def test_units_are_converted_and_what_is_wrong_is_placed():
    np.testing.assert_allclose(read_position("to", [1, 2, 3], MM_DEG), [1e-3, 2e-3, 3e-3])
    half = read_orientation(OrientationEntry(rpy=[0, 0, 180]), MM_DEG)["R_world_tool"]
    np.testing.assert_allclose(half, np.diag([-1.0, -1.0, 1.0]), atol=1e-15)
    assert read_orientation(OrientationEntry(), MM_DEG) == {}
    with pytest.raises(InputError, match=r"^to: expected finite numbers up to 1e\+06"):
        read_position("to", [1e9, 0, 1e9], UnitsEntry())
    with pytest.raises(InputError, match=r"^axis: an axis of length 0"):
        read_orientation(OrientationEntry(axis=[0, 0, 0]), MM_DEG)
