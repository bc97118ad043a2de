"""The little markup of a page's text."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ikde.report.markup import Paragraph, Span, as_line, code, parse_line, parse_text, verbatim


def shown(markup):
    return "".join(span.text for span in parse_line(markup))


def test_a_line_falls_into_plain_code_bold_and_links():
    assert parse_line("a `b*` **c** [d](#e).") == [
        Span("a "),
        Span("b*", "code"),
        Span(" "),
        Span("c", "bold"),
        Span(" "),
        Span("d", "link", "#e"),
        Span("."),
    ]


def test_a_mark_without_its_partner_is_text():
    for text in ("2 * 3", "a ` b", "[mm]", "a ** b", "x [y] (z)"):
        assert parse_line(text) == [Span(text)]


@given(st.text())
def test_verbatim_text_is_shown_as_it_is(text):
    assert shown(verbatim(text)) == as_line(text)
    assert {span.kind for span in parse_line(verbatim(text))} <= {"plain"}


@given(st.text(alphabet="ab*`[]\\", min_size=1))
def test_verbatim_text_is_shown_as_it_is_inside_bold(text):
    assert parse_line(f"**{verbatim(text)}**") == [Span(text, "bold")]


@pytest.mark.parametrize("text", ["runs/[a]", "a*b", r"C:\runs"])
def test_code_needs_no_backslash(text):
    assert parse_line(code(text)) == [Span(text, "code")]


@given(st.text())
def test_code_shows_any_text_as_it_is(text):
    assert shown(code(text)) == as_line(text)


def test_a_mark_at_its_face_value_is_part_of_the_text_around_it():
    assert parse_line(r"a \[b\](c) `d`") == [Span("a [b](c) "), Span("d", "code")]


def test_paragraphs_end_at_empty_lines_and_dashes_make_lists():
    text = "one\nline\n\n  \n- first\n- second\n  goes on\n\nlast - not a list"
    assert parse_text(text) == [
        Paragraph(("one line",)),
        Paragraph(("first", "second goes on"), is_list=True),
        Paragraph(("last - not a list",)),
    ]
    assert parse_text(" \n ") == []


@pytest.mark.parametrize("text", ["[a](javascript:alert)", "[a](http://x.example)", "[a](b)"])
def test_a_link_leads_into_its_page_and_nowhere_else(text):
    assert parse_line(text) == [Span(text)]
