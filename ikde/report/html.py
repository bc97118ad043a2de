"""A page as one HTML file that needs nothing else: no network, no fonts, no script but a copy button and a player.

All text is escaped. A browser that obeys the page's policy runs its own script, known by its hash, and no other.
"""

import base64
import json
import re
from functools import cache
from hashlib import sha256
from itertools import count
from typing import Any

from ikde.errors import printable
from ikde.report.markup import parse_line, parse_text
from ikde.report.page import Figure, Page

_TAGS = {"code": "code", "bold": "strong"}
_IDS = re.compile(r'(\bid="|href="#|url\(#)')
_TAG = re.compile(r"<[^>]*>")


def render_html(page: Page) -> str:
    """The whole file as text; the same page gives the same text."""
    numbers, script = count(1), _script(page.moves)
    return (
        _environment()
        .get_template("page.html")
        .render(
            page=page,
            script=script,
            script_hash=base64.b64encode(sha256(script.encode()).digest()).decode("ascii"),
            sections=list(zip(page.anchors(), page.sections, strict=True)),
            picture=lambda figure: _picture(figure, next(numbers)),
            kind=lambda block: type(block).__name__,
        )
    )


@cache
def _environment() -> Any:
    from jinja2 import Environment, PackageLoader, StrictUndefined

    loader = PackageLoader("ikde.report", "templates")
    environment = Environment(loader=loader, autoescape=True, undefined=StrictUndefined, finalize=_finalize)
    environment.trim_blocks = environment.lstrip_blocks = True
    environment.filters.update(line=_line, paragraphs=parse_text)
    return environment


def _script(moves: bool) -> Any:
    """All that runs in a page: ours, the same for all pages of a kind."""
    from markupsafe import Markup

    names = ("copy.js", "motion.js") if moves else ("copy.js",)
    return Markup("\n".join(_environment().get_template(name).render() for name in names))


def _finalize(value: Any) -> Any:
    """What is put into the page: text of ours, or text that is shown as it is."""
    from markupsafe import Markup

    return printable(value, keep="\n") if isinstance(value, str) and not isinstance(value, Markup) else value


def _line(markup: str) -> Any:
    """A line of markup as HTML."""
    from markupsafe import Markup, escape

    parts = []
    for span in parse_line(markup):
        if span.kind == "plain":
            parts.append(escape(printable(span.text)))
        elif span.kind == "link":
            parts.append(Markup('<a href="{}">{}</a>').format(span.href, printable(span.text)))
        else:
            parts.append(Markup("<{0}>{1}</{0}>").format(_TAGS[span.kind], printable(span.text)))
    return Markup("").join(parts)


def _picture(figure: Figure, number: int) -> Any:
    """The picture itself: SVG as part of the page, PNG as a data URI."""
    from markupsafe import Markup

    if isinstance(figure.image, bytes):
        data = base64.b64encode(figure.image).decode("ascii")
        return Markup('<img src="data:image/png;base64,{}" alt="{}">').format(data, printable(figure.alt))
    drawing = _TAG.sub(lambda tag: _IDS.sub(rf"\g<1>f{number}-", tag[0]), figure.image[figure.image.index("<svg") :])
    label = Markup('<svg role="img" aria-label="{}"').format(printable(figure.alt))
    if figure.time_boxes:
        label += Markup(' data-times="{}"').format(json.dumps(figure.time_boxes, separators=(",", ":")))
    return label + Markup(drawing.removeprefix("<svg"))
