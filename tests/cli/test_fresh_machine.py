"""One target is solved on a machine where nothing is compiled yet."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

PLAIN = """
import sys
from ikde.cli.app import run
code = run(sys.argv[1:])
print(code, sorted({"numba", "yaml", "matplotlib", "numpy.ma"} & set(sys.modules)), file=sys.stderr)
"""


@pytest.mark.parametrize("robot", ["qiao2021", "ur5", "panda"])
def test_one_target_is_solved_on_a_fresh_machine_without_numba(tmp_path, robot):
    """Nothing is compiled, no pool is drawn, and what is written into the cache serves the next process."""
    free = {name: value for name, value in os.environ.items() if name not in ("IKDE_COMPILE", "IKDE_KERNELS")}
    words = ["solve", "--robot", robot, "--position", "0.4", "0.2", "0.5", "--seed", "7", "--json"]
    place = {"cwd": Path(__file__).parents[2], "env": {**free, "IKDE_CACHE_DIR": str(tmp_path)}}
    command, answers = [sys.executable, "-c", PLAIN, *words], []
    for _ in range(2):
        done = subprocess.run(command, **place, capture_output=True, text=True, timeout=300, check=True)
        assert done.stderr == "0 []\n"
        answers.append(json.loads(done.stdout))
        assert not list(tmp_path.rglob("*.nbc"))
        assert not list(tmp_path.rglob("*.pool"))
    assert answers[0]["q"] == answers[1]["q"]
    assert answers[0]["verified"] is True
