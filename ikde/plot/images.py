"""Figures as pictures: SVG that takes the colours and the type of the page around it, or PNG."""

import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO
from typing import Any

from ikde.errors import printable

INK = "#010203"  # drawn with this, shown in the page's own text colour
_SETTINGS: dict[Any, Any] = {"svg.fonttype": "none", "svg.hashsalt": "ikde"}
_HEAD = re.compile(r"<svg .*?>.*?<style type=\"text/css\">\*\{(?P<style>.*?)\}</style>\s*</defs>", re.DOTALL)
_SIZE = re.compile(r'width="(.*?)pt" height="(.*?)pt"')
_FONT = re.compile(r"(font-family: |font: [^;\"']*)'[^;\"]*")
_ID = re.compile(r' id="([^"]*)"')
_PATH = re.compile(r' d="([^"]*)"')
_DIGITS = re.compile(r"(\.\d\d)\d+")  # hundredths of a point are more than a screen shows
_REFERENCE = re.compile(r'(?:href="#|url\(#)([^")]+)')
_TAG = re.compile(r"<[^>]*>")


def show_as_text(figure: Any) -> Any:
    """The figure, with every text in it as it is: names may hold what would be a formula, and worse."""
    from matplotlib.text import Text

    for text in figure.findobj(Text):
        text.set_parse_math(False)
        text.set_usetex(False)
        text.set_text(printable(text.get_text()))
    return figure


@contextmanager
def any_letters() -> Iterator[None]:
    """Draw letters that the type does not have as boxes, without a word: SVG asks the reader's own type for them."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", r"(Glyph|Matplotlib currently does not support)")
        yield


def to_svg(figure: Any) -> str:
    """A figure as SVG: text is text, no background, `INK` becomes `currentColor`; the same figure, the same text."""
    import matplotlib

    buffer = BytesIO()
    with any_letters(), matplotlib.rc_context(_SETTINGS):
        figure.savefig(buffer, format="svg", transparent=True, metadata={"Date": None})
    svg = buffer.getvalue().decode("utf-8")
    svg = _HEAD.sub(_short_head, svg[svg.index("<svg ") :], count=1)
    used = {name for tag in _TAG.findall(svg) for name in _REFERENCE.findall(tag.replace("xlink:href", "href"))}
    return _TAG.sub(lambda tag: _clean(tag[0], used), svg)


def find_boxes(figure: Any) -> tuple[tuple[float, float, float, float, float, float], ...]:
    """The charts of a figure that has been drawn: left, right, top, bottom in units of its SVG, and the ends of x."""
    width, height = 72.0 * figure.get_size_inches()
    boxes = []
    for axes in figure.axes:
        place, (first, last) = axes.get_position(), axes.get_xlim()
        edges = place.x0 * width, place.x1 * width, (1.0 - place.y1) * height, (1.0 - place.y0) * height
        boxes.append((*(round(float(edge), 2) for edge in edges), float(f"{first:.6g}"), float(f"{last:.6g}")))
    return tuple(boxes)


def to_png(figure: Any, *, dpi: float = 160) -> bytes:
    """A figure as PNG on white."""
    buffer = BytesIO()
    with any_letters():
        figure.savefig(buffer, format="png", dpi=dpi, facecolor="white", metadata={"Software": None})
    return buffer.getvalue()


def _short_head(match: re.Match[str]) -> str:
    """The opening tag without metadata; matplotlib's style for every element would reach the whole page."""
    size = _SIZE.search(match[0])
    box = f"0 0 {size[1]} {size[2]}" if size else ""
    return f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{box}" style="{match["style"]}">'


def _clean(tag: str, used: set[str]) -> str:
    """A tag in the page's colours and type, in few digits; text between tags stays as it is.

    Matplotlib names every group, the same in all figures; only what is referred to needs its name.
    """
    tag = tag.replace("xlink:href", "href").replace(INK, "currentColor")
    tag = _PATH.sub(lambda match: _DIGITS.sub(r"\1", match[0]), tag)
    return _ID.sub(lambda match: match[0] if match[1] in used else "", _FONT.sub(r"\1inherit", tag))
