"""Style, types and the floors between packages, as part of the one test command."""

import subprocess
import sys
from pathlib import Path

import pytest

import ikde

ROOT = Path(__file__).parent.parent
TOOLS = {
    "style": ["ruff", "check", "."],
    "format": ["ruff", "format", "--check", "."],
    "floors": ["lint-imports"],
    "types": ["pyright", "--pythonpath", sys.executable],
}


@pytest.mark.parametrize("name", TOOLS)
def test_the_house_holds(name):
    program, *arguments = TOOLS[name]
    command = [str(Path(sys.executable).parent / program), *arguments]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_script_that_is_checked_uses_every_public_name():
    script = (ROOT / "tests" / "user_script.py").read_text(encoding="utf-8")
    assert [name for name in ikde._HOME if f"ikde.{name}" not in script] == []
