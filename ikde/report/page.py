"""A page of results as plain data: sections of text, tables and figures, with no word about how they are shown.

Fields that hold *markup* (`markup.py`) say so; titles, labels and table cells are text as it is.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import chain, count, groupby
from typing import Literal

Align = Literal["left", "right"]
Mark = Literal["", "published", "ours", "off"]

TimeBox = tuple[float, float, float, float, float, float]
"""A chart over time: left, right, top and bottom in units of its SVG, and the times in s at its left and right."""

MAX_ROOMY_COLUMNS = 12
TEXT_WIDTH, CELL_PADDING, WRAPPED = 78, 4, 24  # letters of a line of text, between columns, and in a cell that wraps


@dataclass(frozen=True, slots=True)
class Text:
    """Paragraphs of markup with an empty line between them; a paragraph of lines that open with `- ` is a list."""

    markup: str


@dataclass(frozen=True, slots=True)
class Notice:
    """Markup that must not be overlooked."""

    markup: str


@dataclass(frozen=True, slots=True)
class Number:
    """One figure that is worth large type: `96.4 %`, what it is, and a remark below."""

    value: str
    label: str
    note: str = ""


@dataclass(frozen=True, slots=True)
class Numbers:
    """A row of large figures."""

    items: tuple[Number, ...]


@dataclass(frozen=True, slots=True)
class Facts:
    """Names and their values (markup)."""

    items: tuple[tuple[str, str], ...]


@dataclass(frozen=True, slots=True)
class Code:
    """Lines to copy, such as the commands that make a table again."""

    text: str
    caption: str = ""


@dataclass(frozen=True, slots=True)
class Column:
    """Head of one column. Neighbours of one `group` share a head above theirs; `mark` holds for all its cells."""

    title: str
    unit: str = ""
    align: Align = "right"
    group: str = ""
    mark: Mark = ""

    @property
    def head(self) -> str:
        """The head where it stands alone: `ours: time [ms]`."""
        group = f"{self.group}: " if self.group else ""
        return f"{group}{self.title} [{self.unit}]" if self.unit else f"{group}{self.title}"

    @classmethod
    def of(cls, *heads: str) -> tuple["Column", ...]:
        """Columns by their heads, written as for the terminal's `make_table`: `arm`, `>solves`, `>time [ms]`."""
        return tuple(map(_read_head, heads))


def _read_head(head: str) -> Column:
    title, _, unit = head.removesuffix("]").partition(" [")
    return Column(title.removeprefix(">"), unit, "right" if head.startswith(">") else "left")


@dataclass(frozen=True, slots=True)
class Cell:
    """A cell that differs from its column: published, ours, or `off` (does not agree with what it should)."""

    text: str
    mark: Mark


@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """Rows of text below columns; `caption` above it and `note` under it are markup."""

    columns: tuple[Column, ...]
    rows: tuple[tuple[str | Cell, ...], ...]
    caption: str
    note: str = ""

    def __post_init__(self) -> None:
        """Find a row of wrong length where it is made, not where it is shown."""
        for number, row in enumerate(self.rows):
            if len(row) != len(self.columns):
                raise ValueError(f"{self.caption}: row {number} has {len(row)} cells for {len(self.columns)} columns")

    @property
    def is_dense(self) -> bool:
        """True if it is shown in small print, to fit."""
        return len(self.columns) > MAX_ROOMY_COLUMNS

    @property
    def is_wide(self) -> bool:
        """True if it takes more than the width of the text: all that there is then."""
        heads = [len(column.head.removeprefix(f"{column.group}: ")) for column in self.columns]
        longest = [max(map(len, column)) for column in zip(*self.texts(), strict=True)] or [0] * len(heads)
        widths = [max(head, min(cell, WRAPPED)) for head, cell in zip(heads, longest, strict=True)]
        return sum(widths) + CELL_PADDING * len(widths) > TEXT_WIDTH

    def texts(self) -> list[list[str]]:
        """What all cells say."""
        return [[cell if isinstance(cell, str) else cell.text for cell in row] for row in self.rows]

    def cells(self) -> list[list[Cell]]:
        """All cells, each with the mark it is shown with."""
        marks: list[Mark] = [column.mark for column in self.columns]
        return [
            [Cell(cell, mark) if isinstance(cell, str) else cell for cell, mark in zip(row, marks, strict=True)]
            for row in self.rows
        ]

    def groups(self) -> list[tuple[str, int]]:
        """Heads above the heads with the number of columns below them; empty if no column has a group."""
        spans = [(name, len(list(columns))) for name, columns in groupby(self.columns, lambda column: column.group)]
        return spans if any(name for name, _ in spans) else []


@dataclass(frozen=True, slots=True, kw_only=True)
class Figure:
    """A picture: SVG text, which takes the page's colours, or the bytes of a PNG, which is shown on white."""

    image: str | bytes = field(repr=False)
    alt: str
    caption: str = ""
    time_boxes: tuple[TimeBox, ...] = ()
    """Of an SVG: the charts over time in it, in which the moment of an animation is marked."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Animation:
    """A motion that the page plays: `data` is what `plot.animation` makes of a drawn motion, as JSON."""

    data: str = field(repr=False)
    alt: str
    caption: str = ""


@dataclass(frozen=True, slots=True)
class Gallery:
    """Figures side by side, as far as the window is wide."""

    figures: tuple[Figure | Animation, ...]
    narrow: bool = False
    """Three to a row instead of two."""


@dataclass(frozen=True, slots=True)
class Details:
    """Blocks below a line of text, shown when it is opened."""

    summary: str
    blocks: "tuple[Block, ...]"


Block = Text | Notice | Numbers | Facts | Code | Table | Figure | Animation | Gallery | Details


@dataclass(frozen=True, slots=True)
class Section:
    """A heading and what stands below it; `[...](#anchor)` leads here."""

    title: str
    blocks: tuple[Block, ...]
    anchor: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Page:
    """A whole report: `lead` stands above the contents, `footer` (markup) closes the page."""

    title: str
    sections: tuple[Section, ...]
    subtitle: str = ""
    lead: tuple[Block, ...] = ()
    footer: str = ""

    @property
    def moves(self) -> bool:
        """True if it holds an animation."""
        blocks = chain(self.lead, *(section.blocks for section in self.sections))
        return any(isinstance(block, Animation) for block in chain.from_iterable(map(_unfold, blocks)))

    def anchors(self) -> list[str]:
        """One anchor a section, each of them once: given, or made from the title."""
        taken: list[str] = []
        for section in self.sections:
            anchor = section.anchor or slug(section.title)
            choices = chain([anchor], (f"{anchor}-{number}" for number in count(2)))
            taken.append(next(choice for choice in choices if choice not in taken))
        return taken


def _unfold(block: Block) -> Sequence[Block]:
    match block:
        case Gallery(figures):
            return figures
        case Details(_, blocks):
            return blocks
    return (block,)


def slug(title: str) -> str:
    """`Table 4: rates` as `table-4-rates`."""
    return re.sub(r"[^a-z0-9]+", "-", title.lower()).strip("-") or "section"
