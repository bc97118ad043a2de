"""Where words go, in which colours and how wide."""

import fcntl
import io
import os
import pty
import struct
import subprocess
import sys
import termios
from contextlib import suppress
from shutil import get_terminal_size

import pytest

from ikde.cli.output import is_live, note_console, page_width, print_written, use_color, working
from ikde.cli.progress import show_benchmark, show_progress

VARIABLES = ("NO_COLOR", "FORCE_COLOR", "TERM", "COLUMNS")


class Terminal(io.StringIO):
    def isatty(self):
        return True


@pytest.fixture
def given(monkeypatch):
    """Set these variables of the environment, and none of the others."""

    def give(**values):
        for name in VARIABLES:
            monkeypatch.delenv(name, raising=False)
        for name, value in values.items():
            monkeypatch.setenv(name, value)

    return give


@pytest.mark.parametrize(
    ("variables", "in_terminal", "in_file"),
    [
        ({}, True, False),
        ({"TERM": "xterm"}, True, False),
        ({"TERM": "dumb"}, False, False),
        ({"NO_COLOR": "1"}, False, False),
        ({"NO_COLOR": ""}, True, False),
        ({"FORCE_COLOR": "1"}, True, True),
        ({"FORCE_COLOR": "1", "TERM": "dumb"}, True, True),
        ({"FORCE_COLOR": "0"}, False, False),
        ({"FORCE_COLOR": ""}, True, False),
        ({"FORCE_COLOR": "1", "NO_COLOR": "1"}, False, False),
    ],
)
def test_colours_follow_the_environment_before_the_terminal(given, variables, in_terminal, in_file):
    given(**variables)
    assert (use_color(Terminal()), use_color(io.StringIO())) == (in_terminal, in_file)


def test_nothing_moves_in_a_dumb_terminal_or_a_file_whatever_its_colours(given, monkeypatch):
    given(FORCE_COLOR="1", TERM="dumb")
    monkeypatch.setattr(sys, "stderr", Terminal())
    with working("searching"), show_benchmark(3) as bars, show_progress("a"):
        bars.begin("one")
    assert sys.stderr.getvalue() == "computing: one\n"
    given(FORCE_COLOR="1")
    assert (is_live(Terminal()), is_live(io.StringIO())) == (True, False)


@pytest.mark.parametrize(("variables", "coloured"), [({}, True), ({"NO_COLOR": "1"}, False)])
def test_what_moves_on_stderr_has_colours_only_where_they_are_wanted(given, monkeypatch, variables, coloured):
    given(**variables)
    monkeypatch.setattr(sys, "stderr", Terminal())
    note_console().print("[bold red]alarm[/]")
    assert ("\x1b[" in sys.stderr.getvalue()) is coloured


@pytest.mark.parametrize("command", [("check",), ("--help",), ("solve", "--help")])
@pytest.mark.parametrize(("variables", "coloured"), [({"FORCE_COLOR": "1"}, True), ({"NO_COLOR": "1"}, False)])
def test_a_command_has_colours_only_where_they_are_wanted(cli, given, monkeypatch, command, variables, coloured):
    given(COLUMNS="100", **variables)
    monkeypatch.setattr("typer.rich_utils.FORCE_TERMINAL", True)
    assert ("\x1b[" in cli(*command).out) is coloured


def test_help_fits_a_dumb_terminal():
    mine, terminal = pty.openpty()
    fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 66, 0, 0))
    env = {key: value for key, value in os.environ.items() if key not in VARIABLES}
    streams = {"stdin": terminal, "stdout": terminal, "stderr": terminal, "env": {**env, "TERM": "dumb"}}
    with subprocess.Popen([sys.executable, "-m", "ikde", "robots", "--help"], **streams) as process:
        os.close(terminal)
        text = b""
        with suppress(OSError):  # the other end is closed
            while part := os.read(mine, 65536):
                text += part
    os.close(mine)
    assert process.returncode == 0
    assert max(map(len, text.decode().splitlines())) == 66


@pytest.mark.parametrize(("columns", "width"), [("20", 60), ("80", 80), ("300", 160)])
def test_a_width_that_is_given_counts_outside_a_terminal(given, substitute, columns, width):
    given(COLUMNS=columns)
    substitute(get_terminal_size, lambda: os.terminal_size((int(columns), 24)))
    assert page_width(160) == width
    given()
    assert page_width(160) == 160


def test_files_are_named_on_stdout_or_beside_json_on_stderr(capsys, tmp_path):
    print_written(tmp_path / "a", tmp_path / "\x1b[31m")
    print_written(tmp_path / "b", as_json=True)
    captured = capsys.readouterr()
    assert captured.out == f"wrote {tmp_path}/a\nwrote {tmp_path}/\\x1b[31m\n"
    assert captured.err == f"wrote {tmp_path}/b\n"


@pytest.mark.parametrize("as_json", [False, True])
def test_a_figure_that_is_drawn_is_named(cli, tmp_path, as_json):
    file = tmp_path / "a.png"
    outcome = cli("check", "--detector", "none", "--plot", file, *(["--json"] if as_json else []))
    assert outcome.code == 0
    assert f"wrote {file}\n" in (outcome.err if as_json else outcome.out)
    assert not as_json or outcome.data["detector"] == "none"


SHOWN = [
    ("robots", "list"),
    ("robots", "show", "qiao2021"),
    ("robots", "show", "panda", "--pairs", "--unit", "m"),
    ("check",),
    ("check", "--robot", "ur5", "--unit", "mm"),
    ("fk",),
    ("fk", "--robot", "ur5", "--unit", "mm"),
    ("solve", "--position", "0.8", "0.5", "1"),
    ("doctor",),
    ("--help",),
    ("solve", "--help"),
    ("track", "--help"),
    ("robots", "import", "--help"),
]


@pytest.mark.parametrize("command", SHOWN, ids=" ".join)
def test_what_is_shown_fits_sixty_columns(cli, given, command):
    given(COLUMNS="60")
    text = cli(*command).out
    assert max(map(len, text.splitlines())) <= 60
    assert "…" not in text
