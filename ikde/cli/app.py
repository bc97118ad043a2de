"""The `ikde` command: its subcommands, and the one place where errors become exit codes."""

import errno
import os
import sys
import traceback
from typing import Annotated, Any, NoReturn

import typer

from ikde import __version__
from ikde.cli.analyze import analyze
from ikde.cli.batch import batch
from ikde.cli.bench import bench
from ikde.cli.check import check
from ikde.cli.completion import completion, prepare_completion
from ikde.cli.doctor import doctor
from ikde.cli.exit_codes import ExitCode
from ikde.cli.fk import fk
from ikde.cli.options import Command, Group
from ikde.cli.output import print_note, print_result
from ikde.cli.report import report
from ikde.cli.robots import robots
from ikde.cli.schema import schema
from ikde.cli.solve import solve
from ikde.cli.startup import (
    leave_garbage_at_exit,
    prepare_streams,
    skip_garbage_collection,
    use_one_blas_thread,
    warn_in_one_line,
)
from ikde.cli.track import track
from ikde.cli.typed_forms import regroup
from ikde.cli.warmup import warmup
from ikde.cli.worlds import worlds
from ikde.errors import InputError, printable

# Click's UsageError, wherever typer keeps it: newer ones carry a copy of click of their own.
UsageError: type[Exception] = typer.BadParameter.__bases__[0]
INTERRUPTED = "ikde: interrupted"

app = typer.Typer(
    name="ikde",
    cls=Group,
    add_completion=False,
    pretty_exceptions_enable=False,
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _version(wanted: bool) -> None:
    if wanted:
        print_result(f"ikde {__version__}")
        raise typer.Exit


@app.callback()
def root(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Inverse kinematics for arms and mobile manipulators, clear of themselves and of obstacles, on a CPU.

    Robots: those of `ikde robots list`, a URDF or a file of your own.

    Exit codes: 0 all reached, 1 some not reached or a collision found, 2 bad usage or file, 3 a bug, 130 interrupted.
    """


for command in (solve, fk, check, analyze, batch, report, track, schema, warmup, doctor, completion):
    app.command(cls=Command)(command)
app.add_typer(robots, name="robots")
app.add_typer(worlds, name="worlds")
app.add_typer(bench, name="bench")


def run_and_exit() -> NoReturn:
    """Run the command line and exit."""
    skip_garbage_collection()
    use_one_blas_thread()
    prepare_streams()
    warn_in_one_line()
    code = run(sys.argv[1:])
    leave_garbage_at_exit()
    sys.exit(code)


def run(arguments: list[str]) -> int:
    """Run one command; returns its exit code and turns every error into one line on stderr."""
    prepare_completion()
    try:
        code = int(app(regroup(arguments), prog_name="ikde", standalone_mode=False) or ExitCode.OK)
    except BaseException as error:
        if _reader_has_gone(error):  # `ikde check | head` has seen enough
            _pass_over_stdout()
            return ExitCode.OK
        if isinstance(error, OSError) and error.errno == errno.ENOSPC:  # files say their name
            _pass_over_stdout()
            print_note("ikde: stdout cannot be written: no space is left on the device")
            return ExitCode.BAD_INPUT
        if isinstance(error, SystemExit):  # a shell has its answer
            return int(error.code or ExitCode.OK)
        code, line = explain_error(error)
        for each in filter(None, (line, *getattr(error, "__notes__", ()))):
            print_note(each if each == line else f"ikde: {each}")
        return code
    if code == ExitCode.INTERRUPTED:  # typer has turned Ctrl-C into this code already
        print_note(INTERRUPTED)
    return code


def _pass_over_stdout() -> None:
    """What is written but not gone yet would be an error once more when Python ends."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _reader_has_gone(error: BaseException | None) -> bool:
    """True for a closed pipe, also behind the exit that typer makes of it."""
    if isinstance(error, SystemExit):
        return _reader_has_gone(error.__context__)
    return isinstance(error, BrokenPipeError)


def explain_error(error: BaseException) -> tuple[ExitCode, str]:
    """The exit code and the one line for an error; of a bug the traceback is written as well."""
    if isinstance(error, typer.Abort) and isinstance(error.__cause__, EOFError):
        error = error.__cause__  # typer takes the end of a file for Ctrl-D at a prompt; there is none here
    if isinstance(error, UsageError):
        usage: Any = error
        if not usage.format_message():  # no command at all: the help has been printed
            return ExitCode.BAD_INPUT, ""
        path = usage.ctx.command_path if usage.ctx else "ikde"
        return ExitCode.BAD_INPUT, f"{path}: {' '.join(usage.format_message().split())}"
    if isinstance(error, InputError):
        return ExitCode.BAD_INPUT, f"ikde: {error}"
    if isinstance(error, MemoryError):
        return ExitCode.BAD_INPUT, "ikde: not enough memory"
    if isinstance(error, KeyboardInterrupt | typer.Abort):
        return ExitCode.INTERRUPTED, str(error) or INTERRUPTED
    for line in traceback.format_exception(error):
        sys.stderr.write(printable(line, keep="\n"))
    return ExitCode.BUG, f"ikde: this is a bug, please report it: {type(error).__name__}: {error}"
