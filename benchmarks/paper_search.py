"""The paper's search on its two targets: attempts and time until a verified collision-free solution.

    python benchmarks/paper_search.py            # 1,000 seeds a cell, about two minutes
    python benchmarks/paper_search.py --seeds 50

Method `de` as the paper uses it (rand/1, NP = 50, G = 1000, F = 0.5, CR = 0.9, reject, 5e-5 m), base within +-0.1 m.
Every solution is graded by `verify`. Times are those of one solve on one core; the paper's detection alone took 1.67 to
1.94 s a solve (Table 4). Writes benchmarks/results/paper_search.json.
"""

import argparse
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from machine import describe
from rich.console import Console
from rich.progress import track
from rich.table import Table

import ikde
from ikde.paper.plain_search import limit_base

TARGETS_M = {"task 1": (0.8, 0.5, 1.0), "task 2": (0.54, -0.131, 0.974)}
BASE_RANGE_M = 0.1
RESULTS = Path(__file__).parent / "results" / "paper_search.json"


def run_cell(robot: ikde.Robot, target: ikde.Target, detector: str, seeds: int, label: str) -> dict[str, Any]:
    """Solve one target with many seeds, one after the other."""
    results = [
        ikde.solve(robot, target, method="de", collision=detector, seed=seed)
        for seed in track(range(seeds), description=label, console=Console(stderr=True))
    ]
    seconds = np.array([result.solve_seconds for result in results])
    attempts = np.array([result.attempts for result in results])
    return {
        "solved": sum(result.reached and result.verified for result in results),
        "seeds": seeds,
        "attempts": summarise(attempts),
        "milliseconds": summarise(seconds * 1e3),
        "smallest_clearance_mm": min(result.clearance_m or 0.0 for result in results) * 1e3,
        "largest_error_mm": max(result.position_error_m for result in results) * 1e3,
        "rejected_share": 1.0 - seeds / float(attempts.sum()),
    }


def summarise(values: Sequence[float] | np.ndarray) -> dict[str, float]:
    """Median, 95th percentile and maximum over all."""
    return {
        "median": float(np.median(values)),
        "p95": float(np.percentile(values, 95)),
        "max": float(np.max(values)),
    }


def main() -> None:
    """Run all cells, print the table, write the record."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=1000)
    seeds = parser.parse_args().seeds
    robot = limit_base(ikde.load_robot("qiao2021"), BASE_RANGE_M)
    table = Table("target", "detector", "solved", "attempts median / p95 / max", "ms median / p95 / max", "rejected")
    cells = {}
    for name, position in TARGETS_M.items():
        for detector in ("improved", "typical"):
            cell = run_cell(robot, ikde.Target(position), detector, seeds, f"{name}, {detector}")
            cells[f"{name}, {detector}"] = cell
            attempts, times = cell["attempts"], cell["milliseconds"]
            table.add_row(
                name,
                detector,
                f"{cell['solved']} / {seeds}",
                " / ".join(f"{attempts[k]:.0f}" for k in ("median", "p95", "max")),
                " / ".join(f"{times[k]:.0f}" for k in ("median", "p95", "max")),
                f"{cell['rejected_share']:.1%}",
            )
    Console().print(table)
    if seeds >= 1000:
        RESULTS.write_text(json.dumps({"machine": describe(), "base_range_m": BASE_RANGE_M, "cells": cells}, indent=1))


if __name__ == "__main__":
    main()
