"""Distances to keep from a world, as they are written."""

import pytest

from ikde.errors import InputError
from ikde.formats.margins import read_margins


def test_margins_are_one_for_all_and_those_of_components():
    assert read_margins("10,hand=0", 1e-3) == (0.01, {"hand": 0.0})
    assert read_margins("10, hand=0", 1e-3) == (0.01, {"hand": 0.0})
    assert read_margins("hand=0.5", 1.0) == (0.0, {"hand": 0.5})
    assert read_margins(None, 1.0) == (0.0, {})


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("ten", r"^margin: expected a distance or component=distance, got 'ten'$"),
        ("", r"^margin: expected a distance or component=distance, got ''$"),
        ("1,", r"^margin: expected a distance or component=distance, got ''$"),
        ("1,hand", r"^margin: expected a distance or component=distance, got 'hand'$"),
        ("hand=", r"^margin: expected a distance or component=distance, got 'hand='$"),
        ("=5", r"^margin: expected a distance or component=distance, got '=5'$"),
        ("10, =5", r"^margin: expected a distance or component=distance, got ' =5'$"),
        ("1,2", r"^margin: this margin is given twice$"),
    ],
)
def test_what_is_no_margin_is_refused(text, message):
    with pytest.raises(InputError, match=message):
        read_margins(text, 1.0)
