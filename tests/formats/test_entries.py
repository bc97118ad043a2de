"""What several kinds of files share: units, at most one orientation, exactly one key."""

import math

import pytest

from ikde.errors import InputError
from ikde.formats.entries import InlineTarget, UnitsEntry, chosen_orientation, only_key


def test_units_are_metres_and_radians():
    assert (UnitsEntry().length_m, UnitsEntry().angle_rad) == (1.0, 1.0)
    units = UnitsEntry(length="mm", angle="deg")
    assert (units.length_m, units.angle_rad) == (1e-3, math.pi / 180.0)


def test_at_most_one_orientation():
    assert chosen_orientation(InlineTarget(position=[0, 0, 0])) is None
    assert chosen_orientation(InlineTarget(position=[0, 0, 0], rpy=[0, 0, 0])) == "rpy"
    with pytest.raises(InputError, match="rpy: axis and rpy both ask for an orientation"):
        chosen_orientation(InlineTarget(position=[0, 0, 0], rpy=[0, 0, 0], axis=[0, 0, 1]))


def test_exactly_one_key_is_given():
    assert only_key(InlineTarget(position=[0, 0, 0])) == "position"
    target = InlineTarget(position=[0, 0, 0], rpy=[0, 0, 0])
    assert only_key(target, ("rpy", "axis")) == "rpy"
    with pytest.raises(InputError, match="expected one of axis, name, got none"):
        only_key(target, ("axis", "name"))
    with pytest.raises(InputError, match=r"^rpy: expected one of position, rpy, got position and rpy"):
        only_key(target, ("position", "rpy"))
