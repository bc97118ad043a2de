"""Names in files: what can be printed, in the schema and in what is refused."""

import pytest
from pydantic import TypeAdapter, ValidationError

from ikde.formats.names import Name


@pytest.mark.parametrize("name", ["a", "x" * 100, "関節" * 50, "\\", '"; """', "../..", "a b", "é", "🦾", "[red]"])
def test_any_printable_text_of_100_characters_is_a_name(name):
    assert TypeAdapter(Name).validate_python(name) == name


@pytest.mark.parametrize("name", ["", "x" * 101, "a\nb", "\x1b[31m", "\u202eb", "\u200b", "\x00", "\xa0", "\ud800", 5])
def test_other_names_are_refused(name):
    with pytest.raises(ValidationError):
        TypeAdapter(Name).validate_python(name)


def test_the_schema_knows_how_long_a_name_is():
    assert TypeAdapter(Name).json_schema() == {"type": "string", "minLength": 1, "maxLength": 100}
