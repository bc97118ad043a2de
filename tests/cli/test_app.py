"""The command as a whole: help, version, exit codes, and a process that starts light and ends quietly."""

import os
import signal
import subprocess
import sys
import warnings

import pytest
import typer

from ikde import __version__
from ikde.cli.app import UsageError, app, explain_error
from ikde.cli.exit_codes import ExitCode
from ikde.cli.startup import warn_in_one_line
from ikde.errors import CacheWarning, FileError, InputError, VerificationError
from tests.cli.conftest import Outcome

HELP_IS_LIGHT = """
import sys
from ikde.cli.app import run
heavy = {"numpy", "numba", "scipy", "matplotlib", "yaml", "ikde.io", "ikde.model", "ikde.kernels"}
for command in map(str.split, sys.argv[1:]):
    code = run([*command, "--help"])
    loaded = sorted(heavy & set(sys.modules))
    if code or loaded:
        sys.exit(f"{command}: exit code {code}, loaded {loaded}")
"""
SOLVE_ANNOUNCED = """
import signal, sys
import ikde.solver.engines.de as module
from ikde.__main__ import main
signal.signal(signal.SIGINT, signal.default_int_handler)  # a background job may have inherited "ignore"
search = module.solve_lanes

def announced(*arguments):
    print("started", flush=True)
    return search(*arguments)

module.solve_lanes = announced
main()
"""
ENDLESS = ["solve", "--position", "0.8", "0.5", "1", "--method", "de", "--tolerance", "1e-300", "--restarts", "100000"]


def find_commands(group, path=()):
    """Name after name of every command in a group, and of those in groups of its own."""
    for name, command in group.commands.items():
        yield (*path, name)
        yield from find_commands(command, (*path, name)) if hasattr(command, "commands") else ()


COMMANDS = list(find_commands(typer.main.get_command(app)))


def start(*arguments):
    return subprocess.Popen(
        [sys.executable, "-W", "error", *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def finish(process):
    out, err = process.communicate(timeout=120)
    return process.returncode, out, err


def test_the_version_is_printed(cli):
    assert cli("--version") == Outcome(0, f"ikde {__version__}\n", "")


def test_help_lists_every_command(cli):
    outcome = cli("--help")
    assert outcome.code == 0
    assert outcome.err == ""
    for name, *_ in COMMANDS:
        assert f" {name} " in outcome.out


@pytest.mark.parametrize("command", COMMANDS, ids=" ".join)
def test_every_command_has_help(cli, command):
    outcome = cli(*command, "-h")
    assert (outcome.code, outcome.err) == (0, "")
    assert f"ikde {' '.join(command)}" in outcome.out


@pytest.mark.parametrize("command", ["slove", "solv", "robot", "--versoin", "-x"])
def test_an_unknown_command_or_option_is_refused(refuse, command):
    assert command in refuse(command)


def test_a_misspelt_command_is_told_its_neighbour(refuse):
    assert "Did you mean 'solve'" in refuse("slove")


@pytest.mark.parametrize(
    ("error", "code", "line"),
    [
        (InputError("wrong", ("q", 3)), ExitCode.BAD_INPUT, "ikde: q[3]: wrong"),
        (FileError("a.yaml", "wrong", ("b",), 7), ExitCode.BAD_INPUT, "ikde: a.yaml:7 → b: wrong"),
        (UsageError("two\n  lines"), ExitCode.BAD_INPUT, "ikde: two lines"),
        (MemoryError(), ExitCode.BAD_INPUT, "ikde: not enough memory"),
        (KeyboardInterrupt(), ExitCode.INTERRUPTED, "ikde: interrupted"),
        (typer.Abort(), ExitCode.INTERRUPTED, "ikde: interrupted"),
    ],
)
def test_an_error_has_one_code_and_one_line(capsys, error, code, line):
    assert explain_error(error) == (code, line)
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("error", [VerificationError("they disagree"), ZeroDivisionError("by zero")])
def test_a_bug_is_told_from_bad_input_and_shows_its_traceback(capsys, error):
    code, line = explain_error(error)
    assert code == ExitCode.BUG == 3
    assert "bug" in line
    assert str(error) in line
    assert type(error).__name__ in capsys.readouterr().err


def test_a_bug_inside_a_command_exits_with_3(cli, monkeypatch):
    def broken(name):
        raise ZeroDivisionError("by zero")

    monkeypatch.setattr("ikde.io.robots.load_robot", broken)
    outcome = cli("fk")
    assert (outcome.code, outcome.out) == (3, "")
    assert outcome.err.splitlines()[-1] == "ikde: this is a bug, please report it: ZeroDivisionError: by zero"


def test_a_file_that_ends_too_early_is_a_bug_and_no_ctrl_c(cli, monkeypatch):
    def cut(name):
        raise EOFError("Ran out of input")

    monkeypatch.setattr("ikde.io.robots.load_robot", cut)
    outcome = cli("fk")
    assert (outcome.code, outcome.out) == (3, "")
    assert outcome.err.splitlines()[-1] == "ikde: this is a bug, please report it: EOFError: Ran out of input"


def test_what_is_wrong_with_the_cache_is_one_line(tmp_path):
    cache = tmp_path / "cache"
    cache.mkdir()
    cache.chmod(0o777)
    told = {**os.environ, "IKDE_CACHE_DIR": str(cache), "TMPDIR": str(tmp_path)}
    command = [sys.executable, "-m", "ikde", "robots", "show", "ur5", "--kernels", "--detector", "none"]
    done = subprocess.run(command, env=told, capture_output=True, text=True, timeout=120, check=True)
    (line,) = done.stderr.splitlines()
    assert line.startswith(f"ikde: the cache folder {cache} is not used: {cache} can be written by others (mode 777); ")


@pytest.mark.parametrize("encoding", ["ascii", "cp1252"])
def test_a_table_is_written_in_any_encoding(encoding):
    told = {**os.environ, "PYTHONIOENCODING": encoding}
    done = subprocess.run([sys.executable, "-m", "ikde", "robots", "list"], check=False, env=told, capture_output=True)
    assert (done.returncode, done.stderr) == (0, b"")
    assert b"qiao2021" in done.stdout


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no such device")  # noqa: PTH110
def test_a_full_disk_is_one_line_and_a_closed_stdout_is_none():
    command = f"{sys.executable} -m ikde schema robot"
    full = subprocess.run(f"{command} >/dev/full", shell=True, check=False, capture_output=True, text=True)
    assert (full.returncode, full.stderr) == (2, "ikde: stdout cannot be written: no space is left on the device\n")
    closed = subprocess.run(f"{command} >&-", shell=True, check=False, capture_output=True, text=True)
    assert (closed.returncode, closed.stderr) == (0, "")


def test_other_warnings_stay_as_they_are(monkeypatch, capsys):
    shown = []
    monkeypatch.setattr(warnings, "showwarning", lambda message, *_: shown.append(str(message)))
    warn_in_one_line()
    with warnings.catch_warnings():
        warnings.simplefilter("always")
        warnings.warn("of the cache", CacheWarning, stacklevel=1)
        warnings.warn("of others", RuntimeWarning, stacklevel=1)
    assert (shown, capsys.readouterr().err) == (["of others"], "ikde: of the cache\n")


def test_an_interrupted_command_exits_with_130(cli, monkeypatch):
    def interrupted(name):
        raise KeyboardInterrupt

    monkeypatch.setattr("ikde.io.robots.load_robot", interrupted)
    assert cli("fk") == Outcome(130, "", "ikde: interrupted\n")


def test_help_loads_nothing_heavy():
    commands = [" ".join(command) for command in [(), *COMMANDS]]
    code, out, err = finish(start("-c", HELP_IS_LIGHT, *commands))
    assert (code, err) == (0, "")
    assert out.count("Usage: ikde") == len(commands)


def test_the_module_runs_as_the_command():
    assert finish(start("-m", "ikde", "--version")) == (0, f"ikde {__version__}\n", "")


def test_a_refusal_of_the_process_is_one_line():
    code, out, err = finish(start("-m", "ikde", "fk", "--robot", "qiao"))
    assert (code, out) == (2, "")
    assert len(err.splitlines()) == 1


def test_ctrl_c_during_a_search_exits_with_130_and_one_line():
    process = start("-c", SOLVE_ANNOUNCED, *ENDLESS)
    assert process.stdout.readline() == "started\n"
    assert process.stdout.readline() == "started\n"  # the first call only loads the kernel
    process.send_signal(signal.SIGINT)
    code, _, err = finish(process)
    assert (code, err) == (130, "ikde: interrupted\n")


@pytest.mark.parametrize("command", ["fk --json", "check", "robots show qiao2021", "--help", "solve --help"])
def test_a_reader_that_leaves_early_is_no_error(command):
    with start("-m", "ikde", *command.split()) as process:
        process.stdout.close()
        process.wait(timeout=120)
        assert (process.returncode, process.stderr.read()) == (0, "")
