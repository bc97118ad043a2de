"""Names: any text that can be printed, up to 100 characters; what is refused is told with its reason and place."""

import pytest

from ikde.errors import InputError
from ikde.model.names import MAX_NAME_LENGTH, check_printable, find_fault


@pytest.mark.parametrize("name", ["x", "x" * MAX_NAME_LENGTH, "漢" * 100, "a\\b", 'a"""b', "$(rm -rf .)", "<b>", " "])
def test_printable_text_is_a_name(name):
    assert find_fault(name) is None


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("", "expected a name of 1 to 100 characters, got 0"),
        ("漢" * 101, "expected a name of 1 to 100 characters, got 101"),
        ("x" * 10**6, "expected a name of 1 to 100 characters, got 1,000,000"),
        ("a\nb", r"expected a name of printable characters, got one with '\n'"),
        ("a\x1b[2Jb", r"expected a name of printable characters, got one with '\x1b'"),
        ("a\u202eb", r"expected a name of printable characters, got one with '\u202e'"),
        ("a\u2066b", r"expected a name of printable characters, got one with '\u2066'"),
        ("a\ufeff", r"expected a name of printable characters, got one with '\ufeff'"),
        ("a\ud800", r"expected a name of printable characters, got one with '\ud800'"),
        (None, "expected a name, got NoneType"),
        (5, "expected a name, got int"),
    ],
)
def test_other_text_is_none(name, words):
    assert find_fault(name) == words
    with pytest.raises(InputError) as error:
        check_printable(name, ("joints", "x"))
    assert str(error.value) == f"joints.x: {words}"
