"""A mobile arm among shelves: paths into bays solved, followed, certified, and the certificate beside dense samples.

    python benchmarks/shelves.py                           # 100 scenes, qiao2021 and ur5 on a cart: ten minutes
    python benchmarks/shelves.py --robots my_robot.yaml --scenes 20

Each scene is drawn from its seed: two rows of shelves, an aisle between them, boards, sides and backs, cans and cartons
on the boards. The tool moves along a bay, 100 points of 20 ms, and everything keeps 5 mm of all that. What is followed
is sampled a hundred times as densely: joints linearly, the base on its arc by a formula of its own, distances to boxes
and cylinders by formulas of their own. No segment may show less than its certificate. Where a path ends early, what
its hint says helped is counted. Writes benchmarks/results/shelves.json.
"""

import argparse
import json
import time
from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray

import ikde
from ikde.model.collision_model import CollisionModel
from ikde.solver.plain import compute_components, compute_gaps

Floats = NDArray[np.float64]
HERE = Path(__file__).parent
RESULTS = HERE / "results" / "shelves.json"
MARGIN_M, SAMPLES, DT_S, DENSE = 0.005, 100, 0.02, 100
CART = """
name: cart
joints:
  x: {kind: prismatic, lower: -5, upper: 5}
  y: {kind: prismatic, lower: -5, upper: 5}
  yaw: {kind: revolute, lower: -3.14159, upper: 3.14159}
frames:
  along: {parent: world, joint: x, axis: [1, 0, 0]}
  across: {parent: along, joint: y, axis: [0, 1, 0]}
  body: {parent: across, joint: yaw, axis: [0, 0, 1]}
  top: {parent: body, xyz: [0, 0, 0.5]}
tool: top
spheres: {box: [{component: body, frame: body, spheres: [[0.18, 0, 0.25, 0.24], [-0.18, 0, 0.25, 0.24]]}]}
wheels: {radius: 0.1, half_track: 0.25}
"""


def make_cart(arm: str = "ur5") -> ikde.Robot:
    """An arm on a cart with two driven wheels."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "cart.yaml"
        path.write_text(CART, encoding="utf-8")
        T = np.eye(4)
        T[:3, 3] = 0.15, 0.0, 0.0
        return ikde.compose(ikde.load_robot(path), ikde.load_robot(arm), T)


def draw_scene(seed: int) -> tuple[dict[str, Any], Floats]:
    """Obstacles as a world file has them, and points of the tool [SAMPLES + 1, 3], m."""
    rng = np.random.default_rng([18, seed])
    front, aisle = rng.uniform(0.7, 0.9), rng.uniform(1.9, 2.4)
    obstacles: dict[str, Any] = {}
    heights = _add_shelf(obstacles, "a", front, 1.0, rng)
    _add_shelf(obstacles, "b", front - aisle, -1.0, rng)
    bay = int(rng.integers(len(heights) - 1))
    low, high = heights[bay], heights[bay + 1]
    along, k = rng.uniform(0.25, 0.6), np.linspace(0.0, 1.0, SAMPLES + 1)
    ease = k**2 * (3.0 - 2.0 * k)
    start = rng.uniform(-0.45, 0.45 - along)
    x = front + rng.uniform(-0.05, 0.22) + rng.uniform(0.0, 0.04) * np.sin(2.0 * np.pi * k)
    z = 0.5 * (low + high) + rng.uniform(-0.09, 0.09) + rng.uniform(0.0, 0.03) * np.sin(4.0 * np.pi * k)
    return obstacles, np.column_stack([x, start + along * ease, z])


def _add_shelf(obstacles: dict[str, Any], name: str, front: float, side: float, rng: np.random.Generator) -> Floats:
    """A row of boards from `front` on towards x `side`, with things on them; the heights of its boards, m."""
    depth, length, thick = rng.uniform(0.3, 0.45), rng.uniform(1.5, 2.4), rng.uniform(0.018, 0.035)
    heights = rng.uniform(0.45, 0.7) + np.cumsum([0.0, *rng.uniform(0.36, 0.5, 3)])
    middle = front + side * 0.5 * depth
    for k, height in enumerate(heights):
        obstacles[f"{name}_board{k}"] = {"box": [depth, length, thick], "position": [middle, 0.0, float(height)]}
        for thing in range(int(rng.integers(0, 4))):
            x, y = front + side * rng.uniform(0.6, 0.85) * depth, rng.uniform(-0.45, 0.45) * length
            radius, tall = rng.uniform(0.03, 0.045), rng.uniform(0.08, 0.2)
            z = float(height + 0.5 * (thick + tall))
            solid: dict[str, Any] = {"cylinder": {"radius": radius, "height": tall}}
            if rng.random() < 0.4:
                solid = {
                    "box": [2.0 * radius, rng.uniform(0.05, 0.15), tall],
                    "rpy": [0.0, 0.0, rng.uniform(-0.4, 0.4)],
                }
            obstacles[f"{name}_thing{k}{thing}"] = {**solid, "position": [x, y, z]}
    top = float(heights[-1])
    for sign, end in ((-1.0, "left"), (1.0, "right")):
        y = sign * 0.5 * (length + thick)
        obstacles[f"{name}_{end}"] = {"box": [depth, thick, top], "position": [middle, y, 0.5 * top]}
    back = front + side * (depth + 0.5 * thick)
    obstacles[f"{name}_back"] = {"box": [thick, length, top], "position": [back, 0.0, 0.5 * top]}
    return heights


def sample_densely(motion: ikde.Trajectory, segment: int, count: int = DENSE) -> Floats:
    """Joint values [count + 1, N] along a segment: linear, of a base with wheels on its arc."""
    q0, q1 = motion.q[segment : segment + 2]
    share = np.linspace(0.0, 1.0, count + 1)[:, None]
    q = (1.0 - share) * q0 + share * q1
    if motion.drive == "differential":
        x, y, yaw = (motion.joint_names.index(name) for name in motion.base_joints)
        turn, chord = q1[yaw] - q0[yaw], np.hypot(q1[x] - q0[x], q1[y] - q0[y])
        forward = np.cos(q0[yaw] + 0.5 * turn) * (q1[x] - q0[x]) + np.sin(q0[yaw] + 0.5 * turn) * (q1[y] - q0[y])
        half = np.sinc(0.5 * turn / np.pi)  # a chord is so much shorter than its arc
        length = np.sign(forward) * chord / half * share[:, 0]
        part = turn * share[:, 0]
        along = length * np.sinc(0.5 * part / np.pi)
        q[:, x] = q0[x] + along * np.cos(q0[yaw] + 0.5 * part)
        q[:, y] = q0[y] + along * np.sin(q0[yaw] + 0.5 * part)
    return q


def measure_distances(obstacles: dict[str, Any], P: Floats) -> Floats:
    """Signed distances of points [..., 3] from all boxes and cylinders, m: the least [...]."""
    least = np.full(P.shape[:-1], np.inf)
    for solid in obstacles.values():
        own = P - np.array(solid["position"])
        yaw = solid.get("rpy", [0.0, 0.0, 0.0])[2]
        x = np.cos(yaw) * own[..., 0] + np.sin(yaw) * own[..., 1]
        y = np.cos(yaw) * own[..., 1] - np.sin(yaw) * own[..., 0]
        if "box" in solid:
            half = 0.5 * np.array(solid["box"])
            out = np.stack([np.abs(x) - half[0], np.abs(y) - half[1], np.abs(own[..., 2]) - half[2]], axis=-1)
        else:
            size = solid["cylinder"]
            out = np.stack([np.hypot(x, y) - size["radius"], np.abs(own[..., 2]) - 0.5 * size["height"]], axis=-1)
        beyond = np.linalg.norm(np.maximum(out, 0.0), axis=-1) + np.minimum(out.max(axis=-1), 0.0)
        least = np.minimum(least, beyond)
    return least


def compare_densely(motion: ikde.Trajectory, model: CollisionModel, obstacles: dict[str, Any]) -> dict[str, Any]:
    """By how much dense samples stay above the certificate of their segment, at least, m."""
    proof = motion.certificate
    assert proof is not None
    assert proof.world_m is not None
    assert proof.own_m is not None
    world, own, nearest = np.inf, np.inf, np.inf
    for segment in range(motion.reached_points):
        q = sample_densely(motion, segment)
        gaps = [
            measure_distances(obstacles, centres) - radii
            for name, (centres, radii) in compute_components(model, q).items()
            if name not in model.fixed_components
        ]
        least = float(np.concatenate(gaps, axis=-1).min())
        nearest = min(nearest, least)
        world = min(world, least - float(proof.world_m[segment]))
        own = min(own, float(compute_gaps(model, q, model.pairs).min() - proof.own_m[segment]))
    return {"above_world_m": world, "above_own_m": own, "dense_clearance_m": nearest}


def run_scene(robot: ikde.Robot, seed: int) -> dict[str, Any]:
    """One scene and robot: what came of it."""
    obstacles, points = draw_scene(seed)
    model = CollisionModel.of(robot).in_world(ikde.load_world({"obstacles": obstacles}), MARGIN_M)
    path = ikde.ToolPath.through(points, dt_s=DT_S)
    limits = ikde.MotionLimits.of(robot)
    solved = ikde.solve(robot, points[0], collision=model)
    began = time.perf_counter()
    motion = ikde.follow_path(robot, path, collision=model, limits=limits)
    row = {
        "seed": seed,
        "robot": robot.name,
        "obstacles": len(obstacles),
        "solved": solved.reached,
        "points": motion.reached_points,
        "followed": motion.reached,
        "seconds": time.perf_counter() - began,
        "search_s": motion.search_seconds,
        "stop": motion.stop.line if motion.stop else None,
        "reason": motion.stop.reason.value if motion.stop else None,
        "hint": motion.stop.hint if motion.stop else None,
        "is_free": None if motion.certificate is None else motion.certificate.is_free,
        "clearance_m": None if motion.grade.clearance_m is None else motion.grade.clearance_m,
    }
    if motion.certificate is None:
        return row
    return {**row, "room_m": float(motion.certificate.room_m.min()), **compare_densely(motion, model, obstacles)}


def summarise(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """What is counted of a robot's scenes."""
    dense = [row for row in rows if "above_world_m" in row]
    return {
        "scenes": len(rows),
        "first pose solved": sum(row["solved"] for row in rows),
        "followed to the end": sum(row["followed"] for row in rows),
        "certified of those followed": sum(bool(row["is_free"]) for row in rows if row["followed"]),
        "stopped": dict(Counter(row["reason"] for row in rows if row["reason"])),
        "stopped with a hint": sum(bool(row["hint"]) for row in rows),
        "motions sampled densely": len(dense),
        "least above the certificate, world [mm]": 1e3 * min(row["above_world_m"] for row in dense),
        "least above the certificate, itself [mm]": 1e3 * min(row["above_own_m"] for row in dense),
        "nearest of dense samples [mm]": 1e3 * min(row["dense_clearance_m"] for row in dense),
        "search, median and largest [s]": [
            float(np.quantile([row["search_s"] for row in rows], share)) for share in (0.5, 1.0)
        ],
    }


def main() -> None:
    """Run all, print counts, record."""
    from machine import describe

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", type=int, default=100, help="how many")
    parser.add_argument("--robots", nargs="+", help="names or files, instead of qiao2021 and ur5 on a cart")
    options = parser.parse_args()
    named = [ikde.load_robot(name) for name in options.robots or ()]
    record: dict[str, Any] = {"machine": describe(), "robots": {}}
    for robot in named or (ikde.load_robot("qiao2021"), make_cart()):
        rows = []
        for seed in range(options.scenes):
            rows.append(run_scene(robot, seed))
            print(json.dumps({key: rows[-1][key] for key in ("robot", "seed", "points", "stop")}), flush=True)
        counts = summarise(rows)
        print(json.dumps(counts, indent=1), flush=True)
        record["robots"][robot.name] = {"counts": counts, "scenes": rows}
    RESULTS.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
