"""How long whole processes take: `ikde --help`, a warm `ikde solve`, and the first solve, which compiles.

    python benchmarks/start_up.py [path of the ikde command]

Wall and process (user + system) seconds of fresh processes, the commands in turn. The first solve has a cache folder of
its own, empty. Writes benchmarks/results/start_up.json.
"""

import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from machine import describe
from paper_search import summarise
from rich.console import Console
from rich.table import Table

ROUNDS = 20
SOLVE = ("solve", "--position", "800", "500", "1000", "--unit", "mm")
RESULTS = Path(__file__).parent / "results" / "start_up.json"


def run(program: str, arguments: tuple[str, ...], cache: str) -> tuple[float, float]:
    """Wall and process seconds of one process."""
    before, started = os.times(), time.perf_counter()
    environment = {**os.environ, "IKDE_CACHE_DIR": cache}
    subprocess.run([program, *arguments], env=environment, capture_output=True, check=True)
    wall, after = time.perf_counter() - started, os.times()
    return wall, after.children_user + after.children_system - before.children_user - before.children_system


def main() -> None:
    """Time, print, record."""
    beside = Path(sys.executable).parent / "ikde"
    program = sys.argv[1] if len(sys.argv) > 1 else shutil.which("ikde") or str(beside)
    with tempfile.TemporaryDirectory() as cache:
        times = {
            "ikde solve, the first on a machine": [run(program, SOLVE, cache)],
            "ikde --help": [],
            "ikde solve": [],
            "import numba, of it": [],
        }
        python = str(Path(program).resolve().parent / "python")
        for _ in range(ROUNDS):
            times["import numba, of it"].append(run(python, ("-c", "import numba"), cache))
            times["ikde --help"].append(run(program, ("--help",), cache))
            times["ikde solve"].append(run(program, SOLVE, cache))
    table = Table("command", "wall s median / max", "process s median / max")
    record = {}
    for name, pairs in times.items():
        wall, process = (summarise(column) for column in zip(*pairs, strict=True))
        record[name] = {"wall_s": wall, "process_s": process}
        table.add_row(name, *(f"{s['median']:.2f} / {s['max']:.2f}" for s in (wall, process)))
    Console().print(table)
    RESULTS.write_text(json.dumps({"machine": describe(), "rounds": ROUNDS, "commands": record}, indent=1))


if __name__ == "__main__":
    main()
