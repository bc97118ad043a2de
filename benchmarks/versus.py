"""Two checkouts beside each other: a process each, rounds interleaved, ratios of medians.

    python -m benchmarks.versus benchmarks/call.py --before ../other_checkout --rounds 15

A script of cases has a function `cases()` that gives, by name, what one round runs: called without arguments, it gives
back the microseconds of each call. It runs in both checkouts, so it imports nothing but the public API. A case that
only one of them has is shown alone. `--only TEXT` keeps the cases whose name contains it.
"""

import argparse
import importlib.util
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

HERE = Path(__file__).resolve().parent.parent
Case = Callable[[], Sequence[float]]
SHARES = (50, 95, 99, 100)


class Side:
    """One checkout: a process that runs rounds when it is asked to."""

    def __init__(self, script: Path, checkout: Path, only: str) -> None:
        environment = {**os.environ, "PYTHONPATH": str(checkout), "PYTHONWARNINGS": "ignore", "IKDE_COMPILE": "wait"}
        command = [sys.executable, str(Path(__file__).resolve()), str(script.resolve()), "--serve", "--only", only]
        self._process = subprocess.Popen(
            command, env=environment, cwd=checkout, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        self.names: list[str] = self._read()

    def run(self, name: str) -> list[float]:
        """One round of a case, us a call."""
        assert self._process.stdin is not None
        print(name, file=self._process.stdin, flush=True)
        return self._read()

    def _read(self) -> Any:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            if line.startswith("[") or line.startswith("{"):
                return json.loads(line)
        raise SystemExit("a process has ended early")


def time_calls(call: Callable[[int], object], count: int) -> list[float]:
    """Microseconds of call(0) .. call(count - 1), one by one."""
    spent, clock = [], time.perf_counter_ns
    for k in range(count):
        started = clock()
        call(k)
        spent.append((clock() - started) * 1e-3)
    return spent


def serve(script: Path, only: str) -> None:
    """Run the rounds whose names come in, one a line; each has been run once before."""
    spec = importlib.util.spec_from_file_location("cases", script)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    cases: dict[str, Case] = {name: case for name, case in module.cases().items() if only in name}
    for case in cases.values():
        case()
    print(json.dumps(list(cases)), flush=True)
    for line in sys.stdin:
        print(json.dumps([round(float(us), 3) for us in cases[line.strip()]()]), flush=True)


def compare(sides: dict[str, Side], rounds: int) -> dict[str, dict[str, Any]]:
    """Figures of each case, by side, and the ratio of their medians: least, median and largest over the rounds."""
    names = list(dict.fromkeys(name for side in sides.values() for name in side.names))
    spent: dict[str, dict[str, list[list[float]]]] = {name: {label: [] for label in sides} for name in names}
    for number in range(rounds):
        for name in names:
            for label in sorted(sides, reverse=bool(number % 2)):
                if name in sides[label].names:
                    spent[name][label].append(sides[label].run(name))
        print(f"round {number + 1} of {rounds}", end="\r", file=sys.stderr)
    print(file=sys.stderr)
    figures: dict[str, dict[str, Any]] = {}
    for name, by_side in spent.items():
        ran = {label: np.array(values) for label, values in by_side.items() if values}
        figures[name] = {
            label: [round(float(np.percentile(np.median(values, axis=0), share)), 3) for share in SHARES]
            for label, values in ran.items()
        }
        if len(ran) == len(sides) == 2:
            ratios = np.median(ran["after"], axis=1) / np.median(ran["before"], axis=1)
            figures[name]["ratio"] = [round(float(f(ratios)), 3) for f in (np.min, np.median, np.max)]
    return figures


def show(figures: dict[str, dict[str, Any]]) -> None:
    """A Markdown table, a line a case."""
    print("| µs a call, median / p95 / p99 / max | before | after | ratio: least, median, largest |\n|---|---|---|---|")
    for name, row in figures.items():
        sides = [" / ".join(f"{value:.4g}" for value in row.get(label, [])) or "-" for label in ("before", "after")]
        ratio = ", ".join(f"{value:.2f}" for value in row.get("ratio", [])) or "-"
        print(f"| {name} | {' | '.join(sides)} | {ratio} |")


def main() -> None:
    """Compare, show, and write the figures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("script", type=Path)
    parser.add_argument("--before", type=Path, help="the other checkout; none: this one alone")
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--only", default="")
    parser.add_argument("--out", type=Path, help="JSON")
    parser.add_argument("--serve", action="store_true", help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.serve:
        serve(asked.script, asked.only)
        return
    checkouts = {"before": asked.before.resolve()} if asked.before else {}
    sides = {label: Side(asked.script, path, asked.only) for label, path in {**checkouts, "after": HERE}.items()}
    figures = compare(sides, asked.rounds)
    show(figures)
    if asked.out:
        asked.out.write_text(json.dumps(figures, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
