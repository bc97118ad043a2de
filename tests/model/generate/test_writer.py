"""The writer: what it writes has the value that was asked for, once, and nothing more."""

import re

import numpy as np
import pytest

from ikde.model.generate.writer import Writer, text
from tests.uncompiled import evaluate

NAMES = "abcdef"


def random_products(rng):
    """Up to six products of up to four factors, some of them names, some numbers, 0 and +-1 among them."""
    products = []
    for _ in range(rng.integers(0, 7)):
        factors = []
        for _ in range(rng.integers(1, 5)):
            number = float(rng.choice([0.0, 1.0, -1.0, 0.5, rng.normal()]))
            factors.append(str(rng.choice(list(NAMES))) if rng.random() < 0.6 else number)
        products.append(tuple(factors))
    return products


def test_sums_have_the_value_of_their_products(rng):
    for _ in range(300):
        known = dict(zip(NAMES, rng.normal(size=len(NAMES)).tolist(), strict=True))
        products = random_products(rng)
        expected = sum(np.prod([known.get(factor, factor) for factor in product]) for product in products)
        writer = Writer()
        (value,) = evaluate(writer, [writer.sum("total", *products)], **known)
        assert value == pytest.approx(expected, rel=1e-13, abs=1e-13)


def test_what_is_known_is_computed_now():
    writer = Writer()
    assert writer.sum("x", (2.0, 3.0), (0.5,)) == 6.5
    assert writer.sum("x", (0.0, "a"), (2.0,)) == 2.0
    assert writer.sum("x", (1.0, "a"), (0.0, "b")) == "a"
    assert writer.sum("x", (-1.0, -1.0, "a")) == "a"
    assert writer.sum("x") == 0.0
    assert writer.lines(["a", "x"], set()) == []


def test_constants_of_a_sum_become_one():
    writer = Writer()
    writer.sum("x", ("a", 2.0, "b", 3.0), (1.5,), (0.25, 2.0))
    assert writer.lines(["x"], set()) == ["x = 6.0 * a * b + 2.0"]


def test_a_sum_begins_with_a_plus_if_it_has_one():
    writer = Writer()
    writer.sum("x", (-1.0, "a"), (-2.0, "b", "b"), ("c",), (-3.0,))
    writer.sum("y", (-1.0, "a"), (-2.0, "b"))
    assert writer.lines(["x", "y"], set()) == ["x = c - a - 2.0 * b * b - 3.0", "y = -a - 2.0 * b"]


def test_numbers_keep_all_their_digits(rng):
    for number in [*rng.normal(size=50).tolist(), 0.1 + 0.2, 1e-300, 5e-324, 1 / 3]:
        writer = Writer()
        writer.sum("x", (number, "a"))
        assert evaluate(writer, ["x"], a=1.0) == [number]
        assert float(text(number)) == number


def test_nothing_is_computed_twice():
    writer = Writer()
    assert writer.sum("x", ("a", "b")) == "x"
    assert writer.sum("y", ("a", "b")) == "x"
    assert writer.let("z", "a * b") == "x"
    assert writer.lines(["x"], set()) == ["x = a * b"]


def test_a_name_stands_for_one_thing():
    writer = Writer()
    writer.let("x", "a + b")
    assert writer.let("x", "a + b") == "x"
    with pytest.raises(ValueError, match="x is written twice, once as a - b"):
        writer.let("x", "a - b")


def test_nothing_is_computed_in_vain_and_everything_in_order():
    writer = Writer()
    writer.let("x", "a + 1.0")
    writer.let("in_vain", "x + 7.0")
    writer.let("y", "x * 2.0")
    writer.let("z", "max(y, b)")
    assert writer.lines(["y"], set()) == ["x = a + 1.0", "y = x * 2.0"]
    assert writer.lines(["z"], set()) == ["x = a + 1.0", "y = x * 2.0", "z = max(y, b)"]
    assert writer.lines([3.0, "a"], set()) == []


def test_what_has_been_written_is_not_written_again():
    writer, written = Writer(), set()
    for name, expression in (("x", "a + 1.0"), ("y", "x * 2.0"), ("z", "x + y")):
        writer.let(name, expression)
    assert writer.lines(["y"], written) == ["x = a + 1.0", "y = x * 2.0"]
    assert written == {"x", "y"}
    assert writer.lines(["z"], written) == ["z = x + y"]
    assert writer.lines(["z", "x"], written) == []


def test_lines_add_up_to_the_whole(rng):
    """Asked for bit by bit or at once: the same statements, each after those that it needs."""
    writer, names = Writer(), ["a"]
    for k in range(60):
        left, right = rng.choice(names, 2).tolist()
        names.append(writer.sum(f"n{k}", (left, 0.5), (right, float(k + 2))))
    written, pieces = set(), []
    for name in rng.permutation(names[1:]).tolist():
        pieces += writer.lines([name], written)
    assert sorted(pieces) == sorted(writer.lines(names, set()))
    known = {"a"}
    for line in pieces:
        name, expression = line.split(" = ")
        assert set(re.findall(r"[a-z]\w*", expression)) <= known
        known.add(name)


def test_labels_tell_numbers_apart(rng):
    writer = Writer()
    tuples = [tuple(np.round(rng.normal(size=2), digits)) for digits in (1, 2, 7) for _ in range(40)]
    near = [(x + 1e-9, y) for x, y in tuples[:20]] + [(x, -y) for x, y in tuples[:20]]
    labels = {numbers: writer.label("c3", numbers, 1e-3) for numbers in [*tuples, *near]}
    assert len(set(labels.values())) == len(labels)
    assert all(label.isidentifier() and label.startswith("c3_") for label in labels.values())
    assert all(writer.label("c3", numbers, 1e-3) == label for numbers, label in labels.items())


def test_a_label_can_be_read():
    writer = Writer()
    assert writer.label("c3", (0.1, -0.25, 0.0), 1e-3) == "c3_100_n250_0"
    assert writer.label("c3", (0.1, -0.25, 1e-5), 1e-3) == "c3_100_n250_0_or1"
