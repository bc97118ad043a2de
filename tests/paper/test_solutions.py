"""Table 5 graded again, and solutions of our own."""

import numpy as np
import pytest

import ikde
from ikde.paper.plain_search import limit_base
from ikde.paper.solutions import BASE_M, describe_verdict, read_row, show_solutions
from ikde.report.page import Cell, Gallery, Table
from tests.paper.conftest import is_plain


@pytest.fixture(scope="module")
def section(results):
    return results.sections["solutions"]


def test_printed_errors_are_ours_to_four_digits(section):
    for row in section.published:
        assert f"{row.ME_mm.ours:.4f}" == f"{row.ME_mm.meant:.4f}"
        assert (row.ME_mm.printed != row.ME_mm.meant) == ("ME_mm" in (row.misprint or {}))
        assert row.outside_limits == []


def test_every_label_but_that_of_the_row_printed_twice_agrees(section):
    wrong = [(row.target, row.row) for row in section.published if not row.label.agrees]
    assert wrong == [("2", "f1")]


def test_our_free_solutions_are_free_with_both_and_the_colliding_ones_are_not(section):
    ours = section.ours
    assert [(row.target, row.row) for row in ours] == [(t, r) for t in "12" for r in ("s1", "s2", "s3", "f1")]
    for row in ours:
        typical, improved = (row.detectors[name] for name in ("typical", "improved"))
        assert row.reached
        if row.row == "f1":
            assert typical.collides
            assert len(typical.colliding_components) >= 2
        else:
            assert not typical.collides
            assert not improved.collides


def test_our_solutions_hold_when_graded_from_their_printed_form(qiao, published, section):
    assert is_plain(section)
    tolerance = section.settings["position_tolerance_mm"]
    for row in section.ours:
        q = read_row(qiao, row.printed_q)
        np.testing.assert_allclose(q, row.q, atol=1e-12)
        tip = 1e3 * ikde.forward(qiao, q)["tool"][:3, 3]
        assert np.linalg.norm(tip - published["targets_mm"][row.target]) <= tolerance
        assert np.abs(q[:2]).max() <= BASE_M


def test_only_the_prismatic_joints_are_limited(qiao):
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


@pytest.fixture(scope="module")
def shown(section, inputs):
    return show_solutions(section, inputs)


def tables(section):
    return [block for block in section.blocks if isinstance(block, Table)]


def test_every_printed_row_is_graded(shown):
    published = tables(shown)[0]
    assert [(row[0], row[1]) for row in published.rows] == [
        *[("1", name) for name in ("s1", "s2", "s3", "f1", "f2")],
        *[("2", name) for name in ("s1", "s2", "s3", "f1", "f2")],
    ]
    assert published.rows[0][2:4] == ("0.0359", "0.0359")


def test_misprints_are_marked_and_explained(shown):
    published = tables(shown)[0]
    assert published.rows[3][2:4] == (Cell("0.0129", "off"), "0.0028")
    assert published.rows[8][5] == Cell("typical collides", "off")
    assert "0.0028 mm is meant" in published.note


def test_joint_values_stand_as_printed(shown):
    joints = tables(shown)[2]
    assert joints.rows[0][2:] == (
        *("-0.0008", "0.8659", "1.6368", "1.0156", "0.9326", "-0.0388", "0.4905", "2.8275", "0.6857"),
    )


def test_ours_are_free_and_colliding_and_drawn_as_both_detectors_see_them(section, shown):
    ours = section.ours
    assert all(not row.detectors["typical"].collides for row in ours if row.row.startswith("s"))
    gallery = next(block for block in shown.blocks if isinstance(block, Gallery))
    assert len(gallery.figures) == 8
    assert "target 1, s1, typical: free" in gallery.figures[0].caption
    assert "target 1, f1, typical: collision of" in gallery.figures[2].caption
    assert all(len(figure.image) < 200_000 for figure in gallery.figures)
