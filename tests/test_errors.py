"""An error is one line of limited length that keeps file, line and key, and gives no order to a terminal."""

import pytest

from ikde.errors import ErrorList, FileError, InputError, nearest, printable, quoted, shorten

ORDERS = "\x1b[2J\x1b]0;title\x07\x9b31m\r\n\t\0\x7f\u202e\u2028\u2029\u200b\ud800\ue000"


def test_what_a_terminal_would_obey_is_written_out():
    assert printable("\x1b[31mred\r\n") == r"\x1b[31mred\r\n"
    assert printable("\u202eabc") == r"\u202eabc"
    assert printable(ORDERS).isprintable()
    assert printable(printable(ORDERS)) == printable(ORDERS)


@pytest.mark.parametrize("text", ["", "a b", "größe → µ 手臂", "[red] <b> `x` $y$ \\"])
def test_words_of_any_script_stay_as_they_are(text):
    assert printable(text) == text


def test_line_breaks_are_kept_where_that_is_asked_for():
    assert printable("a\nb\x1b", keep="\n") == "a\nb\\x1b"


@pytest.mark.parametrize("where", [(), (ORDERS, 3)])
def test_an_error_is_one_line_whatever_it_is_about(where):
    for error in (InputError(ORDERS, where), FileError(f"/x/{ORDERS}", ORDERS, where, 7)):
        assert str(error).isprintable()
        assert error.message.isprintable()


def test_a_long_message_is_cut_and_its_place_is_kept():
    text = str(FileError("robots/a.yaml", "x" * 10**6, ("frames", "O1", 3), 14))
    assert text.startswith("robots/a.yaml:14 → frames.O1[3]: xxx")
    assert text.endswith("...")
    assert len(text) == 400


def test_a_name_as_long_as_names_may_be_is_kept():
    assert str(InputError("wrong", ("x" * 100,))) == f"{'x' * 100}: wrong"


def test_of_a_long_place_the_end_is_kept():
    deep = "/".join(["folder"] * 100) + "/a.yaml"
    text = str(FileError(deep, "wrong", ("k" * 10**6,) * 20 + ("x",), 14))
    assert "/folder/a.yaml:14 → ..." in text
    assert ".x: wrong" in text
    assert len(text) <= 400


def test_a_message_that_is_placed_anew_is_cut_once():
    error = InputError("expected a number", ("a",))
    assert str(InputError(error.message, ("b", *error.where))) == "b.a: expected a number"


def test_a_quotation_is_short():
    assert quoted("abc") == "'abc'"
    assert len(quoted([1] * 10**5)) == 60
    assert quoted("\x1b") == r"'\x1b'"
    assert shorten("abcdef", 5) == "ab..."
    assert shorten("abcdef", 5, keep_end=True) == "...ef"


def test_names_are_compared_with_few_and_short_ones():
    assert nearest("tol", ["tool"]) == " (did you mean 'tool'?)"
    assert nearest("t" * 10**6, ["x" * 10**5] * 10**5) == ""


@pytest.mark.parametrize(("name", "expected"), [("improvd", " (did you mean 'improved'?)"), ("xyz", "")])
def test_nearest_names_only_what_is_near(name, expected):
    assert nearest(name, ["improved", "typical"]) == expected


def test_a_list_of_errors_is_raised_as_one():
    errors = ErrorList()
    errors.raise_all()
    assert errors.collect([lambda: 1, lambda: fail("a"), lambda: 2, lambda: fail("b")]) == (1, 2)
    with pytest.raises(InputError, match="a: wrong") as caught:
        errors.raise_all()
    assert [str(other) for other in caught.value.others] == ["b: wrong"]
    with pytest.raises(ZeroDivisionError), errors:
        _ = 1 / 0


def fail(key):
    raise InputError("wrong", (key,))
