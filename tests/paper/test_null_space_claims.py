"""Each number of the equations, with its tolerance."""

import numpy as np
import pytest

from ikde.paper.null_space_claims import compute_claims, exact_path, measure_headings
from tests.paper.zhang import ARM, START


@pytest.fixture(scope="module")
def claims():
    return compute_claims(ARM, START)


def find(claims, equation, words):
    (value,) = [claim.value for claim in claims if claim.equation == equation and words in claim.what]
    return value


def test_what_should_be_nothing_is_nothing(claims):
    for equation, words in (
        ("(1)", "forward times inverse"),
        ("(1)", "pseudo-inverse"),
        ("(2)", "exact arc"),
        ("(4), (5)", "a row down"),
        ("(24), (25)", "rad/s: the first task"),
        ("(24), (25)", "m/s: the first task"),
        ("(24), (25)", "closed forms"),
        ("exact", "both tasks"),
        ("exact", "both orders"),
        ("(26)", "of exact ones"),
    ):
        assert find(claims, equation, words) < 1e-12, (equation, words)


@pytest.mark.parametrize(
    ("equation", "words", "value", "within"),
    [
        ("(2)", "before the step", 5.4e-3, 0.01),
        ("(2)", "after it", 5.4e-3, 0.01),
        ("(2)", "half-way", 4.7e-6, 0.02),
        ("(3)", "unturned", 1.915, 0.001),
        ("(14)", "ground sees", 0.2, 1e-9),
        ("(15)", "E + S", 1.8, 1e-9),
        ("(4), (5)", "median", 0.82, 0.05),
        ("(4), (5)", "largest", 1.75, 0.05),
        ("(26)", "printed laws", 0.46, 0.15),
        ("(28)", "1 %", 1.5, 0.06),
        ("(28)", "50 %", 4.2, 0.05),
        ("(28)", "90 %", 10.4, 0.05),
        ("(28)", "99 %", 27.0, 0.1),
    ],
)
def test_what_should_be_something_is_that(claims, equation, words, value, within):
    assert find(claims, equation, words) == pytest.approx(value, rel=within)


def test_the_second_task_is_missed(claims):
    """How much depends on the unit of the columns, which no law should."""
    assert 0.01 < find(claims, "(24)", "rad/s") < 0.1
    assert find(claims, "(25)", "rad/s") > 0.5
    assert find(claims, "(24)", "m/s") > 0.5
    assert find(claims, "(25)", "m/s") > 0.5


def test_every_number_says_what_it_rests_on(claims):
    kinds = {claim.kind for claim in claims}
    assert kinds == {"derived", "calibrated"}
    assert {claim.equation for claim in claims if claim.kind == "calibrated"} == {"(24)", "(25)", "(26)"}
    assert len({(claim.equation, claim.what) for claim in claims}) == len(claims)


def test_headings_of_dead_reckoning():
    coarse, fine = measure_headings(0.2), measure_headings(0.1)
    assert coarse["heading before the step"] / fine["heading before the step"] == pytest.approx(2.0, rel=0.01)
    assert coarse["heading half-way"] / fine["heading half-way"] == pytest.approx(4.0, rel=0.02)
    np.testing.assert_allclose(exact_path(np.array(60.0)), [0, 0], atol=1e-15)
    np.testing.assert_allclose(exact_path(np.array(30.0)), [-0.38197, 0.95493], atol=1e-5)
