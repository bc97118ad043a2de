"""The little markup of a page's text: `` `code` ``, `**bold**` and `[text](#anchor)`.

A backslash takes a mark at its face value; `verbatim` does so for text from elsewhere.
"""

import re
from dataclasses import dataclass
from typing import Literal

from ikde.errors import printable

_FACE = r"\\(?P<face>[\\`*\[\]-])"
_CODE = r"`(?P<code>[^`]+)`"
_BOLD = r"\*\*(?P<bold>(?:\\.|[^*\\])+)\*\*"
_LINK = r"\[(?P<link>(?:\\.|[^\]\\])+)\]\((?P<href>#[^)\s]+)\)"  # inside the page, and nowhere else
_MARKS = re.compile("|".join((_FACE, _CODE, _BOLD, _LINK)))


@dataclass(frozen=True, slots=True)
class Span:
    """A piece of a line."""

    text: str
    kind: Literal["plain", "code", "bold", "link"] = "plain"
    href: str = ""


@dataclass(frozen=True, slots=True)
class Paragraph:
    """One paragraph, or the items of a list."""

    lines: tuple[str, ...]
    is_list: bool = False


def as_line(text: str) -> str:
    """Text on one line: line breaks are blanks in a page, and all else that is not printable is written out."""
    return printable(re.sub(r"\s", " ", text))


def verbatim(text: str) -> str:
    """Markup that shows `text` as it is: names and reasons may hold brackets and stars, line breaks and worse."""
    return re.sub(r"^-|[\\`*\[\]]", r"\\\g<0>", as_line(text))


def code(text: str) -> str:
    """Markup that shows `text` as code, where nothing needs a backslash; a backtick cannot stand in code."""
    return verbatim(text) if "`" in text or not text else f"`{as_line(text)}`"


def parse_line(markup: str) -> list[Span]:
    """Cut a line into its pieces; neighbours of plain text are one."""
    spans, end = [], 0
    for match in _MARKS.finditer(markup):
        spans += [Span(markup[end : match.start()]), _span(match)]
        end = match.end()
    return _join([span for span in (*spans, Span(markup[end:])) if span.text])


def _join(spans: list[Span]) -> list[Span]:
    """A mark taken at its face value is text like that around it, and is escaped together with it."""
    joined: list[Span] = []
    for span in spans:
        if joined and joined[-1].kind == span.kind == "plain":
            joined[-1] = Span(joined[-1].text + span.text)
        else:
            joined.append(span)
    return joined


def _span(match: re.Match[str]) -> Span:
    if match["face"]:
        return Span(match["face"])
    if match["code"]:
        return Span(match["code"], "code")
    text = re.sub(r"\\(.)", r"\1", match["bold"] or match["link"])
    return Span(text, "bold") if match["bold"] else Span(text, "link", match["href"])


def parse_text(markup: str) -> list[Paragraph]:
    """Cut a text into paragraphs, at empty lines; one whose lines open with `- ` is a list."""
    parts = [part.strip() for part in re.split(r"\n\s*\n", markup)]
    return [_paragraph(part) for part in parts if part]


def _paragraph(part: str) -> Paragraph:
    if not part.startswith("- "):
        return Paragraph((" ".join(part.split()),))
    items = re.split(r"(?:^|\n)\s*- ", part)[1:]
    return Paragraph(tuple(" ".join(item.split()) for item in items), is_list=True)
