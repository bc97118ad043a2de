"""What the runner itself costs: time a row beyond the search, and peak memory, as the number of targets grows.

    python benchmarks/batch_scale.py                  # half a million, a million, and 20,000 with `de`: some minutes
    python benchmarks/batch_scale.py --targets 20000  # smaller

Each run is a process of its own (`ikde batch`, position targets, all columns).
The blinks have populations of 6 and one generation, so that nearly all of their time is the runner's: reading targets,
grading, tabulating, writing. The bare search of the same lanes is timed apart and taken off. Writes
benchmarks/results/batch_scale.json.
"""

import argparse
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
from ikde.io.batch_file import load_batch
from ikde.solver.search import search

RESULTS = Path(__file__).parent / "results" / "batch_scale.json"
SAMPLE = 20_000  # lanes of the bare search
BLINK = {"settings": {"population": 6, "generations": 1, "restarts": 1}}
RUNS = {
    "blink, 1 thread": {"solve": BLINK, "threads": 1},
    "blink, all threads": {"solve": BLINK, "threads": None},
}
DE = {
    "method": "de",
    "settings": {"strategy": "best/1", "restarts": 50},
    "ranges": {"d_x": [-0.1, 0.1], "d_y": [-0.1, 0.1]},
}
DE_TARGETS = 20_000


def make_spec(solve: dict[str, Any], count: int) -> dict[str, Any]:
    """A run of `count` position targets: in a box, or of random configurations if they are to be reached."""
    box = {"box": {"from": [-1.0, -1.0, 0.3], "to": [1.0, 1.0, 1.2], "count": count}}
    return {
        "robot": "qiao2021",
        "targets": box if solve is BLINK else {"reachable": {"count": count, "goal": "position"}},
        "seed": 1,
        "explain": False,
        "solve": solve,
    }


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
    search(problem, targets[:1], seed=0, streams=[0], attempts=0)
    started = time.perf_counter()
    search(problem, targets, seed=1, streams=range(len(targets)), threads=threads)
    return (time.perf_counter() - started) / len(targets)


def measure(label: str, solve: dict[str, Any], count: int, threads: int | None) -> dict[str, Any]:
    """One run, with what it costs beyond the search if the search is short."""
    spec = make_spec(solve, count)
    folder = Path(tempfile.mkdtemp(prefix="batch_scale_"))
    try:
        cell = {"run": label, **run(spec, threads, folder)}
    finally:
        shutil.rmtree(folder)
    cell["us_a_row"] = 1e6 * cell["wall_s"] / count
    if solve is BLINK:
        cell["search_us_a_row"] = 1e6 * time_bare_search(spec, threads)
        cell["overhead_us_a_row"] = cell["us_a_row"] - cell["search_us_a_row"]
    return cell


def print_table(cells: list[dict[str, Any]]) -> None:
    """The record as a table."""
    columns = ("run", "targets", "wall s", "us a row", "of it search", "beyond", "peak MB", "folder MB", "reached")
    table = Table(*columns)
    for cell in cells:
        bare, beyond = cell.get("search_us_a_row", np.nan), cell.get("overhead_us_a_row", np.nan)
        figures = (cell["wall_s"], cell["us_a_row"], bare, beyond, cell["peak_memory_mb"], cell["folder_mb"])
        shares = [f"{figure:,.1f}" if np.isfinite(figure) else "" for figure in figures]
        table.add_row(cell["run"], f"{cell['targets']:,}", *shares, f"{cell['reached']:,}")
    Console(width=130).print(table)


def main() -> None:
    """Run all cells, print the table, write the record."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--targets", type=int, default=1_000_000)
    most = parser.parse_args().targets
    ikde.solve(ikde.load_robot("qiao2021"), ikde.Target((0.8, 0.5, 1.0)))  # kernels are compiled and cached
    cells = [
        measure(label, facts["solve"], count, facts["threads"])
        for label, facts in RUNS.items()
        for count in (most // 2, most)
    ]
    cells.append(measure("de, all threads", DE, min(DE_TARGETS, most), None))
    print_table(cells)
    if most >= 1_000_000:
        RESULTS.write_text(json.dumps({"machine": describe(), "cells": cells}, indent=1))


if __name__ == "__main__":
    main()
