"""A page as Markdown."""

import re

import pytest

from ikde.report.markdown import render_markdown
from ikde.report.markup import verbatim
from ikde.report.page import Code, Column, Facts, Page, Section, Table, Text
from tests.hostile_names import EVERYTHING
from tests.report.pages import make_page, make_page_of

OPENINGS = ("# ", "- ", "> ", "##", "| ", "==", "--", "1.")


@pytest.fixture(scope="module")
def text():
    return render_markdown(make_page())


def test_every_kind_of_block_is_there(text):
    for line in (
        "- **73.2 %** reached (print: 75 %)",
        "- **0** lost",
        "> **Not** finished.",
        "## Rates",
        "See [poses](#poses).",
        "- one\n- two",
        "Rates of **both** detectors",
        "Intervals are `Wilson's`.",
        '_Figure in the HTML page: a "curve"_ Drawn.',
        "_Figure in the HTML page: pose_",
        "- seed: `2021`",
        "In a shell\n\n```\na < b | c\n```",
        "ikde `0.1`",
    ):
        assert line in text


def test_a_table_has_the_same_number_of_cells_in_every_line(text):
    lines = [line for line in text.splitlines() if line.startswith("|")]
    assert len(lines) == 2 + 3
    assert {len(re.findall(r"(?<!\\)\|", line)) for line in lines} == {4}
    assert lines[:4] == [
        "| detector | print: SR [%] | here: SR [%] |",
        "| :-- | --: | --: |",
        "| typical | _75.0_ | **73.2** |",
        "| improved | _86.0_ | ≠ **82.1** |",
    ]


def test_what_others_wrote_is_shown_as_it_is(text):
    assert text.startswith("# &lt;script>alert('a\\|b')&lt;/script> & co\\_\n")
    assert "| &lt;script>alert('a\\|b')&lt;/script> & co\\_ |  | **-** |" in text


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("a*b*", r"a\*b\*"),
        ("`a`", r"\`a\`"),
        ("[a](b)", r"[a\](b)"),
        ("_a_ snake_case", r"\_a\_ snake_case"),
        ("a\\|b", r"a\\\|b"),
        ("&amp; & <b>", "&amp;amp; & &lt;b>"),
        ("two\nlines", "two lines"),
    ],
)
def test_marks_of_markdown_are_text(text, shown):
    table = Table(columns=(Column("a"), Column("b")), rows=((text, "1"),), caption="c")
    blocks = (table, Facts((("name", verbatim(text)),)))
    lines = render_markdown(Page(title="t", sections=(Section("s", blocks),))).splitlines()
    assert f"| {shown} | 1 |" in lines
    assert f"- name: {shown}" in lines


def test_an_empty_table_says_so():
    table = Table(columns=(Column("a"),), rows=(), caption="Unreached")
    assert "Unreached\n\n| a |\n| --: |\n\nnone" in render_markdown(Page(title="t", sections=(Section("s", (table,)),)))


def test_a_page_ends_with_one_newline_and_is_the_same_every_time(text):
    assert text.endswith("\n")
    assert "\n\n\n" not in text
    assert render_markdown(make_page()) == text


@pytest.mark.parametrize("name", EVERYTHING)
def test_a_name_changes_no_line_around_it(name):
    text, ours = render_markdown(make_page_of(name)), render_markdown(make_page_of("a name"))
    outside, theirs = (re.sub(r"(?s)```.*?```", "```", page).splitlines() for page in (text, ours))
    assert [line[:2] for line in outside if line[:2] in OPENINGS] == [
        line[:2] for line in theirs if line[:2] in OPENINGS
    ]
    assert len(outside) == len(theirs)
    assert "<s" not in re.sub(r"```.*?```|`[^`]*`", "", text, flags=re.DOTALL)
    assert all(line.isprintable() for line in text.splitlines())


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("# a", r"\# a"),
        ("- a", r"\- a"),
        ("1. a", r"1\. a"),
        ("> a", r"\> a"),
        ("===", r"\==="),
        ("$x$", r"\$x\$"),
        ("http://a", r"http\://a"),
    ],
)
def test_the_beginning_of_a_paragraph_is_text(text, shown):
    page = Page(title="t", sections=(Section("s", (Text(verbatim(text)),)),))
    assert shown in render_markdown(page).splitlines()


def test_code_cannot_end_before_its_end():
    page = Page(title="t", sections=(Section("s", (Code("a\n```\n# b\n````\nc"),)),))
    assert "\n`````\na\n```\n# b\n````\nc\n`````\n" in render_markdown(page)
