"""A track beside a shelf that a camera sees as a million points: what following, judging and certifying it take.

    python benchmarks/cloud_track.py              # 10^4, 10^5 and 10^6 points: a minute
    python benchmarks/cloud_track.py --points 10000000

The surfaces of a room with a shelf are sampled, each point a ball of 2.5 mm. The robot follows 500 points among them
once; then the parts of that are timed by themselves, the first time with all that is made of the cloud. Times are those
of the processor, as on a machine that does nothing else. Writes benchmarks/results/cloud_track.json.
"""

import argparse
import json
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from machine import describe
from rich.console import Console
from rich.table import Table

import ikde
from ikde.model.collision_model import CollisionModel
from ikde.model.solids import make_solid
from ikde.model.world import make_obstacle, make_world
from ikde.solver import plain_cloud
from ikde.track.certify import certify
from ikde.track.verify_track import verify_track

RESULTS = Path(__file__).parent / "results" / "cloud_track.json"
SAMPLES, DT_S, RADIUS_M, MARGIN_M = 500, 0.02, 0.0025, 0.005
BOXES = (  # middle and whole edges, m: floor, walls, and a shelf with two boards
    ((0.0, 0.0, -0.2), (6.0, 6.0, 0.02)),
    ((3.0, 0.0, 1.2), (0.02, 6.0, 2.8)),
    ((0.0, 3.0, 1.2), (6.0, 0.02, 2.8)),
    ((1.2, 0.3, 0.75), (0.5, 2.0, 0.02)),
    ((1.2, 0.3, 1.25), (0.5, 2.0, 0.02)),
    ((1.46, 0.3, 1.0), (0.02, 2.0, 1.6)),
)


def scan_room(count: int, rng: np.random.Generator) -> np.ndarray:
    """Points [K, 3] on the surfaces, m, spread by area."""
    edges = np.array([size for _, size in BOXES])
    areas = np.array([[y * z, x * z, x * y] for x, y, z in edges])
    face = rng.choice(areas.size, count, p=areas.ravel() / areas.sum())
    box, axis = face // 3, face % 3
    share = rng.uniform(-0.5, 0.5, (count, 3))
    share[np.arange(count), axis] = rng.choice([-0.5, 0.5], count)
    return np.array([middle for middle, _ in BOXES])[box] + share * edges[box]


def make_path() -> ikde.ToolPath:
    """Into the shelf and along it, 500 samples of 20 ms."""
    k = np.linspace(0.0, 1.0, SAMPLES + 1)
    points = np.column_stack([1.0 + 0.05 * np.sin(6.0 * k), -0.3 + 1.2 * k, 1.0 + 0.17 * np.sin(12.0 * k)])
    return ikde.ToolPath.through(points, dt_s=DT_S)


def measure(what: Callable[[], Any]) -> tuple[Any, float]:
    """What it gives, and its seconds of the processor."""
    began = time.process_time()
    return what(), time.process_time() - began


def run(count: int) -> dict[str, Any]:
    """One cloud: a row of the table."""
    points = scan_room(count, np.random.default_rng(0))
    solid, made_s = measure(lambda: make_solid("cloud", (RADIUS_M,), points=points))
    world = make_world([make_obstacle("room", [solid])])
    model, packed_s = measure(lambda: CollisionModel.of("qiao2021").in_world(world, MARGIN_M))
    path = make_path()
    motion, followed_s = measure(lambda: ikde.follow_path("qiao2021", path, collision=model))
    assert motion.stop is None, motion.stop.line
    plain_cloud._KNOWN.clear()
    proof, certified_s = measure(lambda: certify(model, motion.q, motion.drive))
    _, again_s = measure(lambda: certify(model, motion.q, motion.drive))
    grade = {"drive": motion.drive, "limits": motion.limits}
    judged, judged_s = measure(lambda: verify_track(model, path, motion.q, **grade))
    assert proof is not None
    assert judged.accepted
    return {
        "points": count,
        "cloud_s": made_s,
        "packed_s": packed_s,
        "followed_s": followed_s,
        "certified_s": certified_s,
        "certified_again_s": again_s,
        "judged_s": judged_s,
        "clearance_mm": 1e3 * float(judged.clearance_m or 0.0),
        "certified_mm": 1e3 * proof.clearance_m,
        "room_mm": 1e3 * float(proof.room_m.min()),
    }


def main() -> None:
    """Run all, print a table, record."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--points", type=int, nargs="+", help="so many alone; writes nothing")
    options = parser.parse_args()
    ikde.follow_path("qiao2021", make_path())  # compiles
    rows = [run(count) for count in options.points or (10_000, 100_000, 1_000_000)]
    table = Table(*rows[0])
    for row in rows:
        table.add_row(*(f"{value:,}" if isinstance(value, int) else f"{value:.3f}" for value in row.values()))
    Console(width=150).print(table)
    if not options.points:
        RESULTS.write_text(json.dumps({"machine": describe(), "rows": rows}, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
