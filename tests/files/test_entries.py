"""What several kinds of files share: units, and at most one orientation."""

import math

import pytest

from ikde.errors import InputError
from ikde.files.entries import InlineTarget, UnitsEntry, chosen_orientation


def test_units_are_metres_and_radians():
    assert (UnitsEntry().length_m, UnitsEntry().angle_rad) == (1.0, 1.0)
    units = UnitsEntry(length="mm", angle="deg")
    assert (units.length_m, units.angle_rad) == (1e-3, math.pi / 180.0)


def test_at_most_one_orientation():
    assert chosen_orientation(InlineTarget(position=[0, 0, 0])) is None
    assert chosen_orientation(InlineTarget(position=[0, 0, 0], rpy=[0, 0, 0])) == "rpy"
    with pytest.raises(InputError, match="rpy: axis and rpy both ask for an orientation"):
        chosen_orientation(InlineTarget(position=[0, 0, 0], rpy=[0, 0, 0], axis=[0, 0, 1]))
