"""Values of other programs' scenes: numbers by name or in a list, poses, frames in frames."""

import numpy as np
import pytest

from ikde.errors import InputError
from ikde.io.scene_values import Frames, as_name, as_numbers, check_keys, compose, make_pose, rotation_from_unit_quat

XYZ = ("x", "y", "z")
HALF = np.sqrt(0.5)


def move(x, yaw=0.0):
    c, s = np.cos(yaw), np.sin(yaw)
    return np.array([[c, -s, 0, x], [s, c, 0, 0], [0, 0, 1, 0]])


def test_numbers_in_a_list_or_by_name():
    assert as_numbers([1, 2.5, 3], XYZ).tolist() == [1, 2.5, 3]
    assert as_numbers({"z": 3, "x": 1, "y": 2}, XYZ).tolist() == [1, 2, 3]


@pytest.mark.parametrize(
    "value", [None, [1, 2], [1, 2, "3"], [1, 2, True], [1, 2, np.nan], {"x": 1, "y": 2}, {"x": 1, "y": 2, "w": 3}, 5]
)
def test_what_are_no_numbers(value):
    with pytest.raises(InputError):
        as_numbers(value, XYZ)


def test_names_may_look_like_numbers():
    assert [as_name(value) for value in ("a", 7, 0.5)] == ["a", "7", "0.5"]
    for value in (True, None, [], {}):
        with pytest.raises(InputError, match="expected a name"):
            as_name(value)


def test_an_unknown_key_is_refused_with_the_one_that_is_meant():
    with pytest.raises(InputError, match=r"^dimensons: unknown key \(did you mean 'dimensions'\?\)"):
        check_keys({"type": 1, "dimensons": 2}, ("type", "dimensions"))


@pytest.mark.parametrize("size", [1.0, 1.0009, 0.9991])
def test_quaternions_of_nearly_unit_length_are_normalised(size):
    R = rotation_from_unit_quat(size * np.array([HALF, 0, 0, HALF]))
    assert np.allclose(R, [[0, -1, 0], [1, 0, 0], [0, 0, 1]], atol=1e-15)


@pytest.mark.parametrize("quat", [[0, 0, 0, 0], [2, 0, 0, 0], [0.5, 0, 0, 0], [np.nan, 0, 0, 0]])
def test_other_quaternions_are_refused(quat):
    with pytest.raises(InputError, match="expected a quaternion of length 1, got one of length"):
        make_pose(np.zeros(3), np.array(quat, float))


def test_the_identity_keeps_bits():
    T = move(0.1, 0.3)
    assert compose(T, np.eye(4)[:3]) is T
    assert compose(np.eye(4)[:3], T) is T
    assert np.allclose(compose(move(1, np.pi / 2), move(2)), [[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 0]])


def test_frames_in_frames():
    frames = Frames()
    frames.add("a", "base", move(1))
    frames.add("c", "b", move(0, np.pi / 2))
    frames.add("b", "a", move(2))
    frame, T = frames.resolve("c")
    assert frame == "base"
    assert np.allclose(T, move(3, np.pi / 2))
    assert frames.resolve("other")[0] == "other"
    with pytest.raises(InputError, match="two frames are called 'a'"):
        frames.add("a", "b", move(1))


def test_a_cycle_of_frames_is_named():
    frames = Frames()
    for name, parent in (("d", "a"), ("a", "b"), ("b", "c"), ("c", "a")):
        frames.add(name, parent, move(1))
    with pytest.raises(InputError, match="frames are placed in each other: a -> b -> c -> a"):
        frames.resolve("d")
    frames.add("e", "e", move(1))
    with pytest.raises(InputError, match="e -> e"):
        frames.resolve("e")


def test_a_long_chain_of_frames_is_climbed_once():
    frames = Frames()
    for k in range(10_000):
        frames.add(f"f{k}", f"f{k - 1}" if k else "base", move(0.001))
    for k in range(9_999, 0, -1):
        frame, T = frames.resolve(f"f{k}")
    assert frame == "base"
    assert T[0, 3] == pytest.approx(0.002)
    assert frames.resolve("f9999")[1][0, 3] == pytest.approx(10.0)
