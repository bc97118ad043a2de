"""What several kinds of files share: units, at most one orientation, exactly one key."""

import math

import pytest
from pydantic import TypeAdapter, ValidationError

from ikde.errors import InputError
from ikde.files.entries import InlineTarget, Name, UnitsEntry, chosen_orientation, only_key


def test_units_are_metres_and_radians():
    assert (UnitsEntry().length_m, UnitsEntry().angle_rad) == (1.0, 1.0)
    units = UnitsEntry(length="mm", angle="deg")
    assert (units.length_m, units.angle_rad) == (1e-3, math.pi / 180.0)


@pytest.mark.parametrize("name", ["a", "x" * 100, "関節" * 50, "\\", '"; """', "../..", "a b", "é", "🦾", "[red]"])
def test_any_printable_text_of_100_characters_is_a_name(name):
    assert TypeAdapter(Name).validate_python(name) == name


@pytest.mark.parametrize("name", ["", "x" * 101, "a\nb", "\x1b[31m", "\u202eb", "\u200b", "\x00", "\xa0", "\ud800", 5])
def test_other_names_are_refused(name):
    with pytest.raises(ValidationError):
        TypeAdapter(Name).validate_python(name)


def test_the_schema_knows_how_long_a_name_is():
    assert TypeAdapter(Name).json_schema() == {"type": "string", "minLength": 1, "maxLength": 100}


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
