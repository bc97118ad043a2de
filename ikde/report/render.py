"""A rich renderable as a string."""

from io import StringIO
from typing import Any

from ikde.errors import printable

# What rich reads as markup, and what stands for it in plain text until the lines are laid out: private characters,
# which no printable text holds.
_MARKS = {ord("["): "\ue000", ord("\\"): "\ue001"}
_BACK = {ord(stand_in): chr(mark) for mark, stand_in in _MARKS.items()}

MAX_WIDTH = 10_000  # columns of a page that is as wide as it likes


def render(*renderables: Any, color: bool = False, width: int = 100) -> str:
    """Lay renderables out as text of at most `width` columns, with ANSI colours only if asked.

    A table of `make_table` that is too wide moves together, leaves out what may be left out, and folds its texts.
    """
    from rich.console import Console
    from rich.table import Table

    buffer = StringIO()
    colors: dict[str, Any] = {"force_terminal": color, "color_system": "standard" if color else None, "no_color": False}
    console = Console(file=buffer, width=width, highlight=False, emoji=False, **colors)
    for renderable in renderables:
        if isinstance(renderable, Table):
            _narrow(renderable, console)
        console.print(renderable)
    lines = [line.rstrip() for line in buffer.getvalue().translate(_BACK).splitlines()]
    return "\n".join(line for line, before in zip(lines, ["x", *lines], strict=False) if line or before).strip("\n")


def plain(text: str) -> str:
    """Text that is shown as it is: names and reasons may hold brackets, which rich would read as markup, and worse."""
    return printable(text).translate(_MARKS)


def make_table(*columns: str, title: str | None = None) -> Any:
    """A table with a line under its header.

    A column whose name starts with `>` is right-aligned, and its words are whole; one that starts with `?` is left out
    where there is no room for it.
    """
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    table = Table(
        title=plain(title) if title else None, title_justify="left", title_style="bold", box=SIMPLE_HEAD, pad_edge=False
    )
    for column in columns:
        right, spare = column.startswith(">"), column.startswith("?")
        justify = "right" if right else "left"
        table.add_column(plain(column[right or spare :]), justify=justify, overflow="fold", ratio=0 if spare else None)
    return table


def _narrow(table: Any, console: Any) -> None:
    """Make a table fit: smaller gaps, then texts on several lines, then without columns to spare, the last first."""
    if _measure(table, console) <= console.width:
        return
    table.collapse_padding = True
    if _share_room(table, console):
        return
    while spare := [column for column in table.columns if column.ratio is not None]:
        table.columns.remove(spare[-1])
        for place, column in enumerate(table.columns):
            column._index = place  # from which rich knows what stands at an edge
        if _share_room(table, console):
            return
    for column in table.columns:
        column.width = max(map(_longest_word, _cells(column))) if column.justify == "right" else None


def _share_room(table: Any, console: Any) -> bool:
    """Give columns the widths that they need, or, the widest first, fewer; False if words would have to be folded."""
    widths = [max(map(_width, _cells(column))) for column in table.columns]
    least = [max(map(_longest_word, _cells(column))) for column in table.columns]
    over = _measure(table, console) - console.width
    while over > 0:
        wide = max(range(len(widths)), key=lambda k: (widths[k] > least[k], widths[k]))
        if widths[wide] <= least[wide]:
            return False
        widths[wide] -= 1
        over -= 1
    for column, width in zip(table.columns, widths, strict=True):
        column.width = width
    return True


def _measure(table: Any, console: Any) -> int:
    """Columns that a table would take up if it could."""
    from rich.measure import Measurement

    return Measurement.get(console, console.options.update(max_width=MAX_WIDTH), table).maximum


def _cells(column: Any) -> list[str]:
    return [str(cell) for cell in (column.header, *column.cells)]


def _width(cell: str) -> int:
    from rich.text import Text

    return Text.from_markup(cell).cell_len


def _longest_word(cell: str) -> int:
    from rich.text import Text

    return max((Text(word).cell_len for word in Text.from_markup(cell).plain.split()), default=1)
