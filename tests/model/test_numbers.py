"""Numbers that nobody gave are not made up."""

import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from ikde.model.numbers import is_number, read_numbers


class RecordsItsGradient:
    """As a tensor of torch is."""

    def __array__(self, dtype=None, copy=None):
        raise RuntimeError("can't call numpy() on a tensor that requires grad")


@pytest.mark.parametrize("values", [(1, 2.5), [1, 2.5], np.array([1.0, 2.5]), np.ma.masked_array([1.0, 2.5])])
def test_numbers_are_copied(values):
    read = read_numbers(values, ("q",))
    assert (type(read), read.dtype, read.tolist()) == (np.ndarray, float, [1.0, 2.5])
    assert read is not values


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ("abc", "got 'abc'"),
        ([1, None, "x"], "expected numbers"),
        ([1j, 2.0], "expected numbers"),
        (np.array([1j, 2.0]), "got complex ones"),
        (np.ma.masked_array([1.0, 2.0], mask=[False, True]), "some are masked"),
        ([np.ma.masked_array([1.0, 2.0], mask=[False, True]), (1.0, 2.0)], "some are masked"),
        (np.zeros(3, "datetime64[s]"), "got dates"),
        (np.zeros(3, "timedelta64[s]"), "got times"),
        (np.zeros(3, [("x", float)]), "got records"),
        (RecordsItsGradient(), "expected numbers"),
    ],
)
def test_what_is_no_number_is_refused(values, message):
    with pytest.raises(InputError, match=message) as caught:
        read_numbers(values, ("q",))
    assert caught.value.where == ("q",)


def test_masked_joints_are_not_checked_as_zeros(qiao):
    with pytest.raises(InputError, match="q: expected numbers, but some are masked"):
        ikde.check(qiao, np.ma.masked_array(qiao.home, mask=True))
    with pytest.raises(InputError, match="p_world_tool: expected numbers, but some are masked"):
        ikde.Target(np.ma.masked_array([0.8, 0.5, 1.0], mask=[0, 1, 0]))


@pytest.mark.parametrize(
    ("value", "is_one"),
    [(1, True), (0.5, True), (np.float32(1), True), (np.int8(1), True), (True, False), (np.True_, False), ("1", False)],
)
def test_a_bool_and_text_are_no_numbers(value, is_one):
    assert is_number(value) is is_one
