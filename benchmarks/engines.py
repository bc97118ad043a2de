"""What the engines do: reached of all, graded; microseconds a target one by one and in bulk, on four robots.

    python benchmarks/engines.py [--quick]

Ordinary targets are tool poses of random collision-free configurations; hard ones are low ones of which at least nine
answers in ten collide (benchmarks/peers/cases.py). Four times are taken, all on one core: inside the kernel (a clock
inside compiled code around each target), `ikde.solve` in a Python loop with its result object and grade, `solve_many`
with everything graded, and `solve_many` at 1e-6 m and 1e-6 rad. Writes benchmarks/results/engines.json.
"""

import argparse
import ctypes
import json
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba
import numpy as np
from machine import describe
from rich.console import Console
from rich.table import Table

import ikde
from ikde.batch.generators import ReachableSource
from ikde.kernels.arrays import COUNTS
from ikde.kernels.flat_arguments import flatten_search
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_targets
from ikde.solver.engines.engine import make_descent, make_ranges
from ikde.solver.engines.pool import load_kernels, make_seeds
from ikde.solver.metrics import compute_metrics
from ikde.solver.problem import make_problem, pack_searched
from ikde.solver.settings import BulkOptions

sys.path.insert(0, str(Path(__file__).parent / "peers"))
from cases import make_case

HERE = Path(__file__).parent
RESULTS = HERE / "results" / "engines.json"
ROBOTS = {name: name for name in ("qiao2021", "ur5", "panda")} | {"chain15": HERE / "robots" / "chain15.yaml"}
ROUNDS = 5
TIGHT = {"1e-6 m, 1e-6 rad": (1e-6, 1e-6), "1e-9 m, 1e-9 rad": (1e-9, 1e-9)}
SEED = 7


def main() -> None:
    """Run every set, print and record."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="300 targets a set, one round")
    quick = parser.parse_args().quick
    count, rounds = (300, 1) if quick else (10_000, ROUNDS)
    records = []
    for name, where in ROBOTS.items():
        robot = ikde.load_robot(where)
        for hard in (False, True) if name == "qiao2021" else (False,):
            for kind in ("pose", "position"):
                targets = make_targets(robot, kind, hard, count)
                record = {"robot": name, "kind": kind, "hard": hard, **measure(robot, targets, kind, rounds)}
                records.append(record)
                print(json.dumps(record))
    show(records)
    if not quick:
        RESULTS.write_text(json.dumps({"machine": describe(), "rounds": rounds, "sets": records}, indent=1) + "\n")


def make_targets(robot: ikde.Robot, kind: str, hard: bool, count: int) -> ikde.Targets:
    """A set of targets, each with at least one answer."""
    if hard:
        case = make_case(f"hard {kind}", count)
        return ikde.Targets(case.p, R_world_tool=case.R if kind == "pose" else None)
    options = {"lower": robot.lower, "upper": robot.upper, "goal": kind, "count": count, "seed": SEED}
    return ReachableSource(collision=CollisionModel.of(robot), **options).read(0, count)


def measure(robot: ikde.Robot, targets: ikde.Targets, kind: str, rounds: int) -> dict[str, Any]:
    """All figures of one set."""
    settings = ikde.SolveSettings.for_method("auto")
    record: dict[str, Any] = {"targets": len(targets)}
    rows = ikde.solve_many(robot, targets, seed=SEED, bulk=BulkOptions(threads=1, explain=False))
    record["reached"] = int(rows.reached.sum())
    record["attempts_max"] = int(rows.attempts.max())
    record["engines"] = {ikde_name: int((rows.engines == k).sum()) for k, ikde_name in enumerate(engine_names())}
    record["bulk_us"] = time_bulk(robot, targets, settings, rounds)
    for name, (position, orientation) in TIGHT.items():
        tight = settings.with_changes(position_tolerance_m=position, orientation_tolerance_rad=orientation)
        rows = ikde.solve_many(robot, targets, tight, seed=SEED, bulk=BulkOptions(threads=1, explain=False))
        record[name] = {"reached": int(rows.reached.sum()), "bulk_us": time_bulk(robot, targets, tight, rounds)}
    record["python_us"] = spread(time_python(robot, list(targets)[: min(len(targets), 3000)], rounds))
    record["kernel_us"] = spread(time_kernel(robot, targets, kind, rounds))
    record["grader_us"] = time_grader(robot, targets, rows.q, rounds)
    return record


def engine_names() -> tuple[str, ...]:
    """In the order of `SolveResults.engines`."""
    from ikde.solver.engine_table import NAMES

    return NAMES


def time_bulk(robot: ikde.Robot, targets: ikde.Targets, settings: ikde.SolveSettings, rounds: int) -> float:
    """Microseconds a target of `solve_many` on one thread, everything graded by the fast grader; median of rounds."""
    times = []
    for _ in range(rounds):
        began = time.perf_counter()
        ikde.solve_many(robot, targets, settings, seed=SEED, bulk=BulkOptions(threads=1, explain=False, verify="none"))
        times.append((time.perf_counter() - began) / len(targets) * 1e6)
    return float(np.median(times))


def time_python(robot: ikde.Robot, targets: list[ikde.Target], rounds: int) -> np.ndarray:
    """Microseconds of each `ikde.solve`: for each target the median of rounds."""
    times = np.empty((rounds, len(targets)))
    for row in times:
        for k, target in enumerate(targets):
            began = time.perf_counter()
            ikde.solve(robot, target, seed=SEED, stream=k)
            row[k] = (time.perf_counter() - began) * 1e6
    return np.median(times, axis=0)


def time_kernel(robot: ikde.Robot, targets: ikde.Targets, kind: str, rounds: int) -> np.ndarray:
    """Microseconds of the engine `lm` inside compiled code: for each target the median of rounds."""
    problem = make_problem(robot, ikde.SolveSettings(method="lm"), collision=None, near=None, freeze=None)
    run = make_loop(load_kernels(problem.collision, kind).solve_target)
    search = (make_ranges(problem), make_descent(problem, kind), make_seeds(problem, kind))
    block = flatten_search(*pack_searched(problem.collision), *search)
    pairs = max(len(problem.collision.pairs), 1)
    times = np.empty((rounds, len(targets)))
    with np.errstate(over="ignore"):
        run(*pack_targets(targets[:2]), *block, np.uint64(SEED), pairs, np.empty(2))
        for row in times:
            run(*pack_targets(targets), *block, np.uint64(SEED), pairs, row)
    return np.median(times, axis=0)


def time_grader(robot: ikde.Robot, targets: ikde.Targets, q: np.ndarray, rounds: int) -> float:
    """Microseconds a configuration that the grader takes in bulk; median of rounds."""
    detector, settings, times = CollisionModel.of(robot).detector, ikde.SolveSettings(), []
    for _ in range(rounds):
        began = time.perf_counter()
        compute_metrics(CollisionModel(robot=robot, detector=detector), targets, q, settings)
        times.append((time.perf_counter() - began) / len(q) * 1e6)
    return float(np.median(times))


def make_loop(solve_target: Any) -> Callable[..., None]:
    """A compiled loop over targets with a clock around each."""
    clock = ctypes.CDLL(None).clock_gettime
    clock.argtypes, clock.restype = (ctypes.c_int, ctypes.c_void_p), ctypes.c_int

    @numba.njit
    def run(kinds, T, numbers, whole, pool, pool_T, seed, pairs, out_us):
        now, q, score = np.zeros(4, dtype=np.int64), np.empty(pool.shape[1]), np.empty(2)
        counts, blocked = np.empty(COUNTS, dtype=np.int64), np.empty(pairs, dtype=np.int64)
        for k in range(out_us.size):
            score[:], counts[:] = np.inf, 0
            clock(1, now.ctypes.data)
            before = now[0] * 1e6 + now[1] * 1e-3
            question = (numbers, whole, pool, pool_T, kinds, T, k)
            solve_target(*question, seed, k, 0, 1000, q, score, counts, blocked)
            clock(1, now.ctypes.data)
            out_us[k] = now[0] * 1e6 + now[1] * 1e-3 - before

    return run


def spread(times: np.ndarray) -> dict[str, float]:
    """Median and tails."""
    p95, p99 = np.percentile(times, [95, 99])
    return {"median": float(np.median(times)), "p95": float(p95), "p99": float(p99), "max": float(times.max())}


def show(records: list[dict[str, Any]]) -> None:
    """Print the table."""
    table = Table("set", "reached", "at 1e-9", "kernel us med / p95 / p99 / max", "Python us", "bulk us", "bulk 1e-6")
    for r in records:
        cells = [
            " / ".join(f"{r[key][k]:.3g}" for k in ("median", "p95", "p99", "max"))
            for key in ("kernel_us", "python_us")
        ]
        tight = [r[name] for name in TIGHT]
        table.add_row(
            f"{r['robot']} {'hard ' if r['hard'] else ''}{r['kind']}",
            f"{r['reached']} of {r['targets']}",
            str(tight[1]["reached"]),
            *cells,
            f"{r['bulk_us']:.2f}",
            f"{tight[0]['bulk_us']:.2f}",
        )
    Console(width=180).print(table)


if __name__ == "__main__":
    main()
