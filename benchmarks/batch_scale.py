"""Many targets through `ikde batch`: time a target, how much of it is search, peak memory, and two threads.

    python benchmarks/batch_scale.py                             # a million drawn targets: some minutes
    python benchmarks/batch_scale.py --targets 100000            # smaller
    python benchmarks/batch_scale.py --file parquet --targets 300000 --before ../ikde-before   # beside another checkout
    python benchmarks/batch_scale.py --file csv --targets 300000

Each run is a process of its own with all columns, everything graded, one row in 64 by plain numpy as well; with
`--file` the targets are read from a table. `us a row` counts from reading the run file to the summary; what is
loaded once, a process, its modules and kernels, is in `wall s` only. The bare search of the same targets is
timed apart. Runs take turns in random order, those of a checkout `--before` (its interpreter: `.venv/bin/python`) among
them. The parts of one thread and of all threads are compared byte for byte. Writes benchmarks/results/batch_scale.json,
or batch_scale_file.json.
"""

import argparse
import hashlib
import json
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.csv as pa_csv
import pyarrow.parquet as pq
from machine import describe
from rich.console import Console
from rich.table import Table

from ikde.io.plan_file import load_batch
from ikde.model.rotation import quat_wxyz_from_rotation
from ikde.solver.search import search

RESULTS = Path(__file__).parent / "results"
SAMPLE = 20_000  # lanes of the bare search
GOALS = ("position", "pose")
ROUNDS = 5  # recorded is the run of the median time
THREADS = {"1 thread": 1, "2 threads": 2}
QUATERNION = ["qw", "qx", "qy", "qz"]
RUN = """
import json, sys, tempfile, time, ikde
path, out, threads, goal = sys.argv[1:]
few = {"robot": "qiao2021", "targets": {"reachable": {"count": 200, "goal": goal}}, "explain": False}
with tempfile.TemporaryDirectory() as folder:
    ikde.run_batch(ikde.load_batch(few), folder)
started, processor = time.perf_counter(), time.process_time()
summary = ikde.run_batch(ikde.load_batch(path), out, threads=int(threads))
arm = summary.arms[0]
print(json.dumps({
    "inside_s": time.perf_counter() - started, "inside_processor_s": time.process_time() - processor,
    "peak_memory_mb": next(int(line.split()[1]) for line in open("/proc/self/status") if "VmHWM" in line) / 1024,
    "targets": arm.reached.total, "reached": arm.reached.count, "ms_median": arm.milliseconds.median,
}))
"""


def make_spec(goal: str, count: int, table: Path | None) -> dict[str, Any]:
    """A run of `count` targets that random collision-free configurations reach, drawn or from a table."""
    targets: dict[str, Any] = {"reachable": {"count": count, "goal": goal}}
    if table is not None:
        turn = {"quat_wxyz": QUATERNION} if goal == "pose" else {}
        targets = {"file": {"path": str(table), "columns": {"position": ["x", "y", "z"], **turn}}}
    return {"robot": "qiao2021", "targets": targets, "seed": 1, "explain": False}


def write_table(count: int, kind: str, folder: Path) -> Path:
    """The drawn pose targets as a file: a header, 17 digits, seven columns."""
    targets = load_batch(make_spec("pose", count, None)).source.read(0, count)
    values = np.column_stack([targets.p_world_tool, quat_wxyz_from_rotation(targets.R_world_tool)])
    table, path = pa.table(dict(zip(["x", "y", "z", *QUATERNION], values.T, strict=True))), folder / f"targets.{kind}"
    (pa_csv.write_csv if kind == "csv" else pq.write_table)(table, path)
    return path


def run(python: str, spec: dict[str, Any], goal: str, threads: int) -> dict[str, Any]:
    """One process: wall and processor seconds, peak memory, size of its folder."""
    folder = Path(tempfile.mkdtemp(prefix="batch_scale_"))
    try:
        path = folder / "spec.yaml"
        path.write_text(json.dumps(spec))  # JSON is YAML
        command = [python, "-c", RUN, str(path), str(folder / "run"), str(threads), goal]
        started = time.perf_counter()
        process = subprocess.Popen(command, stdout=subprocess.PIPE, cwd=folder)
        assert process.stdout is not None
        told = json.loads(process.stdout.read())
        _, _, usage = os.wait4(process.pid, 0)
        process.returncode = 0  # reaped by wait4
        return {
            **told,
            "digest": digest_solutions(folder / "run"),
            "wall_s": time.perf_counter() - started,
            "processor_s": usage.ru_utime + usage.ru_stime,
            "folder_mb": sum(file.stat().st_size for file in (folder / "run").rglob("*")) / 1e6,
            "us_a_row": 1e6 * told["inside_s"] / told["targets"],
            "processor_us_a_row": 1e6 * told["inside_processor_s"] / told["targets"],
            "solutions_a_second": told["targets"] / told["inside_s"],
        }
    finally:
        shutil.rmtree(folder)


def time_bare_search(spec: dict[str, Any], threads: int) -> float:
    """Seconds a row of the search alone, without reading, grading and writing."""
    batch = load_batch(spec)
    problem, targets = batch.arms[0].problem, batch.source.read(0, min(SAMPLE, batch.source.count))
    search(problem, targets[:8], seed=0, streams=range(8))
    started = time.perf_counter()
    search(problem, targets, seed=1, streams=range(len(targets)), threads=threads)
    return (time.perf_counter() - started) / len(targets)


def digest_solutions(folder: Path) -> str:
    """Of all solutions, byte for byte."""
    digest = hashlib.sha256()
    for path in sorted(folder.rglob("*.parquet")):
        if "timing" not in str(path.relative_to(folder)):
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def measure(pythons: dict[str, str], goal: str, spec: dict[str, Any], rounds: int) -> list[dict[str, Any]]:
    """The run of the median time of each checkout and number of threads, and what it gained round by round."""
    keys = [(name, label) for name in pythons for label in THREADS]
    runs: dict[tuple[str, str], list[dict[str, Any]]] = {key: [] for key in keys}
    for _ in range(rounds):
        for name, label in random.sample(keys, len(keys)):
            runs[name, label].append(run(pythons[name], spec, goal, THREADS[label]))
    for name in pythons:
        same = {cell["digest"] for label in THREADS for cell in runs[name, label]}
        assert len(same) == 1, "the number of threads changed an answer"
    cells = []
    for name, label in keys:
        middle = sorted(runs[name, label], key=lambda cell: cell["inside_s"])[rounds // 2]
        middle["run"] = f"{goal}, {label}" + (f", {name}" if len(pythons) > 1 else "")
        if name == "now":
            middle["search_us_a_row"] = 1e6 * time_bare_search(spec, THREADS[label])
        for key, reference in (("gains", (name, "1 thread")), ("gains_before", ("before", label))):
            if reference in runs and reference != (name, label):
                pairs = zip(runs[reference], runs[name, label], strict=True)
                middle[key] = [other["inside_s"] / mine["inside_s"] for other, mine in pairs]
        cells.append(middle)
    return cells


def print_table(cells: list[dict[str, Any]]) -> None:
    """The record as a table."""
    heads = ("us a row", "of it search", "processor us", "wall s", "peak MB", "folder MB")
    names = ("us_a_row", "search_us_a_row", "processor_us_a_row", "wall_s", "peak_memory_mb", "folder_mb")
    table = Table("run", "targets", *heads, "x 1 thread", "x before", "reached")
    for cell in cells:
        gains = (f"{np.median(cell[name]):.2f}" if name in cell else "" for name in ("gains", "gains_before"))
        numbers = (f"{cell[name]:,.2f}" if name in cell else "" for name in names)
        table.add_row(cell["run"], f"{cell['targets']:,}", *numbers, *gains, f"{cell['reached']:,}")
    Console(width=150).print(table)


def main() -> None:
    """Run all cells, print the table, write the record."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--targets", type=int, default=1_000_000)
    parser.add_argument("--file", choices=["parquet", "csv"], help="read the targets from a table")
    parser.add_argument("--before", type=Path, help="a checkout to compare with")
    parser.add_argument("--rounds", type=int, default=ROUNDS)
    asked = parser.parse_args()
    pythons = {"now": sys.executable}
    if asked.before:
        pythons["before"] = str(asked.before.resolve() / ".venv" / "bin" / "python")
    folder, cells = Path(tempfile.mkdtemp(prefix="batch_scale_")), []
    try:
        table = write_table(asked.targets, asked.file, folder) if asked.file else None
        for goal in GOALS:
            spec = make_spec(goal, asked.targets, table)
            for python in pythons.values():  # kernels are compiled and cached, those of the last few targets, too
                run(python, spec, goal, 1)
            cells += measure(pythons, goal, spec, asked.rounds)
    finally:
        shutil.rmtree(folder)
    print_table(cells)
    if asked.targets >= 1_000_000 or asked.file:
        name = "batch_scale_file.json" if asked.file else "batch_scale.json"
        record = {"machine": describe(), "file": asked.file, "cells": cells}
        (RESULTS / name).write_text(json.dumps(record, indent=1))


if __name__ == "__main__":
    main()
