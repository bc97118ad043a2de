"""The paper's tasks by the paper's two methods and by `continuation`, on both bases: what is reached, broken and spent.

    python benchmarks/track.py           # ten seeds, 100 random starts a task: a quarter of an hour on two cores
    python benchmarks/track.py --quick   # one seed, four starts; writes nothing

`ikde.track.comparison` runs and counts, as for `ikde bench track`: all methods begin where `continuation` begins, what
`typical` does is graded as if the base could slide, times are wall times of each sample, of the first seed, which runs
alone; the others run on all cores at once. Writes benchmarks/results/track.json after each task.
"""

import argparse
import json
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

from machine import describe
from rich.console import Console
from rich.table import Table

from ikde.io.plan_file import load_track
from ikde.model.base_motion import Drive
from ikde.report.track_comparison import FIGURES, list_cells
from ikde.track.comparison import FULL, METHODS, TrackBudget, compare_methods
from ikde.track.spec import TrackMethod

HERE = Path(__file__).parent
RESULTS = HERE / "results" / "track.json"
TRACKS = HERE.parent / "configs" / "tracks"
TASKS = ("task1", "task2", "task3", "task4", "task4_minus_x")
QUICK = TrackBudget(seeds=1, starts=4)
MET_ON: dict[Drive, tuple[TrackMethod, ...]] = {
    "differential": METHODS,
    "omnidirectional": ("optimized", "continuation"),
}
"""`typical` moves in the same way on either base."""


class Quiet:
    """Progress: the name of what is computed."""

    def begin(self, section: str) -> None:
        """Say it."""
        print(section, flush=True)

    def advance(self, solves: int) -> None:
        """Nothing."""


def main() -> None:
    """Run all, print a table, record."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="one seed, four starts; writes nothing")
    parser.add_argument("--tasks", nargs="+", choices=TASKS, default=TASKS, help="these alone; writes nothing")
    options = parser.parse_args()
    began, records = time.perf_counter(), []
    for task in options.tasks:
        for drive, methods in MET_ON.items():
            plan = replace(load_track(TRACKS / f"qiao2022_{task}.yaml"), drive=drive)
            data = compare_methods(plan, methods, QUICK if options.quick else FULL, Quiet()).data
            records.append({**data, "file": plan.path.name, "drive": drive})
        if not options.quick and options.tasks == TASKS:
            record = {"machine": describe(), "seconds": round(time.perf_counter() - began), "tracks": records}
            RESULTS.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    show(records)


def show(records: list[dict[str, Any]]) -> None:
    """One row for each track, base and method: the worst of the seeds, times in the middle."""
    table = Table("track", "base", "method", *(column.head for column in FIGURES))
    ends = Table("track", "base", "dead ends", "why")
    for record in records:
        for method in dict.fromkeys(run["method"] for run in record["runs"]):
            runs = [run for run in record["runs"] if run["method"] == method]
            table.add_row(record["name"], record["drive"][:4], method, *list_cells(runs))
        found = record["dead_ends"]
        counts = ", ".join(f"{name} {found[name]}" for name in found["reached_points"])
        ends.add_row(record["name"], record["drive"][:4], f"of {found['starts']}: {counts}", json.dumps(found["stops"]))
    console = Console(width=190)
    console.print(table)
    console.print(ends)


if __name__ == "__main__":
    main()
