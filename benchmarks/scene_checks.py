"""The check of a configuration among obstacles, free or not: ikde's beside that of Pinocchio with coal.

    .venv-peers/bin/python -m benchmarks.scene_checks FOLDER ... [--every 20] [--rounds 5] [--out FILE]

Folders as for `benchmarks/scenes.py`. In each scene the same configurations for all: free ones, which have to be looked
at whole, and uniform random ones of which many collide. All compare the same pairs of spheres, and the spheres of what
joints move with the same solids; all verdicts must be equal. The ways take turns, round by round; a scene's figure is
the median of its rounds, and the table's the median over the scenes. Times are a configuration's share of a loop
over all, of a processor, so neighbours on a busy machine do not count; the loop stands in compiled code where a row
says kernel, else in Python.
"""

import argparse
import json
import sys
import tempfile
import time
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numba
import numpy as np

sys.path.insert(0, str(Path(__file__).parent / "peers"))

import pinocchio as pin
from world_checkers import CoalChecker, make_solids_world

import ikde
from benchmarks.machine import describe
from benchmarks.scene_peers import read_problem
from benchmarks.scenes import read_robot
from ikde.io.scene_pairs import find_pairs
from ikde.kernels.world import find_obstacle_of
from ikde.model.collision_model import CollisionModel
from ikde.model.generate.module import load_module
from ikde.solver.metrics import compute_metrics
from ikde.solver.problem import pack_searched

RESULTS = Path(__file__).parent / "results" / "scene_checks.json"
COUNT, SEED, WARM = 128, 5, 2
Ways = dict[str, Callable[[np.ndarray], np.ndarray]]
"""Configurations [K, N] to whether each is free [K]."""
KERNEL, OWN, LANES, MANY, ONE = (
    "ikde, kernel",
    "ikde, kernel, robot alone",
    "ikde, kernel in lanes, all distances",
    "ikde.check_many",
    "ikde.check",
)
TREE, TREES, ALL = "Pinocchio + coal, broad phase", "Pinocchio + coal, a tree a body", "Pinocchio + coal, pair by pair"
SLOW = {MANY: 1, ONE: 8, TREES: 2, ALL: 2}  # each so manieth configuration


def make_loops(robot: ikde.Robot) -> tuple[Any, Any]:
    """Compiled loops over configurations: of the robot alone, and in a world, as the search asks."""
    module = load_module(CollisionModel.of(robot), "pose")
    find, make_buffers = module.find_collision, module.make_buffers

    @numba.njit(error_model="numpy")
    def loop_own(robot, collision, rows, out):
        buffers = make_buffers(robot, collision, rows.shape[1])
        for k in range(rows.shape[0]):
            out[k] = find(robot, collision, rows[k], buffers) < 0

    @numba.njit(error_model="numpy")
    def loop(robot, collision, rows, out):
        buffers = make_buffers(robot, collision, rows.shape[1])
        for k in range(rows.shape[0]):
            is_free = find(robot, collision, rows[k], buffers) < 0
            out[k] = is_free and find_obstacle_of(robot, collision, rows[k]) < 0

    return loop_own, loop


def list_ways(robot: ikde.Robot, model: CollisionModel, coal: CoalChecker, loops: tuple[Any, Any]) -> Ways:
    """All in one world."""
    models, own_models, limit_m = pack_searched(model), pack_searched(model.own), model.limit_m
    targets = [ikde.Target((0.0, 0.0, 0.0))] * COUNT
    trees = pin.TreeBroadPhaseManager_DynamicAABBTreeCollisionManager(coal.model, coal.geometry, coal.geometry_data)

    def run(loop: Any, arrays: tuple[Any, ...]) -> Callable[[np.ndarray], np.ndarray]:
        def ask(rows: np.ndarray) -> np.ndarray:
            free = np.empty(len(rows), dtype=bool)
            loop(*arrays, rows, free)
            return free

        return ask

    def each(is_free: Callable[[np.ndarray], bool]) -> Callable[[np.ndarray], np.ndarray]:
        return lambda rows: np.array([is_free(q) for q in rows])

    def collide(*arguments: Any) -> Callable[[np.ndarray], bool]:
        compute = pin.computeCollisions
        return lambda q: not compute(coal.model, coal.data, *arguments, q, True)

    return {
        KERNEL: run(loops[1], models),
        OWN: run(loops[0], own_models),
        LANES: lambda rows: compute_metrics(model, targets[: len(rows)], rows).clearance_m > limit_m,
        MANY: lambda rows: ~ikde.check_many(robot, rows, model).collision.data,
        ONE: each(lambda q: not ikde.check(robot, q, model).collision),
        TREE: each(collide(coal.manager)),
        TREES: each(collide(trees)),
        ALL: each(collide(coal.geometry, coal.geometry_data)),
    }


def run_robot(folder: Path, every: int, rounds: int) -> tuple[str, dict[str, Any]]:
    """Its name, and microseconds a configuration by way."""
    name, robot, twin = read_robot(folder)
    own, random, loops = CollisionModel.of(robot), np.random.default_rng(SEED), make_loops(robot)
    with tempfile.TemporaryDirectory() as files:
        urdf = Path(files) / "robot.urdf"
        urdf.write_text(ikde.format_urdf(robot))
        coal = CoalChecker(robot, urdf, SEED)
    spent: dict[str, dict[str, list[float]]] = {"free": {}, "any": {}}
    counts = {"scenes": 0, "configurations": 0, "verdicts_compared": 0, "differ": 0, "free": 0}
    pairs = [pair for pairs in find_pairs(folder).values() for pair in pairs][::every]
    for number, pair in enumerate(pairs[:WARM] + pairs):
        problem = read_problem(pair, robot, twin)
        coal.load(problem.solids)
        model = own.in_world(make_solids_world(problem.solids))
        ways = list_ways(robot, model, coal, loops)
        drawn = random.uniform(*robot.drawn, (40 * COUNT, len(robot.joints)))
        is_free = ways[KERNEL](drawn)
        sets = {"free": drawn[is_free][:COUNT].copy(), "any": drawn[:COUNT].copy()}
        compare(ways, drawn[:COUNT], counts)
        counts["free"] += int(is_free[:COUNT].sum())
        counts["scenes"] += 1
        if number < WARM:
            counts = dict.fromkeys(counts, 0)
        for key, rows in sets.items():
            if len(rows) >= COUNT // 4 and number >= WARM:
                for way, us in time_ways(ways, rows, rounds, random).items():
                    spent[key].setdefault(way, []).append(us)
    table = {key: {way: summarise(values) for way, values in found.items()} for key, found in spent.items()}
    return name, {**counts, "spheres": len(own.spheres), "pairs": len(own.pairs), "us": table}


def compare(ways: Ways, rows: np.ndarray, counts: dict[str, int]) -> None:
    """Counts verdicts that are not the kernel's."""
    ours = ways[KERNEL](rows)
    counts["configurations"] += len(rows)
    for way, ask in ways.items():
        if way != OWN:
            part = slice(None, None, SLOW.get(way, 1))
            counts["verdicts_compared"] += len(ours[part])
            counts["differ"] += int((ask(rows[part]) != ours[part]).sum())


def time_ways(ways: Ways, rows: np.ndarray, rounds: int, random: np.random.Generator) -> dict[str, float]:
    """Microseconds a configuration, the median of rounds."""
    spent: dict[str, list[float]] = {way: [] for way in ways}
    for _ in range(rounds):
        for k in random.permutation(len(ways)):
            way, ask = list(ways.items())[k]
            part = rows[:: SLOW.get(way, 1)]
            started = time.process_time()
            ask(part)
            spent[way].append(1e6 * (time.process_time() - started) / len(part))
    return {way: float(np.median(values)) for way, values in spent.items()}


def summarise(values: list[float]) -> dict[str, float]:
    """Least, median and largest over the scenes, three digits."""
    marks = {"least": np.min(values), "median": np.median(values), "largest": np.max(values)}
    return {name: float(f"{value:.3g}") for name, value in marks.items()}


def main() -> None:
    """Reads the options, measures, prints and writes."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--every", type=int, default=20, help="each so manieth problem; default 20")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--out", type=Path, default=RESULTS)
    options = parser.parse_args()
    record: dict[str, Any] = {
        "machine": describe(),
        "versions": {name: version(name) for name in ("pin", "coal")},
        "robots": {},
    }
    differ = 0
    for folder in options.folders:
        name, found = run_robot(folder, options.every, options.rounds)
        record["robots"][name], differ = found, differ + found["differ"]
        print(name, {key: value for key, value in found.items() if key != "us"})
        for key, rows in found["us"].items():
            for way, marks in rows.items():
                ratio = marks["median"] / rows[KERNEL]["median"]
                figures = " / ".join(f"{value:g}" for value in marks.values())
                print(f"  {key:5} {way:40} us {figures} x{ratio:.3g}")
        options.out.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    sys.exit(differ > 0)


if __name__ == "__main__":
    main()
