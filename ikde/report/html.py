"""A page as one HTML file that needs nothing else: no network, no fonts, no script but a copy button."""

import base64
import re
from functools import cache
from itertools import count
from typing import Any

from ikde.report.markup import parse_line, parse_text
from ikde.report.page import Figure, Page

_TAGS = {"code": "code", "bold": "strong"}
_IDS = re.compile(r'(\bid="|href="#|url\(#)')


def render_html(page: Page) -> str:
    """The whole file as text; the same page gives the same text."""
    numbers = count(1)
    return _template().render(
        page=page,
        sections=list(zip(page.anchors(), page.sections, strict=True)),
        picture=lambda figure: _picture(figure, next(numbers)),
        kind=lambda block: type(block).__name__,
    )


@cache
def _template() -> Any:
    from jinja2 import Environment, PackageLoader, StrictUndefined

    loader = PackageLoader("ikde.report", "templates")
    environment = Environment(
        loader=loader, autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    environment.filters.update(line=_line, paragraphs=parse_text)
    return environment.get_template("page.html")


def _line(markup: str) -> Any:
    """A line of markup as HTML."""
    from markupsafe import Markup, escape

    parts = []
    for span in parse_line(markup):
        if span.kind == "plain":
            parts.append(escape(span.text))
        elif span.kind == "link":
            parts.append(Markup('<a href="{}">{}</a>').format(span.href, span.text))
        else:
            parts.append(Markup("<{0}>{1}</{0}>").format(_TAGS[span.kind], span.text))
    return Markup("").join(parts)


def _picture(figure: Figure, number: int) -> Any:
    """The picture itself: SVG as part of the page, PNG as a data URI."""
    from markupsafe import Markup

    if isinstance(figure.image, bytes):
        data = base64.b64encode(figure.image).decode("ascii")
        return Markup('<img src="data:image/png;base64,{}" alt="{}">').format(data, figure.alt)
    drawing = _IDS.sub(rf"\g<1>f{number}-", figure.image[figure.image.index("<svg") :])
    label = Markup('<svg role="img" aria-label="{}"').format(figure.alt)
    return label + Markup(drawing.removeprefix("<svg"))
