"""`ikde completion`, and what a shell gets when it asks."""

import os
import subprocess
import sys

import pytest

from ikde.cli.completion import VARIABLE


def ask(words, shell="bash"):
    """What bash is offered for the last of these words; and the modules that were imported for it."""
    line = " ".join(words)
    program = "import sys; from ikde.cli.app import run_and_exit; run_and_exit()"
    environment = {**os.environ, VARIABLE: f"complete_{shell}", "COMP_WORDS": line, "COMP_CWORD": str(len(words) - 1)}
    command = [sys.executable, "-X", "importtime", "-c", program]
    done = subprocess.run(command, env=environment, capture_output=True, text=True)
    return done.stdout.split(), done.stderr


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_each_shell_has_its_script(cli, shell):
    outcome = cli("completion", shell)
    assert outcome.code == 0
    assert VARIABLE in outcome.out


def test_another_shell_is_refused(cli):
    assert cli("completion", "tcsh").code == 2


def test_a_shell_is_offered_commands_and_robots_and_waits_for_no_numpy():
    offered, imported = ask(["ikde", "so"])
    assert offered == ["solve"]
    assert "numpy" not in imported
    offered, imported = ask(["ikde", "solve", "--robot", "ur"])
    assert offered == ["ur5"]
    assert "numpy" not in imported
