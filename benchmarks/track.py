"""The paper's tasks by the paper's two methods and by `continuation`: what is reached, broken and spent, over seeds.

    python benchmarks/track.py           # ten seeds, 100 random starts a task: some ten minutes on two cores
    python benchmarks/track.py --quick   # one seed, four starts, 100 samples; writes nothing

Runs: all methods begin where `continuation` begins. `continuation` and `optimized` drive the differential base; what
`typical` does is graded as omnidirectional, so sliding is not held against it. `verify_track` counts; times are wall
times of each sample on one core. Dead ends: from random free configurations at the first pose, `optimized` and the
greedy half of `continuation` (least motion, no choice of a start, no way back) go as far as they come. All cores are
used, but for `continuation`. Writes benchmarks/results/track.json.
"""

import argparse
import json
import time
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from machine import describe
from rich.console import Console
from rich.table import Table

import ikde
from ikde.io.track_file import load_track
from ikde.kernels.arrays import Floats
from ikde.kernels.frames import compute_bodies, compute_jacobian, compute_tool
from ikde.model.pack import pack_robot
from ikde.model.robot import Robot
from ikde.solver.search import usable_cores
from ikde.track.follow import Follower, make_follower
from ikde.track.limits import MotionLimits
from ikde.track.optimized import follow_optimized
from ikde.track.path import ToolPath
from ikde.track.plan import TrackPlan
from ikde.track.starts import EXACT
from ikde.track.track import base_joints, track
from ikde.track.trajectory import TrackStop, Trajectory

HERE = Path(__file__).parent
RESULTS = HERE / "results" / "track.json"
TRACKS = HERE.parent / "configs" / "tracks"
TASKS = ("task1", "task2", "task3", "task4")
DRIVES = {"continuation": "differential", "optimized": "differential", "typical": "omnidirectional"}
SEEDS, STARTS = 10, 100
QUICK_SEEDS, QUICK_STARTS, QUICK_SAMPLES = 1, 4, 100
LEAST_MOTION = np.zeros(3)


def main() -> None:
    """Run all, print a table, record."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="one seed, four starts, 100 samples; writes nothing")
    quick = parser.parse_args().quick
    seeds, starts = (QUICK_SEEDS, QUICK_STARTS) if quick else (SEEDS, STARTS)
    began, runs, dead_ends = time.perf_counter(), [], []
    for task in TASKS:
        plan = load_track(TRACKS / f"qiao2022_{task}.yaml")
        path = shorten(plan.path, QUICK_SAMPLES) if quick else plan.path
        for record in run_all(plan, path, seeds):
            runs.append({"task": task, **record})
            print(json.dumps(runs[-1]))
        dead_ends.append({"task": task, **count_dead_ends(plan, path, starts)})
        print(json.dumps({key: value for key, value in dead_ends[-1].items() if key != "reached_points"}))
        seconds = round(time.perf_counter() - began)
        if not quick:
            record = {"machine": describe(), "seconds": seconds, "runs": runs, "dead_ends": dead_ends}
            RESULTS.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    show(runs, dead_ends)


def shorten(path: ToolPath, samples: int) -> ToolPath:
    """The first samples of a path."""
    end = samples + 1
    return ToolPath(
        name=path.name,
        dt_s=path.dt_s,
        p_world_tool=path.p_world_tool[:end],
        orientation=path.orientation,
        R_world_tool=path.R_world_tool[:end],
        p_half=path.p_half[:samples],
        R_half=path.R_half[:samples],
    )


def run_all(plan: TrackPlan, path: ToolPath, seeds: int) -> Iterator[dict[str, Any]]:
    """Every method with every seed, from where `continuation` begins; the slow ones a seed a core."""
    start = track(plan.robot, path, detector=plan.detector).q[0]

    def run(method: str, seed: int) -> dict[str, Any]:
        given, drive = None if method == "continuation" else start, DRIVES[method]
        motion = track(plan.robot, path, drive=drive, method=method, start=given, seed=seed, detector=plan.detector)
        return {"method": method, "drive": drive, "seed": seed, **describe_motion(plan.robot, motion)}

    yield from (run("continuation", seed) for seed in range(seeds))
    with ThreadPoolExecutor(usable_cores()) as pool:
        for method in ("optimized", "typical"):
            yield from pool.map(partial(run, method), range(seeds))


def describe_motion(robot: Robot, motion: Trajectory) -> dict[str, Any]:
    """The figures of one motion."""
    limits, seconds = motion.limits, motion.seconds
    wrong = (np.abs(motion.error_m) > limits.position_error_m).any(axis=1)
    wrong |= motion.orientation_error_rad > limits.orientation_error_rad
    steps = np.abs(np.diff(motion.q, axis=0))
    broken = asdict(motion.breaches) if motion.breaches else {}
    return {
        "points": motion.path.samples,
        "reached_points": int((~wrong[1:]).sum()),
        "largest_axis_error_mm": 1e3 * float(np.abs(motion.error_m).max()),
        "largest_total_error_mm": 1e3 * float(np.linalg.norm(motion.error_m, axis=1).max()),
        "largest_rotation_error_rad": float(motion.orientation_error_rad.max()),
        "broken": broken,
        "limit_violations": sum(count for name, count in broken.items() if name not in ("error", "collision")),
        "colliding_samples": broken.get("collision", 0),
        "smallest_clearance_mm": 1e3 * float(motion.clearance_m.min()) if motion.clearance_m is not None else None,
        "certified_clearance_mm": None if motion.certified_clearance_m is None else 1e3 * motion.certified_clearance_m,
        "largest_jump_m": float(steps[:, robot.slides].max()),
        "largest_jump_rad": float(steps[:, ~robot.slides].max()),
        "smallest_singular_value": smallest_singular_value(robot, motion.q),
        "median_s": float(np.median(seconds)),
        "p99_s": float(np.quantile(seconds, 0.99)),
        "stop": motion.stop.text if motion.stop else None,
    }


def smallest_singular_value(robot: Robot, q: Floats) -> float:
    """Smallest of the arm's 6 x 6 Jacobian, m and rad as they are, at the samples `q` [M + 1, N]."""
    packed, arm = pack_robot(robot), ~np.isin(robot.joint_names, base_joints(robot))
    bodies, tool = np.empty((len(packed.bodies), 3, 4)), np.empty((3, 4))
    jacobian, least = np.empty((6, q.shape[1])), np.inf
    for row in q:
        compute_bodies(packed, row, bodies)
        compute_tool(packed, bodies, tool)
        compute_jacobian(packed, bodies, tool, jacobian)
        least = min(least, float(np.linalg.svd(jacobian[:, arm], compute_uv=False)[-1]))
    return least


def count_dead_ends(plan: TrackPlan, path: ToolPath, count: int) -> dict[str, Any]:
    """How far `optimized` and the greedy follower come from random starts at the first pose."""
    robot = plan.robot
    follower = make_follower(robot, path, drive="differential", limits=MotionLimits.of(robot), detector=plan.detector)
    starts, began = draw_random_starts(follower, count), time.perf_counter()
    with ThreadPoolExecutor(usable_cores()) as pool:
        evolved = list(pool.map(lambda seed: follow_optimized(follower, starts[seed], seed), range(count)))
    seconds, reached = time.perf_counter() - began, [len(one.q) - 1 for one in evolved]
    stops = Counter(tell_shortly(one.stop) for one in evolved if one.stop)
    greedy = [follower.follow(follower.begin(start, LEAST_MOTION)).last for start in starts]
    return {
        "starts": len(starts),
        "optimized": sum(points < path.samples for points in reached),
        "greedy": sum(points < path.samples for points in greedy),
        "optimized_stops": dict(stops.most_common()),
        "optimized_seconds": round(seconds, 1),
        "reached_points": {"optimized": reached, "greedy": greedy},
    }


def tell_shortly(stop: TrackStop) -> str:
    """The reason, and the pair or the limit that it names."""
    return f"{stop.reason.value} {'-'.join(stop.pair or (stop.limit or '',))}".strip()


def draw_random_starts(follower: Follower, count: int) -> Floats:
    """Configurations [count, N] at the path's first pose, free of collision, near which random ones came to rest."""
    robot, found = follower.robot, []
    rng, target = np.random.default_rng(2022), follower.path.targets()[0]
    settings = EXACT.with_changes(method="lm", restarts=1)
    while len(found) < count:
        near = rng.uniform(robot.lower, robot.upper)
        near[robot.slides] = target.p_world_tool[: robot.slides.sum()] + rng.uniform(-1.0, 1.0, robot.slides.sum())
        result = ikde.solve(robot, target, settings, near=near, detector=follower.detector or "none")
        if result.reached:
            found.append(result.q)
    return np.array(found)


def show(runs: list[dict[str, Any]], dead_ends: list[dict[str, Any]]) -> None:
    """One row for each task and method: worst over the seeds, times in the middle."""
    columns = (
        "task",
        "method",
        "all reached",
        "points",
        "error mm",
        "rad",
        "limits",
        "colliding",
        "jump m",
        "jump rad",
    )
    table = Table(*columns, "sigma", "clearance mm", "median ms", "p99 ms")
    for task, method in dict.fromkeys((run["task"], run["method"]) for run in runs):
        rows = [run for run in runs if (run["task"], run["method"]) == (task, method)]
        table.add_row(
            task,
            method,
            f"{sum(row['reached_points'] == row['points'] for row in rows)} of {len(rows)}",
            _span(rows, "reached_points"),
            f"{max(row['largest_axis_error_mm'] for row in rows):.2g}",
            f"{max(row['largest_rotation_error_rad'] for row in rows):.2g}",
            _span(rows, "limit_violations"),
            _span(rows, "colliding_samples"),
            f"{max(row['largest_jump_m'] for row in rows):.3g}",
            f"{max(row['largest_jump_rad'] for row in rows):.3g}",
            f"{min(row['smallest_singular_value'] for row in rows):.2g}",
            f"{min(row['smallest_clearance_mm'] for row in rows):.3g}",
            f"{1e3 * float(np.median([row['median_s'] for row in rows])):.3g}",
            f"{1e3 * max(row['p99_s'] for row in rows):.3g}",
        )
    Console(width=170).print(table)
    ends = Table("task", "random starts", "dead ends: optimized", "greedy", "why")
    for row in dead_ends:
        why = ", ".join(f"{count} {reason}" for reason, count in row["optimized_stops"].items())
        ends.add_row(row["task"], str(row["starts"]), str(row["optimized"]), str(row["greedy"]), why)
    Console(width=170).print(ends)


def _span(rows: list[dict[str, Any]], key: str) -> str:
    values = [row[key] for row in rows]
    return f"{min(values)}" if min(values) == max(values) else f"{min(values)} to {max(values)}"


if __name__ == "__main__":
    main()
