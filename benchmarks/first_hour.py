"""A newcomer's first hour, step by step: from a clone without caches to a followed track.

    python benchmarks/first_hour.py

Clones this checkout as it is committed and runs what docs/first_hour.md shows, word for word and in order; then, but
for the installation, once more, with what the first time has compiled. Wall and process (user + system) seconds of each
command. A child that still compiles in the background when its parent has ended is not waited for. Writes
benchmarks/results/first_hour.json.
"""

import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from machine import describe
from rich.console import Console
from rich.table import Table

ROOT = Path(__file__).parent.parent
RESULTS = ROOT / "benchmarks" / "results" / "first_hour.json"
STEP = re.compile(r"^## (\d+\. .*?)$(.*?)(?=^## |\Z)", re.DOTALL | re.MULTILINE)
FILE = re.compile(r"^`(\w+\.\w+)`:\n\n```\w+\n(.*?)^```$", re.DOTALL | re.MULTILINE)
COMMANDS = re.compile(r"^```bash\n(.*?)^```$", re.DOTALL | re.MULTILINE)
ANSWERED = (0, 1)  # exit codes


def read_steps(page: str) -> dict[str, list[str]]:
    """The commands of each numbered step."""
    return {
        name: [line for block in COMMANDS.findall(body) for line in block.splitlines()]
        for name, body in STEP.findall(page)
    }


def run(line: str, folder: Path, environment: dict[str, str]) -> dict[str, float]:
    """Wall and process seconds of one command."""
    with tempfile.TemporaryFile() as messages:
        started = time.perf_counter()
        process = subprocess.Popen(
            ["bash", "-c", line], cwd=folder, env=environment, stdout=subprocess.DEVNULL, stderr=messages
        )
        _, status, used = os.wait4(process.pid, 0)
        wall = time.perf_counter() - started
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode not in ANSWERED:
            messages.seek(0)
            sys.exit(f"{line}\n{messages.read().decode()}")
    return {"wall_s": wall, "process_s": used.ru_utime + used.ru_stime}


def measure(folder: Path) -> list[dict[str, Any]]:
    """A row for each command."""
    page = (folder / "docs" / "first_hour.md").read_text(encoding="utf-8")
    for name, text in FILE.findall(page):
        (folder / name).write_text(text, encoding="utf-8")
    environment = {key: value for key, value in os.environ.items() if not key.startswith(("IKDE_", "PYTHON"))} | {
        "PATH": f"{folder / '.venv' / 'bin'}:{os.environ['PATH']}",
        "IKDE_CACHE_DIR": str(folder / "cache"),
        "MPLCONFIGDIR": str(folder / "cache" / "matplotlib"),
    }
    steps = read_steps(page)
    rows = [
        {"step": step, "command": line, "first": run(line, folder, environment)}
        for step, lines in steps.items()
        for line in lines
    ]
    shutil.rmtree(folder / "runs")
    for row in rows:
        if row["step"] != next(iter(steps)):
            row["again"] = run(row["command"], folder, environment)
    return rows


def main() -> None:
    """Measure, print, record."""
    with tempfile.TemporaryDirectory() as scratch:
        clone = Path(scratch) / "ikde"
        subprocess.run(["git", "clone", "--quiet", str(ROOT), str(clone)], check=True)
        rows = measure(clone)
    table = Table("command", "wall s", "process s", "again, wall s", "process s")
    for row in rows:
        times = [row.get(when, {}).get(key) for when in ("first", "again") for key in ("wall_s", "process_s")]
        table.add_row(row["command"], *("" if t is None else f"{t:.1f}" for t in times))
    Console().print(table)
    RESULTS.write_text(json.dumps({"machine": describe(), "load": os.getloadavg()[0], "rows": rows}, indent=1))


if __name__ == "__main__":
    main()
