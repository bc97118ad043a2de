"""Nanoseconds a configuration on one core: forward kinematics, sphere centres, and the yes/no collision check.

    python benchmarks/kernel_times.py

Each figure is the median over rounds of a loop inside one compiled kernel over 20,000 uniform random configurations of
qiao2021 with the improved spheres; the stages are interleaved in every round. `free` and `colliding` configurations are
timed apart, because a free one has to be looked at whole. Writes benchmarks/results/kernel_times.json.
"""

import json
import time
from pathlib import Path

import numpy as np
from machine import describe
from rich.console import Console
from rich.table import Table

import ikde
from ikde.kernels.arrays import Floats
from ikde.kernels.clearance import collides, compute_clearance
from ikde.kernels.frames import compute_bodies
from ikde.kernels.jit import kernel
from ikde.kernels.spheres import compute_bounds, compute_centres
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot

CONFIGURATIONS, ROUNDS = 20_000, 25
STAGES = ("forward kinematics", "+ bounding spheres", "+ sphere centres", "+ yes/no check", "+ full clearance")
RESULTS = Path(__file__).parent / "results" / "kernel_times.json"


@kernel
def loop(robot, detector, qs, stage, T, bounds, centres):
    """Run the first stages for every row of `qs` [n, N]; returns how many collide."""
    count = 0
    for i in range(qs.shape[0]):
        compute_bodies(robot, qs[i], T)
        if stage > 0:
            compute_bounds(detector, T, bounds)
        if stage > 1:
            compute_centres(detector, T, centres)
        if stage > 2:
            count += collides(detector, bounds, centres)
        if stage > 3:
            clearance, _ = compute_clearance(detector, bounds, centres)
            count += clearance > 1e9
    return count


def main() -> None:
    """Time every stage on every set of configurations, print and record."""
    robot = ikde.load_robot("qiao2021")
    arrays, detector = pack_robot(robot), CollisionModel.of(robot, "improved").arrays
    buffers = (
        np.empty((len(robot.joints) + 1, 3, 4)),
        np.empty((detector.components.shape[0], 3)),
        np.empty((3, detector.radius.size)),
    )
    qs = np.random.default_rng(1).uniform(robot.lower, robot.upper, (CONFIGURATIONS, len(robot.joints)))
    hits = np.array([loop(arrays, detector, qs[i : i + 1], 3, *buffers) for i in range(len(qs))], dtype=bool)
    sets: dict[str, Floats] = {"all": qs, "free": qs[~hits].copy(), "colliding": qs[hits].copy()}
    times = {name: np.empty((ROUNDS, len(STAGES))) for name in sets}
    for round_ in range(ROUNDS):
        for name, rows in sets.items():
            for stage in range(len(STAGES)):
                begin = time.perf_counter()
                loop(arrays, detector, rows, stage, *buffers)
                times[name][round_, stage] = (time.perf_counter() - begin) / len(rows) * 1e9
    table = Table("ns a configuration, median [p95]", *(f"{name} ({len(rows)})" for name, rows in sets.items()))
    for stage, label in enumerate(STAGES):
        cells = (times[name][:, stage] for name in sets)
        table.add_row(label, *(f"{np.median(t):.0f} [{np.percentile(t, 95):.0f}]" for t in cells))
    Console().print(table)
    record = {
        name: {
            stage: {"median": float(np.median(column)), "p95": float(np.percentile(column, 95))}
            for stage, column in zip(STAGES, t.T, strict=True)
        }
        for name, t in times.items()
    }
    RESULTS.write_text(json.dumps({"machine": describe(), "ns": record}, indent=1))


if __name__ == "__main__":
    main()
