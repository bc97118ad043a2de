"""A million targets through `ikde batch`: time a target, how much of it is search, peak memory, and two threads.

    python benchmarks/batch_scale.py                   # position and pose targets, one thread and all: some minutes
    python benchmarks/batch_scale.py --targets 100000  # smaller

Each run is a process of its own with all columns, everything graded, one row in 64 by plain numpy as well. The bare
search of the same targets is timed apart. The parts of one thread and of all threads are compared byte for byte. Writes
benchmarks/results/batch_scale.json.
"""

import argparse
import hashlib
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
from machine import describe
from rich.console import Console
from rich.table import Table

import ikde
from ikde.io.plan_file import load_batch
from ikde.solver.search import search

RESULTS = Path(__file__).parent / "results" / "batch_scale.json"
SAMPLE = 20_000  # lanes of the bare search
GOALS = ("position", "pose")
ROUNDS = 3  # interleaved; recorded is the run of the median time
THREADS = {"1 thread": 1, "all threads": None}


def make_spec(goal: str, count: int) -> dict[str, Any]:
    """A run of `count` targets that random collision-free configurations reach."""
    targets = {"reachable": {"count": count, "goal": goal}}
    return {"robot": "qiao2021", "targets": targets, "seed": 1, "explain": False}


def run(spec: dict[str, Any], threads: int | None, folder: Path) -> dict[str, Any]:
    """One process: wall and processor seconds, peak memory, size of its folder."""
    path = folder / "spec.yaml"
    path.write_text(json.dumps(spec))  # JSON is YAML
    command = [sys.executable, "-m", "ikde", "batch", str(path), "--out", str(folder / "run"), "--json"]
    started = time.perf_counter()
    process = subprocess.Popen(
        command + (["--threads", str(threads)] if threads else []), stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
    )
    assert process.stdout is not None
    summary = json.loads(process.stdout.read())
    _, _, usage = os.wait4(process.pid, 0)
    process.returncode = 0  # reaped by wait4
    return {
        "digest": digest_solutions(folder / "run"),
        "targets": summary["solves"],
        "reached": summary["solves"] - summary["unreached"],
        "wall_s": time.perf_counter() - started,
        "processor_s": usage.ru_utime + usage.ru_stime,
        "peak_memory_mb": usage.ru_maxrss / 1024,
        "folder_mb": sum(file.stat().st_size for file in (folder / "run").rglob("*")) / 1e6,
        "ms_median": summary["arms"][0]["milliseconds"]["median"],
    }


def time_bare_search(spec: dict[str, Any], threads: int | None) -> float:
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


def measure(goal: str, count: int, label: str) -> dict[str, Any]:
    """One run, and the search alone."""
    spec, threads = make_spec(goal, count), THREADS[label]
    folder = Path(tempfile.mkdtemp(prefix="batch_scale_"))
    try:
        cell = {"run": f"{goal}, {label}", **run(spec, threads, folder)}
    finally:
        shutil.rmtree(folder)
    cell["us_a_row"] = 1e6 * cell["wall_s"] / count
    cell["solutions_a_second"] = count / cell["wall_s"]
    cell["search_us_a_row"] = 1e6 * time_bare_search(spec, threads)
    return cell


def print_table(cells: list[dict[str, Any]]) -> None:
    """The record as a table."""
    table = Table("run", "targets", "wall s", "us a row", "of it search", "a second", "peak MB", "folder MB", "reached")
    for cell in cells:
        names = ("wall_s", "us_a_row", "search_us_a_row", "solutions_a_second", "peak_memory_mb", "folder_mb")
        table.add_row(
            cell["run"], f"{cell['targets']:,}", *(f"{cell[name]:,.1f}" for name in names), f"{cell['reached']:,}"
        )
    Console(width=130).print(table)


def main() -> None:
    """Run all cells, print the table, write the record."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--targets", type=int, default=1_000_000)
    most = parser.parse_args().targets
    robot, target = ikde.load_robot("qiao2021"), ikde.Target((0.8, 0.5, 1.0))
    ikde.solve_many(robot, [target] * 8)  # kernels are compiled and cached
    ikde.solve_many(robot, [ikde.Target(target.p_world_tool, R_world_tool=np.eye(3))] * 8)
    rounds = [[[measure(goal, most, label) for label in THREADS] for goal in GOALS] for _ in range(ROUNDS)]
    cells = []
    for turns in zip(*rounds, strict=True):
        assert len({cell["digest"] for turn in turns for cell in turn}) == 1, "the number of threads changed an answer"
        one, several = (sorted(cells, key=lambda cell: cell["wall_s"]) for cells in zip(*turns, strict=True))
        gains = [turn[0]["wall_s"] / turn[1]["wall_s"] for turn in turns]
        middle = several[ROUNDS // 2] | {"times_one_thread": float(np.median(gains)), "gains": gains}
        print(f"{middle['run']}: {', '.join(f'{gain:.2f}' for gain in gains)} times one thread, the same bytes")
        cells += [one[ROUNDS // 2], middle]
    print_table(cells)
    if most >= 1_000_000:
        RESULTS.write_text(json.dumps({"machine": describe(), "cells": cells}, indent=1))


if __name__ == "__main__":
    main()
