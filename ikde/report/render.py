"""A rich renderable as a string."""

from io import StringIO
from typing import Any

from ikde.errors import printable

# What rich reads as markup, and what stands for it in plain text until the lines are laid out: private characters,
# which no printable text holds.
_MARKS = {ord("["): "\ue000", ord("\\"): "\ue001"}
_BACK = {ord(stand_in): chr(mark) for mark, stand_in in _MARKS.items()}


def render(*renderables: Any, color: bool = False, width: int = 100) -> str:
    """Lay renderables out as text of at most `width` columns, with ANSI colours only if asked."""
    from rich.console import Console

    buffer = StringIO()
    console = Console(file=buffer, force_terminal=color, no_color=not color, width=width, highlight=False, emoji=False)
    for renderable in renderables:
        console.print(renderable)
    lines = [line.rstrip() for line in buffer.getvalue().translate(_BACK).splitlines()]
    return "\n".join(line for line, before in zip(lines, ["x", *lines], strict=False) if line or before).strip("\n")


def plain(text: str) -> str:
    """Text that is shown as it is: names and reasons may hold brackets, which rich would read as markup, and worse."""
    return printable(text).translate(_MARKS)


def make_table(*columns: str, title: str | None = None) -> Any:
    """A table with a line under its header; a column whose name starts with `>` is right-aligned."""
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    table = Table(
        title=plain(title) if title else None, title_justify="left", title_style="bold", box=SIMPLE_HEAD, pad_edge=False
    )
    for column in columns:
        table.add_column(plain(column.removeprefix(">")), justify="right" if column.startswith(">") else "left")
    return table
