"""Dong and Zhao's section on the page: every table, what is marked, and what the text counts."""

import pytest

from ikde.paper.manipulability_page import show_manipulability
from ikde.report.page import Cell, Table, Text


@pytest.fixture(scope="module")
def data(results):
    return results.sections["manipulability"]


@pytest.fixture(scope="module")
def blocks(data, inputs):
    return show_manipulability(data, inputs).blocks


@pytest.fixture(scope="module")
def tables(blocks):
    names = ("lengths", "claims", "singular", "rigidity", "angles", "optima", "space", "peaks", "units", "found")
    return dict(zip(names, [block for block in blocks if isinstance(block, Table)], strict=True))


def test_every_row_of_the_data_has_its_row(tables, data):
    for name in ("lengths", "claims", "singular", "rigidity", "angles", "optima", "space", "found"):
        assert len(tables[name].rows) == len(getattr(data, name))
    assert [row[:2] for row in tables["peaks"].rows] == [("θ4", "27"), ("θ3", "198"), ("θ2", "22.5")]
    assert [row[1:] for row in tables["units"].rows] == [
        ("358.5, 138.0", "3.0, 115.5", "12.0, 205.5"),
        ("180.0, 348.0", "139.5, 52.5", "139.5, 55.5"),
    ]


def test_printed_optima_in_both_readings(tables):
    first = tables["optima"].rows[0]
    assert first[1:5] == ("θ2, θ3 at θ4 = 27", "as printed", "114.18535, 40.52064", "114.13, 40.50")
    assert first[5] == Cell("358.5, 138.0", "off")
    angle = tables["angles"].rows[1]
    assert angle[1:6] == ("θ3", "40.52064", "0.7068601", "40.5001", "27")


def test_what_does_not_hold_is_marked(tables):
    assert [isinstance(row[2], Cell) for row in tables["claims"].rows] == [False, False] + [True] * 7
    assert tables["rigidity"].rows[0][-1] == Cell("no", "off")
    assert [isinstance(row[6], Cell) for row in tables["angles"].rows] == [True] + [False] * 8
    assert all(isinstance(cell, Cell) for row in tables["found"].rows if row[2] == "all" for cell in row[4:])


def test_rounding_errors_are_called_small(tables):
    assert tables["claims"].rows[0][3] == "largest change < 1e-12"
    assert tables["singular"].rows[0][5:] == ("< 1e-12", "0.0625")
    assert tables["claims"].rows[2][3].startswith("l_m = 0: as large at 180 in 100 %; larger there in 0 %")


def test_the_text_counts_and_says_that_a_search_is_no_proof(data, blocks):
    texts = [block.markup for block in blocks if isinstance(block, Text)]
    assert "Of 9 claims 2 hold as they stand" in texts[0]
    assert "8 of 9 of those are whole steps of 1.5 deg" in texts[1]
    (found,) = [text for text in texts if text.startswith("**What lengths allow.**")]
    assert "Found by search at θ1 = 0, no proof" in found
    all_three = [row for row in data.found if all(figure.is_sought for figure in row.figures)]
    for row in all_three:
        assert f"{100 * max(figure.below for figure in row.figures):.0f} %" in found
