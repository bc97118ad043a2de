"""Columns and their cells."""

from ikde.paper.columns import label, make_table, mark_off, ours, published
from ikde.report.page import Cell, Column


def test_a_table_has_a_cell_for_each_row_and_column():
    table = make_table([1, 2], (Column("one"), str), (Column("twice"), lambda k: str(2 * k)), caption="c", note="n")
    assert [column.title for column in table.columns] == ["one", "twice"]
    assert (table.rows, table.caption, table.note) == ((("1", "2"), ("2", "4")), "c", "n")


def test_a_column_shows_words_or_numbers_printed_or_ours():
    heads = [column for column, _ in (label("a", str), published("b", "mm", str, group="g"), ours("c", "", str))]
    assert [(head.align, head.unit, head.group, head.mark) for head in heads] == [
        ("left", "", "", ""),
        ("right", "mm", "g", "published"),
        ("right", "", "", "ours"),
    ]


def test_a_cell_that_does_not_agree_is_marked():
    assert (mark_off("1.0", True), mark_off("1.0", False)) == ("1.0", Cell("1.0", "off"))
