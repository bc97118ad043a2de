"""Table 5 graded again, and solutions of our own."""

import numpy as np
import pytest

import ikde
from ikde.bench.solutions import BASE_M, compute_solutions, describe_verdict, limit_base, read_row
from tests.bench.conftest import is_plain


@pytest.fixture(scope="module")
def section(qiao, published):
    return compute_solutions(qiao, published)


def test_printed_errors_are_ours_to_four_digits(section):
    for row in section["exact"]["published"]:
        assert f"{row['ME_mm']['ours']:.4f}" == f"{row['ME_mm']['meant']:.4f}"
        assert (row["ME_mm"]["printed"] != row["ME_mm"]["meant"]) == ("ME_mm" in (row["misprint"] or {}))
        assert row["outside_limits"] == []


def test_every_label_but_that_of_the_row_printed_twice_agrees(section):
    wrong = [(row["target"], row["row"]) for row in section["exact"]["published"] if not row["label"]["agrees"]]
    assert wrong == [("2", "f1")]


def test_our_free_solutions_are_free_with_both_and_the_colliding_ones_are_not(section):
    ours = section["exact"]["ours"]
    assert [(row["target"], row["row"]) for row in ours] == [(t, r) for t in "12" for r in ("s1", "s2", "s3", "f1")]
    for row in ours:
        typical, improved = (row["detectors"][name] for name in ("typical", "improved"))
        assert row["reached"]
        if row["row"] == "f1":
            assert typical["collides"]
            assert len(typical["colliding_components"]) >= 2
        else:
            assert not typical["collides"]
            assert not improved["collides"]


def test_our_solutions_hold_when_graded_from_their_printed_form(qiao, published, section):
    assert is_plain(section)
    tolerance = section["settings"]["position_tolerance_mm"]
    for row in section["exact"]["ours"]:
        q = read_row(qiao, {"q": row["printed_q"]})
        np.testing.assert_allclose(q, row["q"], atol=1e-12)
        tip = 1e3 * ikde.forward(qiao, q)["tool"][:3, 3]
        assert np.linalg.norm(tip - published["targets_mm"][row["target"]]) <= tolerance
        assert np.abs(q[:2]).max() <= BASE_M


def test_only_the_slides_are_limited(qiao):
    near = limit_base(qiao, 0.1)
    assert near.upper[:2].tolist() == [0.1, 0.1]
    assert near.upper[2:].tolist() == qiao.upper[2:].tolist()


@pytest.mark.parametrize(
    ("typical", "improved", "text"),
    [
        (False, False, "free with both"),
        (True, True, "both collide"),
        (True, False, "typical collides"),
        (False, True, "improved collides"),
    ],
)
def test_verdicts_in_words(typical, improved, text):
    assert describe_verdict(typical, improved) == text
