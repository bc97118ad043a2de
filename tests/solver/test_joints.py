"""Joint values as arrays and mappings, in any convention."""

from dataclasses import replace

import numpy as np
import pytest

from ikde.errors import InputError
from ikde.model.robot import MAX_MAGNITUDE
from ikde.model.validate import check_robot
from ikde.solver.joints import joints_outside, read_joints

SOME = [0.1, -0.2, 0.3, 1.0, -0.5, 0.4, 0.2, -1.0, 0.6]


def named(robot, values):
    return dict(zip(robot.joint_names, values, strict=True))


@pytest.mark.parametrize("form", [list, tuple, np.array, lambda values: np.array(values, dtype=object)])
def test_any_sequence_becomes_an_array(qiao, form):
    q = read_joints(qiao, form(SOME))
    assert q.dtype == np.float64
    assert q.tolist() == SOME


def test_the_array_is_a_copy(qiao):
    given = np.array(SOME)
    read_joints(qiao, given)[0] = 9.0
    assert given.tolist() == SOME


def test_stacks_keep_their_shape(qiao):
    assert read_joints(qiao, np.zeros((4, 2, 9))).shape == (4, 2, 9)
    assert read_joints(qiao, np.zeros((0, 9))).shape == (0, 9)


def test_a_mapping_may_stand_in_any_order(qiao):
    backwards = dict(reversed(named(qiao, SOME).items()))
    assert read_joints(qiao, backwards).tolist() == SOME


def test_joints_that_a_mapping_leaves_out_come_from_the_default(qiao):
    q = read_joints(qiao, {"q2": 0.7}, default=qiao.home)
    expected = qiao.home
    expected[4] = 0.7
    assert q.tolist() == expected.tolist()


def test_without_a_default_a_mapping_names_what_is_missing(qiao):
    with pytest.raises(InputError, match="q: no value for d_x, d_y"):
        read_joints(qiao, {"q_z": 0.0})


def test_a_convention_shifts_arrays_and_mappings_alike(qiao):
    shifted = np.array(SOME)
    shifted[7] += np.pi
    assert read_joints(qiao, shifted, "classical") == pytest.approx(np.array(SOME))
    assert read_joints(qiao, named(qiao, shifted), "classical") == pytest.approx(np.array(SOME))


def test_a_default_is_never_shifted(qiao):
    q = read_joints(qiao, {"q1": 0.0}, "classical", default=qiao.home)
    assert q[7] == qiao.home[7]


@pytest.mark.parametrize(
    ("q", "words"),
    [
        ([1.0] * 8, "expected 9 joint values .*, got 8"),
        (1.0, "expected 9 joint values .*, got 1"),
        (np.zeros((9, 3)), "got 3"),
        ([[1.0], [1.0, 2.0]], "expected numbers"),
        (["a"] * 9, "expected numbers"),
        (None, "expected"),
        ([np.nan] * 9, "finite"),
        ([0.0] * 8 + [np.inf], "finite"),
        ({"q9": 1.0}, "has no joint 'q9'"),
        ({"qz": 1.0}, "did you mean 'q_z'"),
    ],
)
def test_bad_values_are_one_line(qiao, q, words):
    with pytest.raises(InputError, match=words) as caught:
        read_joints(qiao, q)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_what_is_not_finite_in_a_mapping_is_refused(qiao, value):
    with pytest.raises(InputError, match="finite"):
        read_joints(qiao, named(qiao, [value, *SOME[1:]]), "classical")


def test_an_unknown_convention_is_refused(qiao):
    for q in (SOME, named(qiao, SOME)):
        with pytest.raises(InputError, match="no convention 'dh'"):
            read_joints(qiao, q, "dh")


def test_exactly_on_a_limit_is_inside(any_robot):
    assert joints_outside(any_robot, any_robot.lower) == ()
    assert joints_outside(any_robot, any_robot.upper) == ()


def test_one_bit_beyond_a_limit_is_outside(any_robot):
    for limits, beyond in ((any_robot.lower, -np.inf), (any_robot.upper, np.inf)):
        assert joints_outside(any_robot, np.nextafter(limits, beyond)) == any_robot.joint_names


def test_the_ends_of_the_widest_ranges_that_load_are_joint_values(qiao):
    joints = tuple(replace(joint, lower=-MAX_MAGNITUDE, upper=MAX_MAGNITUDE) for joint in qiao.joints)
    wide = check_robot(replace(qiao, joints=joints, pair_lists={}, detectors={}, default_detector="none", wheels=None))
    for q in (wide.lower, wide.upper):
        assert read_joints(wide, q).tolist() == q.tolist()
    with pytest.raises(InputError, match="below 100000"):
        read_joints(wide, np.nextafter(wide.upper, np.inf))


def test_a_mistake_is_named_by_the_argument(qiao):
    for near in ([1.0, 2.0], {"q": 1.0}, {3: 1.0}, "abc"):
        with pytest.raises(InputError, match=r"^near"):
            read_joints(qiao, near, default=qiao.home, argument="near")
