"""A UR5 on a fixed base: `ikde.solve`, which answers by its closed form, beside `lm` alone.

    python benchmarks/closed.py [--targets N] [--rounds N] [--sets ordinary hard none]

Each round asks every way for every target, all in one shuffled order, from Python, on one core, and reads the clock
around each call. Figures are of each target's median over the rounds; every answer is graded by plain numpy. Bulk is
microseconds a target of `solve_many` on one thread. Others' closed forms: `benchmarks/peers/run.py`, case *ur5 pose*.
Ordinary and hard poses as in `benchmarks/peers/cases.py`; *none* are poses of which no branch is free, or none exists.
With all sets it writes benchmarks/results/closed.json.
"""

import argparse
import json
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from machine import describe
from rich.console import Console
from rich.table import Table

import ikde
from ikde.kernels.arrays import Floats
from ikde.model.rotation import rotation_from_quat_wxyz

sys.path.insert(0, str(Path(__file__).parent / "peers"))
from cases import draw_hard, draw_ordinary

RESULTS = Path(__file__).parent / "results" / "closed.json"
SEED = 20261
BULK = 20_000
SETS = ["ordinary", "hard", "none"]
SETTINGS = ikde.SolveSettings()
Solve = Callable[[int], Floats | None]


def main() -> None:
    """Run every set, print and record."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--targets", type=int, default=1000, help="of each set")
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--sets", nargs="+", default=SETS, choices=SETS)
    asked = parser.parse_args()
    robot, records = ikde.load_robot("ur5"), []
    for name in asked.sets:
        targets = make_targets(robot, name, asked.targets if name != "none" else asked.targets // 10)
        ways = make_ways(robot, targets)
        if name == "none":  # `lm` goes on to its last attempt, a second or so
            del ways["ikde.solve, lm"]
        times, answers = time_ways(ways, len(targets), asked.rounds)
        for way, spent in times.items():
            record = {
                "set": name,
                "way": way,
                "accepted": count_accepted(robot, targets, answers[way]),
                **spread(spent),
            }
            records.append({**record, "targets": len(targets)})
            print(json.dumps(records[-1]), flush=True)
    bulk = {name: time_bulk(robot, name, asked.rounds) for name in asked.sets if name != "none"}
    show(records, bulk)
    if asked.sets == SETS:
        RESULTS.write_text(json.dumps({"machine": describe(), "sets": records, "bulk_us": bulk}, indent=1) + "\n")


def make_targets(robot: ikde.Robot, name: str, count: int) -> list[ikde.Target]:
    """Poses of one set."""
    if name == "none":
        return draw_none(robot, count)
    p, R = draw_hard(robot, "pose", count, SEED) if name == "hard" else draw_ordinary(robot, count, SEED)
    return [ikde.Target(p[k], R_world_tool=R[k]) for k in range(count)]


def draw_none(robot: ikde.Robot, count: int) -> list[ikde.Target]:
    """Poses anywhere around the arm to which it has no answer."""
    rng, found = np.random.default_rng(SEED), []
    while len(found) < count:
        quat = rng.normal(size=(1000, 4))
        R = rotation_from_quat_wxyz(quat / np.linalg.norm(quat, axis=1)[:, None])
        targets = ikde.Targets(rng.uniform(-0.9, 0.9, (1000, 3)), R_world_tool=R)
        rows = ikde.solve_many(robot, targets, method="analytic", bulk=ikde.BulkOptions(explain=False))
        found += [targets[k] for k in np.flatnonzero(~rows.reached).tolist()]
    return found[:count]


def make_ways(robot: ikde.Robot, targets: list[ikde.Target]) -> dict[str, Solve]:
    """Ways to answer target k: joint values, or None."""

    def by_ikde(k: int, method: str) -> Floats | None:
        result = ikde.solve(robot, targets[k], seed=SEED, stream=k, method=method)
        return result.q if result.reached else None

    return {
        "ikde.solve": lambda k: by_ikde(k, "auto"),
        "ikde.solve, lm": lambda k: by_ikde(k, "lm"),
    }


def time_ways(ways: dict[str, Solve], count: int, rounds: int) -> tuple[dict[str, Floats], dict[str, list]]:
    """Median of each target's microseconds over rounds, by way, and the answers."""
    rng, clock = np.random.default_rng(SEED), time.perf_counter
    spent = {name: np.empty((rounds, count)) for name in ways}
    answers: dict[str, list] = {name: [solve(k) for k in range(count)] for name, solve in ways.items()}
    names = list(ways)
    for turn in range(rounds):
        for place in rng.permutation(count * len(names)).tolist():
            name, k = names[place % len(names)], place // len(names)
            solve = ways[name]
            began = clock()
            solve(k)
            spent[name][turn, k] = (clock() - began) * 1e6
    return {name: np.median(times, axis=0) for name, times in spent.items()}, answers


def count_accepted(robot: ikde.Robot, targets: list[ikde.Target], answers: list[Floats | None]) -> int:
    """Answers that plain numpy accepts at ikde's default tolerances."""
    rows = [k for k, q in enumerate(answers) if q is not None]
    return sum(ikde.verify(robot, targets[k], answers[k], settings=SETTINGS).accepted for k in rows)


def time_bulk(robot: ikde.Robot, name: str, rounds: int) -> dict[str, float]:
    """Microseconds a target of `solve_many` by method, everything graded; medians of interleaved rounds."""
    targets = ikde.Targets.of(make_targets(robot, name, BULK if name == "ordinary" else BULK // 10))
    bulk, spent = ikde.BulkOptions(threads=1, explain=False), {method: [] for method in ("auto", "lm")}
    for turn in range(rounds + 1):
        for method, times in spent.items():
            began = time.perf_counter()
            ikde.solve_many(robot, targets, seed=SEED, method=method, bulk=bulk)
            times.append((time.perf_counter() - began) / len(targets) * 1e6 if turn else np.nan)
    return {method: float(np.nanmedian(times)) for method, times in spent.items()}


def spread(times: Floats) -> dict[str, float]:
    """Median, tails and mean."""
    p95, p99 = np.percentile(times, [95, 99])
    numbers = {"median": np.median(times), "p95": p95, "p99": p99, "max": times.max(), "mean": times.mean()}
    return {name: round(float(value), 2) for name, value in numbers.items()}


def show(records: list[dict], bulk: dict[str, dict[str, float]]) -> None:
    """Print the tables."""
    table = Table("poses", "way", "accepted", "us: median", "p95", "p99", "max", "mean")
    for r in records:
        figures = [f"{r[key]:.1f}" for key in ("median", "p95", "p99", "max", "mean")]
        table.add_row(r["set"], r["way"], f"{r['accepted']} of {r['targets']}", *figures)
    Console(width=120).print(table)
    for name, times in bulk.items():
        print(f"bulk, {name}: " + ", ".join(f"{method} {value:.2f} us" for method, value in times.items()))


if __name__ == "__main__":
    main()
