"""A page as one HTML file that needs nothing else."""

import base64
import hashlib
import re
from collections import Counter
from html.parser import HTMLParser

import pytest

from ikde.errors import printable
from ikde.report.html import render_html
from ikde.report.page import Column, Figure, Gallery, Page, Section, Table, Text, slug
from tests.hostile_names import EVERYTHING
from tests.report.pages import DRAWING, make_page, make_page_of

VOID = {"meta", "img", "br", "path", "use", "input"}


class Reader(HTMLParser):
    """Keeps what a page refers to and names, and whether its tags are closed in order."""

    def __init__(self, text):
        super().__init__()
        self.ids, self.references, self.seen, self.open, self.attributes = [], [], Counter(), [], Counter()
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.seen[tag] += 1
        self.open += [] if tag in VOID else [tag]
        self.attributes.update(name for name, _ in attrs)
        for name, value in attrs:
            if name == "id":
                self.ids.append(value)
            if name in ("href", "src"):
                self.references.append(value)

    def handle_startendtag(self, tag, attrs):
        self.handle_starttag(tag, attrs)
        self.open = self.open[:-1] if tag not in VOID else self.open

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


@pytest.fixture(scope="module")
def text():
    return render_html(make_page())


@pytest.fixture(scope="module")
def reader(text):
    return Reader(text)


def test_every_kind_of_block_is_there(text, reader):
    assert reader.open == []
    for kind in ("numbers", "notice", "facts", "code", "table", "picture", "picture photo", "gallery", "animation"):
        assert f'class="{kind}"' in text
    assert reader.seen["li"] == 2 + 2  # of the contents and of the list
    assert "<p>ikde <code>0.1</code></p>" in text


def test_what_others_wrote_is_no_html(text, reader):
    assert "<script>alert" not in text
    assert reader.seen["script"] == 1  # the copy button and the player
    assert '<td class="left long">&lt;script&gt;alert(&#39;a|b&#39;)&lt;/script&gt; &amp; co_</td>' in text
    assert "<code>a &lt; b | c</code>" in text
    assert 'aria-label="a &#34;curve&#34;"' in text


def test_nothing_is_fetched(text, reader):
    assert all(re.match(r"#|data:image/png;base64,", reference) for reference in reader.references)
    assert re.findall(r"@import|@font-face|url\((?!#)", text) == []
    assert "default-src 'none'" in text


def test_names_are_there_once_and_references_lead_somewhere(text, reader):
    assert [name for name, count in Counter(reader.ids).items() if count > 1] == []
    pointed = [reference[1:] for reference in reader.references if reference.startswith("#")]
    assert set(pointed) | set(re.findall(r"url\(#([^)]+)\)", text)) == set(reader.ids)


def test_marks_units_and_groups_reach_the_table(text):
    assert '<td class="right published">75.0</td>' in text
    assert '<td class="right ours">73.2</td>' in text
    assert '<td class="right off">82.1</td>' in text
    assert 'data-head="here: SR [%]"' in text
    assert '<th scope="colgroup" colspan="1">print</th>' in text
    assert "Rates of <strong>both</strong> detectors" in text


def test_a_gallery_may_be_narrow():
    svg = Figure(image=DRAWING, alt="a curve")
    text = render_html(Page(title="t", sections=(Section("s", (Gallery((svg,) * 3, narrow=True),)),)))
    assert '<div class="gallery narrow">' in text


def test_an_empty_table_says_so():
    table = Table(columns=(Column("a"), Column("b")), rows=(), caption="Unreached")
    text = render_html(Page(title="t", sections=(Section("s", (table,)),)))
    assert '<td class="left none" colspan="2">none</td>' in text


def test_a_page_without_lead_and_footer_has_none():
    text = render_html(Page(title="t", sections=(Section("s", (Text("words"),)),)))
    assert "<footer>" not in text
    assert 'class="subtitle"' not in text


def test_the_same_page_gives_the_same_text(text):
    assert render_html(make_page()) == text


@pytest.mark.parametrize("name", EVERYTHING)
def test_a_name_is_text_wherever_it_stands(name):
    text, ours = render_html(make_page_of(name)), Reader(render_html(make_page_of("a name")))
    reader = Reader(text)
    assert reader.open == []
    assert reader.seen | {"code": 0} == ours.seen | {"code": 0}  # a backtick cannot stand in code
    assert reader.attributes == ours.attributes
    assert set(reader.references) - set(ours.references) <= {f"#{slug(name)}"}
    assert printable(re.sub(r"\s+", " ", text)).isprintable()
    assert not re.search(r"[\x00-\x09\x0b-\x1f\x7f-\x9f\u2028\u202e]", text)
    text.encode()


def test_halves_of_letters_are_written_out():
    assert "\\ud800" in render_html(make_page_of("\ud800")).encode().decode()


def test_only_the_script_of_the_page_may_run(text, reader):
    script = re.search(r"<script>(.*?)</script>", text, re.DOTALL)[1]
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    assert f"script-src 'sha256-{digest}';" in text
    assert "script-src 'unsafe-inline'" not in text
    assert "motion" in script
    assert not [name for name in reader.attributes if name.startswith("on")]
