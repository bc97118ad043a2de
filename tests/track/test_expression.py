"""Formulas: Python's own values, arrays in and out, and nothing but arithmetic gets in."""

import math

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from ikde.errors import InputError
from ikde.track.expression import FUNCTIONS, FUNCTIONS_OF_MANY, MAX_LENGTH, parse_expression

K = np.arange(0.0, 10.5, 0.5)
PYTHON = {name: getattr(math, name) for name in ("sin", "cos", "tan", "sqrt", "pi")} | {
    "abs": abs,
    "min": min,
    "max": max,
}


def value(text, k=3.0, N=10):
    return parse_expression(text).evaluate(np.array([k]), N)[0]


def complaint(text):
    with pytest.raises(InputError) as caught:
        parse_expression(text).evaluate(K, 10)
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize(
    "text",
    [
        "900",
        "-k + 2*N - pi/3",
        "200*sin(4*pi*k/N) + 200*cos(2*pi*k/N)",
        "2**3**(k/9) % 7",
        "(600 + 400*k/N) if k <= 2.5 else (1000 - 400*k/N)",
        "1 if 2 <= k < 4 else 2 if k != 5 else 3",
        "max(k, 3, 4.5) - min(k, N/2)",
        "tan(abs(-k)/9) + sqrt(k)",
        "  +1e-3 * k  ",
    ],
)
def test_a_formula_has_the_value_that_python_gives_it(text):
    expected = [eval(text.strip(), {**PYTHON, "k": float(k), "N": 10.0}) for k in K]
    np.testing.assert_allclose(parse_expression(text).evaluate(K, 10), expected, rtol=1e-13, atol=1e-13)


def test_a_number_stands_for_itself_at_every_sample():
    np.testing.assert_array_equal(parse_expression(0.25).evaluate(K, 10), np.full(len(K), 0.25))


def test_a_branch_that_is_not_taken_may_have_no_value():
    assert value("1/k if k > 0 else 0", k=0.0) == 0.0


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("2*sinn(k)", "no function is called 'sinn' (did you mean 'sin'?); there are sin, cos"),
        ("K + 1", "'K' is not known; a formula has numbers, k, N, pi"),
        ("k.real", "'k.real' is not allowed here; a formula has"),
        ("__import__('os').system('true')", "is not allowed here"),
        ("().__class__", "'().__class__' is not allowed here"),
        ("[k]", "'[k]' is not allowed here"),
        ("k[0]", "is not allowed here"),
        ("(lambda: 1)()", "is not allowed here"),
        ("sin(x=k)", "is not allowed here"),
        ("sin(*k)", "'*k' is not allowed here"),
        ("0x10", "'0x10' is not allowed here; a formula has"),
        ("1_0*k", "'1_0' is not allowed here"),
        ("\N{FULLWIDTH LATIN SMALL LETTER K}", "is not allowed here"),
        ("k # the sample", "'# the sample' is not allowed here"),
        ("(k := 3)", "is not allowed here"),
        ("'k'", "is not allowed here"),
        ("1j", "'1j' is not allowed here"),
        ("True", "'True' is not allowed here"),
        ("k // 2", "'k // 2' is not allowed here"),
        ("k <= 3", "'k <= 3' is not allowed here"),
        ("1 if k else 2", "'k' is no condition; expected a comparison"),
        ("1 if k in N else 2", "is no condition"),
        ("1 if k < 3 and k > 1 else 2", "is no condition"),
        ("sin", "sin is a function; expected sin(...)"),
        ("sin(k, 2)", "sin(...) takes 1 value, got 2"),
        ("max(k)", "max(...) takes 2 values or more, got 1"),
        ("2k", "'2k' is no formula: invalid"),
        ("", "'' is no formula: "),
        ("k\x00", "is no formula: "),
        ("1\nk", "'1 k' is no formula"),
        ("9" * 400, "is too large a number"),
        ("9**9**9**9", "'9**9**9**9' is inf at k = 0; expected a finite number"),
        ("sqrt(2 - k)", "'sqrt(2 - k)' is nan at k = 2.5; expected a finite number"),
        ("k" * (MAX_LENGTH + 1), "expected at most 1000 characters, got 1001"),
    ],
)
def test_what_is_not_allowed_is_named(text, words):
    assert words in complaint(text)


def parse(text):
    """Python's parser decides how deep is too deep."""
    try:
        return float(value(text))
    except InputError as error:
        return error


WORDS = [
    "k",
    "N",
    "pi",
    "2",
    ".5",
    "+",
    "-",
    "*",
    "/",
    "**",
    "%",
    "(",
    ")",
    ",",
    " if ",
    " else ",
    "<",
    "==",
    ".",
    "[",
    "]",
]


@settings(max_examples=300)
@given(st.lists(st.sampled_from([*WORDS, *FUNCTIONS, *FUNCTIONS_OF_MANY, "os", "'", ":", "lambda "]), max_size=12))
@example(["(" * 400, "k", ")" * 400])
@example(["-" * 999, "k"])
def test_any_words_are_a_formula_or_one_line(words):
    result = parse("".join(words))
    assert "\n" not in str(result) if isinstance(result, InputError) else np.isfinite(result)


def test_a_formula_that_costs_too_much_is_refused_before_it_is_evaluated():
    dear, many = "+".join(["sin(k)"] * 100), np.zeros(2 * 10**6 + 1)
    with pytest.raises(InputError, match=r"takes too long: 399 operations at 2,000,001 places, .*at most 200,000,000"):
        parse_expression(dear).evaluate(many, 10**6)
    assert parse_expression("+".join(["k"] * 30)).evaluate(many, 10**6).shape == many.shape


def test_long_sums_are_evaluated_and_deeper_ones_are_refused():
    assert value("+".join(["k"] * 280)) == 280 * value("k")
    with pytest.raises(InputError, match="nested too deeply; expected at most 300 levels"):
        parse_expression("+".join(["k"] * 320))


def test_samples_are_taken_in_pieces_that_do_not_show(monkeypatch):
    k, text = np.linspace(0.0, 9.0, 1000), "sin(k) ** 2 + (k % 3 if k <= 4 else min(k, 7))"
    whole = parse_expression(text).evaluate(k, 10)
    monkeypatch.setattr("ikde.track.expression.PIECE", 7)
    np.testing.assert_array_equal(parse_expression(text).evaluate(k, 10), whole)


def test_powers_of_powers_are_floats_and_cost_no_more_than_others():
    assert parse_expression("2 ** 3 ** 2").evaluate(K, 10)[0] == 512.0
    with pytest.raises(InputError, match="is inf at k = 0"):
        parse_expression("9 ** 9 ** 9 ** 9 ** 9 ** 9").evaluate(K, 10)
