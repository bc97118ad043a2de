"""Targets: what is accepted, what is made of it, and one line for what is not."""

import copy
import pickle

import numpy as np
import pytest

from ikde.errors import InputError
from ikde.model.rotation import rotation_from_rpy
from ikde.model.target import KINDS, Target, Targets

P = [0.8, 0.5, 1.0]
R = [[0, 0, 1], [1, 0, 0], [0, 1, 0]]


def test_a_position_target_asks_for_nothing_else():
    target = Target(P)
    assert target.kind == "position"
    np.testing.assert_array_equal(target.p_world_tool, P)
    np.testing.assert_array_equal(target.R_world_tool, np.eye(3))


def test_a_pose_target_keeps_its_rotation():
    target = Target(tuple(P), R_world_tool=R)
    assert target.kind == "pose"
    np.testing.assert_array_equal(target.R_world_tool, R)


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_an_axis_target_takes_an_axis_of_any_length(scale):
    target = Target(P, axis_world_tool=scale * np.array([3.0, 0.0, 4.0]))
    assert target.kind == "axis"
    np.testing.assert_allclose(target.axis_world_tool, [0.6, 0.0, 0.8], rtol=1e-15)
    np.testing.assert_array_equal(target.R_world_tool[:, 2], target.axis_world_tool)


def test_a_target_is_read_only_and_keeps_its_own_copy():
    p, rotation = np.array(P), np.array(R, dtype=float)
    target = Target(p, R_world_tool=rotation)
    p[0], rotation[0, 0] = 9.0, 9.0
    assert target.p_world_tool[0] == 0.8
    assert target.R_world_tool[0, 0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        target.p_world_tool[0] = 1.0
    with pytest.raises(ValueError, match="read-only"):
        target.R_world_tool[0, 0] = 1.0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"p_world_tool": [1.0, 2.0]}, "p_world_tool: expected an array [3], got shape (2,)"),
        ({"p_world_tool": []}, "p_world_tool: expected an array [3], got shape (0,)"),
        ({"p_world_tool": 1.0}, "p_world_tool: expected an array [3], got shape ()"),
        ({"p_world_tool": [[1.0, 2.0, 3.0]]}, "p_world_tool: expected an array [3], got shape (1, 3)"),
        (
            {"p_world_tool": [1.0, np.nan, 3.0]},
            "p_world_tool: expected finite numbers up to 1e+06, got [1.0, nan, 3.0]",
        ),
        (
            {"p_world_tool": [1.0, np.inf, 3.0]},
            "p_world_tool: expected finite numbers up to 1e+06, got [1.0, inf, 3.0]",
        ),
        ({"p_world_tool": ["a", 2.0, 3.0]}, "p_world_tool: expected numbers, got ['a', 2.0, 3.0]"),
        ({"p_world_tool": None}, "p_world_tool: expected an array [3]"),
        ({"p_world_tool": [1.0, [2.0], 3.0]}, "p_world_tool: expected numbers"),
        ({"p_world_tool": P, "axis_world_tool": [0, 0, 0]}, "axis_world_tool: an axis of length 0 has no direction"),
        ({"p_world_tool": P, "axis_world_tool": [0, 1]}, "axis_world_tool: expected an array [3], got shape (2,)"),
        ({"p_world_tool": P, "axis_world_tool": [0, np.nan, 1]}, "axis_world_tool: expected finite numbers"),
        ({"p_world_tool": P, "R_world_tool": np.eye(2)}, "R_world_tool: expected an array [3, 3], got shape (2, 2)"),
        ({"p_world_tool": P, "R_world_tool": 2 * np.eye(3)}, "R_world_tool: not a rotation matrix"),
        ({"p_world_tool": P, "R_world_tool": np.diag([1, 1, -1])}, "not a rotation matrix"),
        (
            {"p_world_tool": P, "R_world_tool": np.full((3, 3), np.nan)},
            "R_world_tool: a rotation matrix is 3 x 3 finite numbers",
        ),
        ({"p_world_tool": P, "R_world_tool": "east"}, "R_world_tool: expected numbers, got 'east'"),
        ({"p_world_tool": P, "R_world_tool": R, "axis_world_tool": [0, 0, 1]}, "not both"),
    ],
)
def test_a_bad_target_is_refused_in_one_line(arguments, message):
    with pytest.raises(InputError) as caught:
        Target(**arguments)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


ROWS = np.array([[0.8, 0.5, 1.0], [0.1, 0.2, 0.3], [-1.0, 2.0, -3.0]])
AXES = np.array([[3.0, 0.0, 4.0], [0.3, -0.7, 0.2], [0.0, 0.0, -1e-9]])
TURNS = rotation_from_rpy(np.array([[0.1, 0.2, 0.3], [1.0, 2.0, 3.0], [0.0, 0.0, 0.0]]))
MIXED = [Target(P), Target(P, R_world_tool=R), Target(P, axis_world_tool=[0, 1, 1]), Target(P)]


def bits(target):
    return target.kind, target.p_world_tool.tobytes(), target.R_world_tool.tobytes()


@pytest.mark.parametrize(
    ("arrays", "single"),
    [
        (Targets(ROWS), [Target(p) for p in ROWS]),
        (Targets(ROWS, TURNS), [Target(p, T) for p, T in zip(ROWS, TURNS, strict=True)]),
        (Targets(ROWS, axis_world_tool=AXES), [Target(p, None, a) for p, a in zip(ROWS, AXES, strict=True)]),
    ],
)
def test_targets_from_arrays_are_the_targets_one_by_one(arrays, single):
    assert [bits(target) for target in arrays] == [bits(target) for target in single]
    assert arrays.p_world_tool.tobytes() == ROWS.tobytes()
    again = Targets.of(single)
    assert again.kind.tobytes() == arrays.kind.tobytes()
    assert again.T_world_tool.tobytes() == arrays.T_world_tool.tobytes()


def test_targets_are_a_sequence():
    targets = Targets.of(MIXED)
    assert len(targets) == 4
    assert [target.kind for target in targets] == ["position", "pose", "axis", "position"]
    assert [KINDS[k] for k in targets.kind] == [target.kind for target in MIXED]
    assert [bits(target) for target in targets] == [bits(target) for target in MIXED]
    assert bits(targets[-2]) == bits(MIXED[2])
    assert [bits(target) for target in targets[1:3]] == [bits(target) for target in MIXED[1:3]]
    assert [bits(target) for target in targets.take(np.array([3, 1]))] == [bits(MIXED[3]), bits(MIXED[1])]
    assert Targets.of(targets) is targets
    assert len(Targets.of([])) == len(Targets(np.empty((0, 3)))) == 0
    with pytest.raises(IndexError):
        targets[4]


def test_slices_share_memory_and_everything_is_read_only():
    targets = Targets.of(MIXED)
    piece = targets[1:3]
    assert np.shares_memory(piece.T_world_tool, targets.T_world_tool)
    for some in (targets, piece, targets.take(np.array([0, 2])), pickle.loads(pickle.dumps(targets))):
        assert not some.kind.flags.writeable
        assert not some.T_world_tool.flags.writeable
        assert not some.p_world_tool.flags.writeable
        assert some.T_world_tool.flags.c_contiguous
    with pytest.raises(ValueError, match="read-only"):
        targets[0].p_world_tool[0] = 1.0


def test_targets_keep_their_own_copy():
    points, turns = ROWS.copy(), TURNS.copy()
    targets = Targets(points, turns)
    points[:], turns[:] = 9.0, 9.0
    assert targets.p_world_tool.tobytes() == ROWS.tobytes()
    assert targets.R_world_tool.tobytes() == TURNS.tobytes()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"p_world_tool": P}, "p_world_tool: expected an array [T, 3], got shape (3,)"),
        ({"p_world_tool": "here"}, "p_world_tool: expected numbers, got 'here'"),
        (
            {"p_world_tool": [P, [1.0, np.nan, 3.0]]},
            "p_world_tool[1]: expected finite numbers up to 1e+06, got [1.0, nan, 3.0]",
        ),
        ({"p_world_tool": [[1e7, 0, 0], P]}, "p_world_tool[0]: expected finite numbers up to 1e+06"),
        ({"p_world_tool": [P, P], "R_world_tool": R}, "R_world_tool: expected an array [T, 3, 3], got shape (3, 3)"),
        ({"p_world_tool": [P, P], "R_world_tool": [R]}, "R_world_tool: expected 2 rows, as many as positions, got 1"),
        ({"p_world_tool": [P, P], "R_world_tool": [R, 2 * np.eye(3)]}, "R_world_tool[1]: not a rotation matrix"),
        ({"p_world_tool": [P], "R_world_tool": [np.diag([1, 1, -1])]}, "R_world_tool[0]: not a rotation matrix"),
        (
            {"p_world_tool": [P], "R_world_tool": [np.full((3, 3), np.nan)]},
            "R_world_tool[0]: a rotation matrix is 3 x 3 finite numbers",
        ),
        (
            {"p_world_tool": [P, P], "axis_world_tool": [[0, 0, 1], [0, 0, 0]]},
            "axis_world_tool[1]: an axis of length 0 has no direction",
        ),
        ({"p_world_tool": [P], "axis_world_tool": [[0, np.inf, 1]]}, "axis_world_tool[0]: expected finite numbers"),
        ({"p_world_tool": [P], "R_world_tool": [R], "axis_world_tool": [[0, 0, 1]]}, "not both"),
    ],
)
def test_bad_rows_are_refused_in_one_line_with_their_number(arguments, message):
    with pytest.raises(InputError) as caught:
        Targets(**arguments)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("again", [lambda target: pickle.loads(pickle.dumps(target)), copy.deepcopy, copy.copy])
def test_poses_are_c_ordered_and_read_only_however_they_came(again):
    """Numba compiles once more for any other layout."""
    R = rotation_from_rpy([0.1, 0.2, 0.3])
    one, many = Target([1.0, 2.0, 3.0], R_world_tool=R.T), Targets(np.ones((2, 3)), R_world_tool=np.stack([R, R]).mT)
    for target in (one, again(one), many, again(many), many[0], many[:1]):
        assert target.T_world_tool.flags.c_contiguous
        assert not target.T_world_tool.flags.writeable
    assert (again(one).T_world_tool == one.T_world_tool).all()
    assert again(one).kind == one.kind


def test_a_pose_may_be_written_in_four_ways():
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = rotation_from_rpy(np.array([0.0, 0.0, np.pi / 2])), P
    expected, half = Target(P, R_world_tool=T[:3, :3]), np.sqrt(0.5)
    assert Target.from_matrix(T) == expected
    assert Target.from_rpy(P, (0.0, 0.0, np.pi / 2)) == expected
    for same in (Target.from_quat_wxyz(P, (half, 0, 0, half)), Target.from_quat_xyzw(P, (0, 0, half, half))):
        np.testing.assert_allclose(same.T_world_tool, expected.T_world_tool, atol=1e-15)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Target.from_matrix(np.eye(3)), r"T_world_tool: expected an array \[4, 4\]"),
        (lambda: Target.from_matrix(2 * np.eye(4)), "T_world_tool: expected the last row 0 0 0 1"),
        (lambda: Target.from_quat_wxyz(P, (0, 0, 0, 0)), "quat_wxyz: a quaternion of length 0"),
        (lambda: Target.from_quat_xyzw(P, (0, 0, np.nan, 0)), "quat_xyzw: expected finite numbers"),
        (lambda: Target.from_rpy(P, (0, 0)), r"rpy_rad: expected an array \[3\]"),
    ],
)
def test_what_is_no_pose_is_refused(make, message):
    with pytest.raises(InputError, match=f"^{message}"):
        make()
