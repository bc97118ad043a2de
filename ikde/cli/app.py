"""The `ikde` command: its subcommands, and the one place where errors become exit codes."""

import os
import sys
from typing import Annotated, NoReturn

import typer

from ikde import __version__
from ikde.cli.check import check
from ikde.cli.doctor import doctor
from ikde.cli.exit_codes import ExitCode
from ikde.cli.fk import fk
from ikde.cli.output import print_note, print_result
from ikde.cli.robots import robots
from ikde.cli.solve import solve
from ikde.cli.startup import skip_garbage_collection
from ikde.errors import InputError, VerificationError

UsageError = typer.BadParameter.__bases__[0]  # click's, wherever typer keeps it: newer ones carry their own copy

app = typer.Typer(
    name="ikde",
    help="Collision-aware inverse kinematics: a search proposes, sphere checks reject, separate code grades.",
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
    """Collision-aware inverse kinematics: a search proposes, sphere checks reject, separate code grades.

    Exit codes: 0 all reached, 1 some not reached or a collision found, 2 bad usage or file, 3 a bug, 130 interrupted.
    """


for command in (solve, fk, check, doctor):
    app.command()(command)
app.add_typer(robots, name="robots")


def main() -> NoReturn:
    """Run the command line and exit."""
    skip_garbage_collection()
    sys.exit(run(sys.argv[1:]))


def run(arguments: list[str]) -> int:
    """Run one command; returns its exit code and turns every error into one line on stderr."""
    try:
        code = app(arguments, prog_name="ikde", standalone_mode=False)
        return int(code or ExitCode.OK)
    except UsageError as error:
        path = error.ctx.command_path if error.ctx else "ikde"
        print_note(f"{path}: {' '.join(error.format_message().split())}")
        return ExitCode.BAD_INPUT
    except VerificationError as error:
        print_note(f"ikde: this is a bug, please report it: {error}")
        return ExitCode.BUG
    except InputError as error:
        print_note(f"ikde: {error}")
        return ExitCode.BAD_INPUT
    except (KeyboardInterrupt, typer.Abort):
        print_note("ikde: interrupted")
        return ExitCode.INTERRUPTED
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return ExitCode.OK
    except Exception as error:
        import traceback

        traceback.print_exc()
        print_note(f"ikde: this is a bug, please report it: {type(error).__name__}: {error}")
        return ExitCode.BUG
