"""`ikde completion`, and what the process answers to a shell."""

import os
import shutil
import subprocess
import sys

import pytest

LIGHT = """
import sys
from ikde.cli.app import run
code = run([])
loaded = sorted({"numpy", "numba", "scipy", "rich", "matplotlib"} & set(sys.modules))
sys.exit(f"loaded {loaded}" if loaded else code)
"""


def complete(line):
    """What bash would offer at the end of a line."""
    asking = {"_IKDE_COMPLETE": "complete_bash", "COMP_WORDS": line, "COMP_CWORD": str(len(line.split(" ")) - 1)}
    told = {"env": {**os.environ, **asking}, "capture_output": True, "text": True, "timeout": 60}
    done = subprocess.run([sys.executable, "-c", LIGHT], check=False, **told)
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout.split()


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_a_shell_gets_its_script(cli, shell):
    outcome = cli("completion", shell)
    assert (outcome.code, outcome.err) == (0, "")
    assert f"_IKDE_COMPLETE=complete_{shell}" in outcome.out


@pytest.mark.parametrize("words", [("tcsh",), ()])
def test_another_shell_is_refused(refuse, words):
    got = "'tcsh'" if words else "nothing"
    assert refuse("completion", *words).startswith(
        f"ikde: completion: expected a shell, one of bash, zsh, fish, got {got}"
    )


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("ikde che", ["check"]),
        ("ikde solve --near", ["--near"]),
        ("ikde solve --robot pa", ["panda", "panda_hand"]),
        ("ikde solve --robot ur5 --freeze elbow", ["elbow_joint"]),
        ("ikde check --detector im", ["improved"]),
        ("ikde robots show panda --detector ", ["default", "none"]),
        ("ikde solve --rank l", ["limits"]),
        ("ikde solve --method me", ["memetic"]),
        ("ikde schema t", ["track"]),
        ("ikde completion z", ["zsh"]),
    ],
)
def test_a_shell_is_answered_without_anything_heavy(line, words):
    assert complete(line) == words


ASK = """
eval "$(ikde completion bash)"
complete -p ikde
COMP_WORDS=({line}) COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1))
_ikde_completion ikde
printf '%s\n' "${{COMPREPLY[@]}}"
"""


@pytest.mark.skipif(shutil.which("bash") is None, reason="there is no bash")
@pytest.mark.parametrize(
    ("line", "words"), [("ikde robots sh", ["show"]), ("ikde check --robot ur", ["ur5", "ur5e_mecanum"])]
)
def test_bash_completes(tmp_path, line, words):
    command = tmp_path / "ikde"
    command.write_text(f'#!/bin/sh\nexec {sys.executable} -m ikde "$@"\n')
    command.chmod(0o755)
    env = {**os.environ, "PATH": f"{tmp_path}:{os.environ['PATH']}"}
    told = {"env": env, "capture_output": True, "text": True, "timeout": 60}
    done = subprocess.run(["bash", "--norc", "-c", ASK.format(line=line)], check=False, **told)
    assert done.stderr == ""
    assert done.stdout.splitlines() == ["complete -o default -F _ikde_completion ikde", *words]


def test_help_says_what_to_write_for_each_shell_once(cli):
    text = " ".join(cli("completion", "--help").out.split())
    assert "<str>" not in text
    for line in ('eval "$(ikde completion zsh)"', "ikde completion fish | source"):
        assert text.count(line) == 1
    assert ">>" not in text
