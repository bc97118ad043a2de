"""Joint conventions: there and back again, and the paper's rule for q5."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ikde
from ikde.errors import InputError
from ikde.model.convention import convention_offsets, from_convention, to_convention

few = settings(max_examples=100)
QIAO = ikde.load_robot("qiao2021")
Q5 = QIAO.joint_names.index("q5")
values = st.lists(st.floats(-3.1, 3.1), min_size=9, max_size=9)

# q5 as printed in [Qiao2021, Table 5], rad.
TABLE_5_Q5 = [2.8275, -2.0784, -2.4686, -0.9356, 0.8309, -2.1422, 1.4986, 1.7498, 1.4986, -1.5473]


@few
@given(q=values)
def test_there_and_back_is_the_same_configuration(q):
    for first, second in ((to_convention, from_convention), (from_convention, to_convention)):
        back = second(QIAO, first(QIAO, np.array(q), "classical"), "classical")
        np.testing.assert_allclose(back, q, rtol=0, atol=2e-15)


@few
@given(q=values)
def test_only_the_shifted_joint_changes_and_stays_within_half_a_turn(q):
    classical = to_convention(QIAO, np.array(q), "classical")
    others = np.arange(9) != Q5
    np.testing.assert_array_equal(classical[others], np.array(q)[others])
    assert -np.pi < classical[Q5] <= np.pi
    assert np.cos(classical[Q5] - q[Q5] - np.pi) == pytest.approx(1.0)


@pytest.mark.parametrize("classical", TABLE_5_Q5)
def test_q5_of_table_5_is_pi_more_than_in_the_key_point_convention(classical):
    q = np.zeros(9)
    q[Q5] = classical
    key_point = from_convention(QIAO, q, "classical")[Q5]
    turned = (classical - np.pi) % (2.0 * np.pi)
    assert key_point == pytest.approx(turned if turned <= np.pi else turned - 2.0 * np.pi, abs=1e-15)


def test_the_classical_home_of_formula_23_is_home():
    classical = np.radians([90.0, 0.0, 0.0, 0.0, 180.0, 0.0])
    q = from_convention(QIAO, np.concatenate([np.zeros(3), classical]), "classical")
    np.testing.assert_allclose(q, QIAO.home, rtol=0, atol=1e-15)


@pytest.mark.parametrize("own", [None, "key_point"])
def test_the_robots_own_convention_changes_nothing(own):
    q = np.linspace(-9.0, 9.0, 9)
    np.testing.assert_array_equal(to_convention(QIAO, q, own), q)
    np.testing.assert_array_equal(from_convention(QIAO, q, own), q)
    assert not convention_offsets(QIAO, own).any()


def test_stacks_of_configurations_are_shifted_alike(rng):
    stack = rng.uniform(-3.0, 3.0, (4, 5, 9))
    shifted = to_convention(QIAO, stack, "classical")
    np.testing.assert_array_equal(shifted[2, 3], to_convention(QIAO, stack[2, 3], "classical"))


def test_pi_itself_is_kept_and_minus_pi_becomes_pi():
    q = np.zeros(9)
    assert to_convention(QIAO, q, "classical")[Q5] == np.pi
    assert from_convention(QIAO, q, "classical")[Q5] == np.pi


def test_an_unknown_convention_is_refused_with_those_there_are():
    with pytest.raises(InputError, match="qiao2021 has no convention 'dh'; it has key_point, classical"):
        convention_offsets(QIAO, "dh")
