"""The page model: marks, heads and anchors."""

import pytest

from ikde.report.page import Cell, Column, Page, Section, Table, slug
from tests.report.pages import RATES


def test_a_row_of_wrong_length_is_refused_where_it_is_made():
    with pytest.raises(ValueError, match="Rates: row 1 has 1 cells for 2 columns"):
        Table(columns=(Column("a"), Column("b")), rows=(("1", "2"), ("3",)), caption="Rates")


def test_a_cell_takes_the_mark_of_its_column_unless_it_has_its_own():
    marks = [[cell.mark for cell in row] for row in RATES.cells()]
    assert marks == [["", "published", "ours"], ["", "published", "off"], ["", "published", "ours"]]
    assert RATES.cells()[1][2] == Cell("82.1", "off")


@pytest.mark.parametrize(
    ("column", "head"),
    [
        (Column("time", "ms"), "time [ms]"),
        (Column("time", "ms", group="ours"), "ours: time [ms]"),
        (Column("name"), "name"),
    ],
)
def test_a_head_that_stands_alone_says_group_and_unit(column, head):
    assert column.head == head


def test_heads_are_written_as_those_of_the_terminal():
    words, right, unit = Column.of("arm", ">solves", ">time [ms]")
    assert words == Column("arm", align="left")
    assert right == Column("solves")
    assert unit == Column("time", "ms")


def test_neighbours_of_one_group_share_a_head():
    groups = ("", "print", "print", "ours", "print")
    table = Table(columns=tuple(Column("a", group=g) for g in groups), rows=(), caption="")
    assert table.groups() == [("", 1), ("print", 2), ("ours", 1), ("print", 1)]
    assert Table(columns=(Column("a"), Column("b")), rows=(), caption="").groups() == []


def test_anchors_come_from_titles_and_are_there_once():
    titles = ("Table 4: rates", "Rates", "Rates", "Rates", "Rates 2", "§")
    page = Page(title="", sections=tuple(Section(title, ()) for title in titles))
    anchors = page.anchors()
    assert anchors[:3] == ["table-4-rates", "rates", "rates-2"]
    assert len(set(anchors)) == len(titles)
    assert Page(title="", sections=(Section("Rates", (), "here"),)).anchors() == ["here"]


@pytest.mark.parametrize("titles", [("A 2", "A", "A"), ("A", "A 3", "A", "A"), ("A", "A", "A 2", "A 2")])
def test_an_anchor_that_is_taken_is_not_made(titles):
    anchors = Page(title="", sections=tuple(Section(title, ()) for title in titles)).anchors()
    assert len(set(anchors)) == len(titles)


def test_a_slug_is_never_empty():
    assert slug("§") == "section"
