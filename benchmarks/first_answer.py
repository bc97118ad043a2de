"""Whole `ikde solve` processes, one target each: nothing in the cache, then warm, beside another checkout that is warm.

    python benchmarks/first_answer.py OTHER_IKDE_COMMAND [rounds]

Three robots, three kinds of targets, the processes in turn; the smallest wall and process (user + system) seconds, and
the ratio of process seconds, which a loaded machine changes less.
"""

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

POSITIONS = {"qiao2021": "0.8 0.5 1.0", "ur5": "0.3 0.2 0.4", "panda": "0.4 0.2 0.5"}
KINDS = {"position": "", "axis": "--axis 0 0 -1", "pose": "--quat-wxyz 0 1 0 0"}


def run(program: str, words: list[str], cache: str) -> tuple[float, float]:
    """Wall and process seconds."""
    before, started = os.times(), time.perf_counter()
    subprocess.run([program, *words], env={**os.environ, "IKDE_CACHE_DIR": cache}, capture_output=True, check=True)
    wall, after = time.perf_counter() - started, os.times()
    return wall, after.children_user + after.children_system - before.children_user - before.children_system


def main() -> None:
    """Print a line for each robot and kind."""
    other, rounds = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 5
    own = str(Path(sys.executable).parent / "ikde")
    with tempfile.TemporaryDirectory() as warm:
        for robot, position in POSITIONS.items():
            for kind, turned in KINDS.items():
                words = ["solve", "--robot", robot, "--position", *position.split(), *turned.split(), "--json"]
                run(other, words, warm)
                columns: list[list[tuple[float, float]]] = [[], [], []]
                for _ in range(rounds):
                    with tempfile.TemporaryDirectory() as fresh:
                        columns[0].append(run(own, words, fresh))
                        columns[1].append(run(own, words, fresh))
                    columns[2].append(run(other, words, warm))
                first, again, before = ([min(column) for column in zip(*pairs, strict=True)] for pairs in columns)
                ratios = f"{first[1] / before[1]:.2f} and {again[1] / before[1]:.2f} of it"
                figures = (f"{wall:.2f} / {process:.2f}" for wall, process in (first, again, before))
                print(f"{robot} {kind}: first, again, other (wall / process s) {', '.join(figures)}: {ratios}")


if __name__ == "__main__":
    main()
