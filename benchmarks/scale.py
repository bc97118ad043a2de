"""What a robot costs before its first answer, by its spheres and joints: writing its kernels, and compiling them.

    python benchmarks/scale.py [name ...]

Each robot in a process of its own, after a small robot has compiled or loaded what all share: seconds of the processor
to write the module of one kind of target, until one target is solved (compiling, and drawing the pool of seeds) and
until many are; then nanoseconds of a collision check, microseconds of a solve and of a target in bulk. Names as in
`make`; `, one by one` and `, in tables` say how the check is written, `, no spheres` is without a detector. Writes
benchmarks/results/scale.json.
"""

import json
import subprocess
import sys
import tempfile
import time
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from machine import describe
from make_chain import format_chain
from numba import njit
from rich.console import Console
from rich.table import Table

import ikde
from ikde.kernels import cache_folder
from ikde.model.collision_model import CollisionModel
from ikde.model.generate import assemble
from ikde.model.generate.module import load_module
from ikde.model.robot import NO_DETECTOR, FreeSpheres, Robot
from ikde.solver.engines.pool import load_kernels
from ikde.solver.plain import compute_frames
from ikde.solver.problem import pack_searched
from ikde.solver.settings import BulkOptions

KIND = "pose"
CHECKS, TARGETS, SINGLE, ROUNDS = 20_000, 2_000, 500, 5
RESULTS = Path(__file__).parent / "results" / "scale.json"


def load_chain(joints: int) -> Robot:
    """A chain with a row of three spheres a link."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "chain.yaml"
        path.write_text(format_chain(joints), encoding="utf-8")
        return ikde.load_robot(path)


def scatter(robot: Robot, count: int) -> Robot:
    """The robot with free spheres in place of its rows, as an import has them."""
    spheres = robot.detectors[robot.default_detector].spheres
    rows, rng, T = robot.approximations[spheres], np.random.default_rng(0), compute_frames(robot, robot.home)
    free: dict[tuple[str, str], list[tuple[float, float, float, float]]] = {}
    for k in range(count):
        row = rows[k * len(rows) // count]  # those of one component together
        start, end = T[row.start], T[row.end]
        p_world = start[:3, 3] + rng.random() * (end - start)[:3, 3] + rng.normal(size=3) * 0.25 * row.radius_m
        p = start[:3, :3].T @ (p_world - start[:3, 3])
        radius = row.radius_m * (0.5 + 0.3 * rng.random())
        free.setdefault((row.component, row.start), []).append((float(p[0]), float(p[1]), float(p[2]), radius))
    entries = tuple(FreeSpheres(component=c, frame=f, spheres=tuple(own)) for (c, f), own in free.items())
    return replace(robot, approximations={spheres: entries})


def make(name: str) -> Robot:
    """The robot of a name: `panda`, `chain10`, `panda 56` or `chain10 200` with single spheres."""
    base, *count = name.split()
    robot = load_chain(int(base[5:])) if base.startswith("chain") else ikde.load_robot(base)
    return scatter(robot, int(count[0])) if count else robot


BARE, WAYS = ", no spheres", {", one by one": 10**9, ", in tables": -1}
NAMES = (
    "chain10 200",
    *(f"chain30{spheres}" for spheres in ("", BARE)),
    *(name + way for name in ("panda", "panda 28", "panda 40") for way in WAYS),
    "panda 56",
    "panda 200",
    *("chain15" + way for way in WAYS),
    "qiao2021",
)


def measure(name: str) -> dict[str, Any]:
    """All figures of one robot. Once a small robot has loaded what all share, the cache of the disk is left alone."""
    small = ikde.load_robot("ur5")
    compile_both(CollisionModel.of(small))
    cache_folder.CACHE_IS_WRITABLE = False
    for way, most in WAYS.items():
        if name.endswith(way):
            name, assemble.MAX_TESTS = name.removesuffix(way), most
    collision = CollisionModel.of(make(name.removesuffix(BARE)), NO_DETECTOR if name.endswith(BARE) else None)
    started = time.process_time()
    module = load_module(collision, KIND)
    record: dict[str, Any] = {"write_s": time.process_time() - started}
    record |= compile_both(collision)
    record["all_s"] = record["write_s"] + record["one_s"] + record["many_s"]
    record["text_kb"] = len(assemble.format_module(collision, KIND)) / 1e3
    record["left_out"] = " ".join(str(module.__doc__).split("\n\n")[1].split())
    record |= time_solves(collision)
    return {key: round(value, 2) if isinstance(value, float) else value for key, value in record.items()}


def compile_both(collision: CollisionModel) -> dict[str, float]:
    """Seconds of the processor until one target is solved and until many are; compiling is most of it."""
    robot = collision.robot
    T = compute_frames(robot, robot.home)[robot.tool]
    target, seconds = ikde.Target(T[:3, 3], R_world_tool=T[:3, :3]), {}
    many = partial(ikde.solve_many, robot, [target] * 5, collision=collision, bulk=BulkOptions(explain=False))
    for way, call in (("one", partial(ikde.solve, robot, target, collision=collision)), ("many", many)):
        started = time.process_time()
        call()
        seconds[f"{way}_s"] = time.process_time() - started
    return seconds


def time_solves(collision: CollisionModel) -> dict[str, float]:
    """Microseconds of a check of random configurations, and of poses that free ones reach: alone and in bulk."""
    robot, module, (tree, told) = collision.robot, load_kernels(collision, KIND), pack_searched(collision)
    buffers = module.make_buffers(tree, told, len(robot.joints))
    Q = np.random.default_rng(1).uniform(robot.lower, robot.upper, (CHECKS, len(robot.joints)))
    free = np.array([module.find_collision(tree, told, q, buffers) < 0 for q in Q])
    sets = {"check": Q, "check_free": Q[free]}
    record: dict[str, float] = {"free_share": float(free.mean())}
    for _ in range(ROUNDS):
        for label, rows in sets.items():
            started = time.process_time()
            sweep(module.find_collision, tree, told, rows, buffers)
            keep_least(record, f"{label}_ns", (time.process_time() - started) / max(len(rows), 1) * 1e9)
    T = compute_frames(robot, Q[free][:TARGETS])[robot.tool]
    targets = [ikde.Target(t[:3, 3], R_world_tool=t[:3, :3]) for t in T]
    results = ikde.solve_many(robot, targets, collision=collision, bulk=BulkOptions(threads=1))
    for _ in range(ROUNDS):
        started = time.process_time()
        ikde.solve_many(robot, targets, collision=collision, bulk=BulkOptions(threads=1))
        keep_least(record, "bulk_us", (time.process_time() - started) / len(targets) * 1e6)
        started = time.process_time()
        for target in targets[:SINGLE]:
            ikde.solve(robot, target, collision=collision)
        keep_least(record, "single_us", (time.process_time() - started) / SINGLE * 1e6)
    return record | {"targets": len(targets), "reached": int(results.reached.sum())}


@njit
def sweep(find_collision: Any, robot: Any, detector: Any, rows: Any, buffers: Any) -> int:
    """Check every row."""
    found = 0
    for k in range(rows.shape[0]):
        found += find_collision(robot, detector, rows[k], buffers) >= 0
    return found


def keep_least(record: dict[str, float], key: str, value: float) -> None:
    """The machine's clock swings: the least of the rounds counts."""
    record[key] = min(record.get(key, np.inf), value)


def main() -> None:
    """Measure every robot in a process of its own, print, record."""
    names = sys.argv[2:] or NAMES
    if sys.argv[1:2] == ["--one"]:
        print(json.dumps(measure(names[0])))
        return
    table = Table("robot", "write s", "one s", "many s", "all s", "check ns", "free", "bulk us", "one us", "text kB")
    record = {}
    for name in sys.argv[1:] or NAMES:
        done = subprocess.run([sys.executable, __file__, "--one", name], capture_output=True, text=True, check=True)
        record[name] = r = json.loads(done.stdout.splitlines()[-1])
        columns = (
            "write_s",
            "one_s",
            "many_s",
            "all_s",
            "check_ns",
            "check_free_ns",
            "bulk_us",
            "single_us",
            "text_kb",
        )
        table.add_row(name, *(f"{r[column]:.4g}" for column in columns))
        print(name, r, flush=True)
    Console(width=150).print(table)
    RESULTS.write_text(json.dumps({"machine": describe(), "kind": KIND, "robots": record}, indent=1))


if __name__ == "__main__":
    main()
