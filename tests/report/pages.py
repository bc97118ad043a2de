"""A page with every kind of block, and a drawing small enough to read; and pages of tracks without their figures."""

from ikde.report import track_page
from ikde.report.markup import code, verbatim
from ikde.report.page import (
    Animation,
    Cell,
    Code,
    Column,
    Facts,
    Figure,
    Gallery,
    Notice,
    Number,
    Numbers,
    Page,
    Section,
    Table,
    Text,
)

HOSTILE = "<script>alert('a|b')</script> & co_"
DRAWING = (
    '<svg viewBox="0 0 9 9"><defs><path id="m1" d="M 0 0"/><clipPath id="c1"/></defs>'
    '<use href="#m1" clip-path="url(#c1)"/></svg>'
)
MOVING = Animation(data='{"names":["<b>"]}', alt="a robot moving")
RATES = Table(
    columns=(
        Column("detector", align="left"),
        Column("SR", "%", group="print", mark="published"),
        Column("SR", "%", group="here", mark="ours"),
    ),
    rows=(("typical", "75.0", "73.2"), ("improved", "86.0", Cell("82.1", "off")), (HOSTILE, "", "-")),
    caption="Rates of **both** detectors",
    note="Intervals are `Wilson's`.",
)


def leave_out_figures(monkeypatch):
    """Pages of tracks without their figures, which take 2 s; `test_track_page.py` draws them."""
    monkeypatch.setattr(track_page, "_list_sections", lambda motion: [])


def make_page():
    svg, png = Figure(image=DRAWING, alt='a "curve"', caption="Drawn."), Figure(image=b"\x89PNG", alt="pose")
    return Page(
        title=HOSTILE,
        subtitle="two targets",
        lead=(Numbers((Number("73.2 %", "reached", "print: 75 %"), Number("0", "lost"))), Notice("**Not** finished.")),
        sections=(
            Section("Rates", (Text("See [poses](#poses).\n\n- one\n- two"), RATES, svg)),
            Section(
                "Poses", (Gallery((svg, png)), MOVING, Facts((("seed", "`2021`"),)), Code("a < b | c", "In a shell"))
            ),
        ),
        footer="ikde `0.1`",
    )


def make_page_of(text):
    """A page in which everything that somebody else may have written is this text."""
    svg, moving = Figure(image=DRAWING, alt=text, caption=verbatim(text)), Animation(data='{"names":["<b>"]}', alt=text)
    blocks = (
        Text(f"{verbatim(text)} **{verbatim(text)}** {code(text)}"),
        Notice(verbatim(text)),
        Numbers((Number(text, text, text),)),
        Facts(((text, verbatim(text)),)),
        Code(text, verbatim(text)),
        Table(columns=(Column(text, text, group=text),), rows=((text,), (Cell(text, "off"),)), caption=verbatim(text)),
        Gallery((svg, moving)),
    )
    return Page(title=text, subtitle=text, sections=(Section(text, blocks),), footer=verbatim(text))
