"""Rich renderables as plain text."""

import re

import pytest

from ikde.errors import printable
from ikde.report.render import make_table, plain, render
from tests.hostile_names import EVERYTHING

ESCAPE = "\x1b"
RED = re.compile(r"\x1b\[[\d;]*m")


def test_plain_text_has_no_colour():
    text = render("[bold red]alarm[/]: all is well")
    assert text == "alarm: all is well"


def test_colour_comes_only_if_asked_for():
    assert ESCAPE in render("[bold red]alarm[/]", color=True)


def test_columns_are_aligned_as_their_names_say():
    table = make_table("name", ">value")
    table.add_row("a", "1")
    table.add_row("longer", "1000")
    lines = render(table).strip("\n").splitlines()
    assert lines[0].split() == ["name", "value"]
    assert lines[-2].endswith("    1")
    assert lines[-1].endswith(" 1000")


@pytest.mark.parametrize("name", ["clearance [mm]", ">x [m]", "[deg]"])
def test_a_unit_in_brackets_is_no_markup(name):
    assert name.removeprefix(">") in render(make_table(name, "other"))


def test_no_line_ends_in_blanks_and_no_two_lines_are_empty():
    text = render("a", "", "", make_table("b", title="c"), "d")
    assert all(line == line.rstrip() for line in text.splitlines())
    assert "\n\n\n" not in text


def test_long_lines_are_folded_at_the_width():
    assert max(map(len, render("word " * 100, width=40).splitlines())) <= 40


@pytest.mark.parametrize("width", [24, 30, 40])
def test_a_table_that_is_too_wide_moves_together_and_folds_its_texts_alone(width):
    table = make_table("name", ">value of it", "?", "why")
    for number in ("-1234.567", "0.5"):
        table.add_row("joint", number, "#" * 20, "a reason in several words")
    text = render(table, width=width)
    assert max(map(len, text.splitlines())) <= width
    assert "-1234.567" in text
    assert "#" not in text


def test_a_table_that_fits_once_it_moves_together_folds_nothing():
    table = make_table("name", ">a", ">b", ">c")
    table.add_row("two words", *["12345678"] * 3)
    assert len(render(table, width=41).splitlines()) == 3
    assert len(render(table, width=38).splitlines()) == 4


def test_what_is_too_wide_by_little_is_narrowed_by_little():
    table = make_table("name", ">a long head", ">value")
    table.add_row("a", "1,999 / 2,000", "100.0 % (99.7 to 100.0)")
    rows = render(table, width=40).splitlines()
    assert len(rows) == 4
    assert "1,999 / 2,000   100.0 % (99.7 to" in rows[2]
    assert max(map(len, rows)) <= 40


def test_a_column_to_spare_stays_where_there_is_room():
    table = make_table("name", "?", ">value")
    table.add_row("a", "#" * 20, "1")
    assert "#" * 20 in render(table, width=60)
    assert "   " in render(table, width=60).splitlines()[0]  # and the gaps are wide


@pytest.mark.parametrize("name", EVERYTHING)
@pytest.mark.parametrize("color", [False, True])
def test_a_name_is_shown_as_it_is_whatever_stands_around_it(name, color):
    shown = printable(name)
    text = render(f"[bold]{plain(name)}[/]: {plain(name)} [red]x[/]", color=color, width=300)
    assert RED.sub("", text) == f"{shown}: {shown} x"


@pytest.mark.parametrize("name", EVERYTHING)
def test_a_name_is_shown_as_it_is_in_a_table(name):
    shown = printable(name)
    table = make_table(name, ">of it", title=name)
    table.add_row(plain(name), "1")
    lines = render(table, width=300).splitlines()
    assert [line.strip().startswith(shown) for line in lines if shown in line] == [True] * 3  # title, head and row
    assert all(line.isprintable() for line in lines)


def test_two_names_make_no_markup_together():
    assert render(f"{plain('a[red')} and {plain('b]')}") == "a[red and b]"
