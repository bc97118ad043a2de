"""A page as Markdown: tables as pipe tables, figures named where they would stand."""

import re
from collections.abc import Callable, Mapping
from typing import Any

from ikde.errors import printable
from ikde.report.markup import as_line, parse_line, parse_text
from ikde.report.page import (
    Animation,
    Block,
    Cell,
    Code,
    Details,
    Facts,
    Figure,
    Gallery,
    Notice,
    Numbers,
    Page,
    Table,
    Text,
)

_RULES = {"left": ":--", "right": "--:"}
_MARKS = {"": "{}", "published": "_{}_", "ours": "**{}**", "off": "≠ **{}**"}
_SPECIAL = re.compile(r"[\\`*|~$]|\b_|_\b|\](?=\()|:(?=//)|(?<=www)\.")  # a lone bracket or underscore is no mark
_OPENING = re.compile(r"^(?=[#>+=-])|(?<=^\d)(?=[.)])")  # of a line, by which it would be a heading, a list, a rule


def render_markdown(page: Page) -> str:
    """The whole file as text; the pictures are in the HTML page."""
    parts = [f"# {_plain(page.title)}", _plain_line(page.subtitle), *map(_block, page.lead)]
    for section in page.sections:
        parts += [f"## {_plain(section.title)}", *map(_block, section.blocks)]
    parts.append(_text(page.footer))
    return "\n\n".join(part for part in parts if part) + "\n"


def _block(block: Block) -> str:
    return _WRITERS[type(block)](block)


def _plain(text: str) -> str:
    """Text that Markdown shows as it is, also inside a table."""
    escaped = _SPECIAL.sub(lambda match: f"\\{match[0]}", as_line(re.sub(r"\s+", " ", text)))
    return re.sub(r"&(?=#?\w+;)", "&amp;", escaped).replace("<", "&lt;")


def _plain_line(text: str) -> str:
    """The same at the beginning of a line."""
    return _OPENING.sub(r"\\", _plain(text).lstrip())


def _line(markup: str) -> str:
    parts = []
    for number, span in enumerate(parse_line(markup)):
        match span.kind:
            case "code":
                parts.append(f"`{printable(span.text)}`")
            case "bold":
                parts.append(f"**{_plain(span.text)}**")
            case "link":
                parts.append(f"[{_plain(span.text)}]({span.href})")
            case "plain":
                parts.append(_plain(span.text) if number else _plain_line(span.text))
    return "".join(parts).strip()


def _text(markup: str) -> str:
    paragraphs = []
    for paragraph in parse_text(markup):
        bullet = "- " if paragraph.is_list else ""
        paragraphs.append("\n".join(f"{bullet}{_line(line)}" for line in paragraph.lines))
    return "\n\n".join(paragraphs)


def _notice(notice: Notice) -> str:
    return "\n".join(f"> {line}".rstrip() for line in _text(notice.markup).splitlines())


def _numbers(numbers: Numbers) -> str:
    notes = [f" ({_plain(item.note)})" if item.note else "" for item in numbers.items]
    items = zip(numbers.items, notes, strict=True)
    return "\n".join(f"- **{_plain(item.value)}** {_plain(item.label)}{note}" for item, note in items)


def _facts(facts: Facts) -> str:
    return "\n".join(f"- {_plain(name)}: {_line(value)}" for name, value in facts.items)


def _code(block: Code) -> str:
    caption = f"{_line(block.caption)}\n\n" if block.caption else ""
    text = printable(block.text.rstrip(), keep="\n")
    fence = "`" * max(3, 1 + max(map(len, re.findall("`+", text)), default=0))
    return f"{caption}{fence}\n{text}\n{fence}"


def _table(table: Table) -> str:
    rows = [
        [_plain(column.head) for column in table.columns],
        [_RULES[column.align] for column in table.columns],
        *([_cell(cell) for cell in row] for row in table.cells()),
    ]
    lines = "\n".join(f"| {' | '.join(row)} |" for row in rows)
    empty = "" if table.rows else "\n\nnone"
    note = f"\n\n{_line(table.note)}" if table.note else ""
    return f"{_line(table.caption)}\n\n{lines}{empty}{note}"


def _cell(cell: Cell) -> str:
    return _MARKS[cell.mark].format(_plain(cell.text)) if cell.text else ""


def _figure(figure: Figure | Animation) -> str:
    caption = f" {_line(figure.caption)}" if figure.caption else ""
    return f"_{type(figure).__name__} in the HTML page: {_plain(figure.alt)}_{caption}"


def _details(details: Details) -> str:
    return "\n\n".join([f"**{_plain(details.summary)}**", *map(_block, details.blocks)])


_WRITERS: Mapping[type, Callable[[Any], str]] = {
    Text: lambda text: _text(text.markup),
    Notice: _notice,
    Numbers: _numbers,
    Facts: _facts,
    Code: _code,
    Table: _table,
    Figure: _figure,
    Animation: _figure,
    Details: _details,
    Gallery: lambda gallery: "\n\n".join(map(_figure, gallery.figures)),
}
