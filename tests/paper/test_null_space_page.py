"""The section on the page: its verdict, what it says of the paper's figures, tables and charts."""

import pytest

from ikde.paper.null_space_page import EQUATIONS, show_null_space
from ikde.report.page import Code, Figure, Notice, Table, Text


@pytest.fixture(scope="module")
def blocks(results, inputs):
    return show_null_space(results.sections["null_space"], inputs).blocks


def find(blocks, kind):
    return [block for block in blocks if isinstance(block, kind)]


def test_it_says_plainly_that_nothing_is_compared(blocks):
    (notice,) = find(blocks, Notice)
    assert "No figure and no experiment of the paper is about the null space" in notice.markup


def test_the_verdict_has_its_numbers(blocks, results):
    text = find(blocks, Text)[0].markup
    data = results.sections["null_space"]
    dragged = next(row for row in data.together if (row.law, row.first) == ("printed", "platform"))
    assert f"{dragged.tool_mm:.3g} mm" in text
    assert "m off: it is in the standard convention" in text


def test_every_equation_has_a_line(blocks):
    (code,) = find(blocks, Code)
    assert code.text == EQUATIONS
    for number in ("(1)", "(2)", "(3)", "(4,5)", "(6,7)", "(13-16)", "(24)", "(25)", "(26)", "(27)", "(28)"):
        assert f"\n{number}" in f"\n{EQUATIONS}"
    assert max(map(len, EQUATIONS.splitlines())) < 100


def test_tables_and_charts_are_whole(blocks, results):
    data = results.sections["null_space"]
    claims, together, conflict, switching, singular, slipping = find(blocks, Table)
    rows = [data.claims, data.together, data.conflict, data.switching, data.singular, data.slipping]
    assert [len(table.rows) for table in (claims, together, conflict, switching, singular, slipping)] == list(
        map(len, rows)
    )
    assert conflict.rows[6][4] == "–"
    assert "≤" not in str(claims.rows)
    charts = find(blocks, Figure)
    assert len(charts) == 4
    for chart in charts:
        assert "time [s]" in chart.image
        assert chart.caption.endswith("Ours; calibrated.")
    assert "speed of the platform along X [m/s]" in charts[1].image
    assert "switch begins" in charts[1].image


def test_rounding_is_shown_as_such(blocks):
    claims = find(blocks, Table)[0]
    shown = {row[1]: row[2].strip() for row in claims.rows}
    assert shown["forward times inverse, largest difference from 1"] == "< 1e-9"
    assert shown["one turn in 600 steps by the heading half-way: off by"] == "4.70e-06 m"
    assert any(what.endswith("(calibrated)") for what in shown)
