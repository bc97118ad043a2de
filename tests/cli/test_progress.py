"""How far a batch is: a bar for a terminal, lines for a log."""

import re

import pytest

from ikde.batch.run import Progress
from ikde.cli.output import working
from ikde.cli.progress import Pace, show_progress


def at(solves, found=0):
    return Progress(parts_done=solves // 10, parts=10, solves_done=solves, solves=100, parts_found=found)


@pytest.fixture
def clock(monkeypatch):
    """A clock that is set by hand."""
    time = [1000.0]
    monkeypatch.setattr("time.monotonic", lambda: time[0])
    return time


def test_a_log_gets_a_first_line_and_one_a_minute(capsys, clock):
    with show_progress("a → b") as tell:
        tell(at(20, found=2))
        for solves in range(30, 100, 10):
            clock[0] += 25.0
            tell(at(solves))
    assert capsys.readouterr().err.splitlines() == [
        "a → b: 100 solves, 2 of 10 parts done before",
        "a → b: 50 of 100 solves, 0.4 solves/s",
        "a → b: 80 of 100 solves, 0.4 solves/s",
    ]


def test_a_title_is_one_line_of_letters_in_a_log(capsys, clock):
    with show_progress("\x1b[31m\nb") as tell:
        tell(at(20))
    assert capsys.readouterr().err == "\\x1b[31m\\nb: 100 solves, 0 of 10 parts done before\n"


def test_a_terminal_gets_a_bar(capsys, monkeypatch):
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    monkeypatch.setenv("COLUMNS", "150")
    with show_progress("a → b") as tell:
        tell(at(20, found=2))
        tell(at(50))
    printed = re.sub(r"\x1b\[[0-9;?]*\w", "", capsys.readouterr().err)
    assert "a → b" in printed
    assert "50/100 solves, 5 of 10 parts" in printed


def test_a_title_is_shown_as_it_is_on_a_terminal(capsys, monkeypatch):
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    monkeypatch.setenv("COLUMNS", "150")
    title = "[red]a[/] \x1b]0;b\x07"
    with show_progress(title) as tell:
        tell(at(20))
    with working(title):
        pass
    printed = capsys.readouterr().err
    assert printed.count(r"[red]a[/] \x1b]0;b\x07") >= 2
    assert "\x1b]0" not in printed


def test_pace_counts_from_where_it_began(clock):
    pace = Pace()
    assert pace.format(at(40)) == ""
    clock[0] += 4.0
    assert pace.format(at(60)) == "5 solves/s"
    clock[0] -= 3.999
    assert pace.format(at(60)) == "20,000 solves/s"
