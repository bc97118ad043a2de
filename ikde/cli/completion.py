"""`ikde completion`: commands, options and names, completed by the shell."""

import os
from typing import Annotated

import typer

from ikde.cli.candidates import offer
from ikde.cli.output import print_result

VARIABLE = "_IKDE_COMPLETE"
"""What a shell sets when it asks."""


SHELLS = ("bash", "zsh", "fish")


def completion(
    shell: Annotated[
        str | None,
        typer.Argument(
            metavar="|".join(SHELLS), show_default=False, autocompletion=offer(*SHELLS), help="The shell to answer."
        ),
    ] = None,
) -> None:
    """Print what makes a shell complete commands, options, and names of robots, joints and detectors.

    One line in what the shell reads when it starts switches it on.

    bash, in ~/.bashrc: eval "$(ikde completion bash)"

    zsh, in ~/.zshrc, below compinit: eval "$(ikde completion zsh)"

    fish, in ~/.config/fish/config.fish: ikde completion fish | source

    Example: eval "$(ikde completion bash)"
    """
    from ikde.errors import InputError, nearest, quoted

    if shell not in SHELLS:
        got = f"{quoted(shell)}{nearest(shell, SHELLS)}" if shell else "nothing"
        raise InputError(f"expected a shell, one of {', '.join(SHELLS)}, got {got}", ("completion",))
    from typer.completion import get_completion_script  # type: ignore[attr-defined]

    print_result(get_completion_script(prog_name="ikde", complete_var=VARIABLE, shell=shell))


def prepare_completion() -> None:
    """Make typer answer shells, if one is asking."""
    if VARIABLE in os.environ:
        from typer.completion import completion_init  # type: ignore[attr-defined]

        completion_init()
