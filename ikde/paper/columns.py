"""Columns of the report's tables: a head and what it shows of a row, words or numbers, printed or ours."""

from collections.abc import Callable, Iterable
from typing import TypeVar

from ikde.report.page import Cell, Column, Mark, Table

Row = TypeVar("Row")
Shown = tuple[Column, Callable[[Row], str | Cell]]


def label(title: str, show: Callable[[Row], str | Cell], group: str = "", mark: Mark = "") -> Shown[Row]:
    """A column of words."""
    return Column(title, align="left", group=group, mark=mark), show


def published(title: str, unit: str, show: Callable[[Row], str | Cell], group: str = "") -> Shown[Row]:
    """A column of printed numbers."""
    return Column(title, unit, group=group, mark="published"), show


def ours(title: str, unit: str, show: Callable[[Row], str | Cell], group: str = "") -> Shown[Row]:
    """A column of our numbers."""
    return Column(title, unit, group=group, mark="ours"), show


def mark_off(text: str, agrees: bool) -> str | Cell:
    """A cell, marked ≠ where it does not agree."""
    return text if agrees else Cell(text, "off")


def make_table(rows: Iterable[Row], *columns: Shown[Row], caption: str, note: str = "") -> Table:
    """A table of columns, each beside what it shows of a row."""
    return Table(
        columns=tuple(column for column, _ in columns),
        rows=tuple(tuple(show(row) for _, show in columns) for row in rows),
        caption=caption,
        note=note,
    )
