"""Goals with freedom among obstacles: random regions about the goals of planning problems, answered by `ikde.solve`.

    IKDE_COMPILE=wait python -m benchmarks.regions FOLDER ... [--robot FILE ...] [--count N] [--dense N] [--out FILE]

A folder is one of `benchmarks.scenes`; `--robot` is its robot file where there is one, which saves the import. A region
is made of the tool's pose at a request's goal, moved by some 8 cm and 0.3 rad, so that its centre is often blocked: a
tolerance box, a free or a limited turn, a cone, a point to look at, or three alternatives.

Answers are graded by this script: forward kinematics and distances from obstacles by `benchmarks.scenes.Twin`, from the
text of URDF and scene, and where the tool is in the region by scipy's rotations. Where no answer is found and nothing
is proved, a dense search looks for one: random poses of the region, drawn here, each of them searched by `lm` with 100
attempts. *Of those that exist* counts answers against all regions, with a blocked centre, of which either found one.
Times are of the processor, of a second call.
"""

import argparse
import json
import os
import time
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

os.environ.setdefault("IKDE_COMPILE", "wait")

import ikde
from benchmarks.machine import describe
from benchmarks.scenes import TOOLS, Twin, read_robot, read_yaml, summarise
from ikde.batch.scenes import make_question
from ikde.io.scene_pairs import ScenePair, find_pairs, read_request
from ikde.solver.explain import is_proof
from ikde.solver.result import StopReason

TOLERANCE_M, TOLERANCE_RAD, ROUNDING = 1e-5, 1e-4, 1e-9
DENSE_ATTEMPTS = 100
KINDS = ("box", "turn", "limited turn", "cone", "look at", "alternatives")
Spec = dict[str, Any]


def draw_spec(kind: str, T: np.ndarray, rng: np.random.Generator) -> Spec:
    """A region as plain numbers: a pose that is moved, and what is free about it."""
    p = T[:3, 3] + rng.normal(0.0, 0.05, 3)
    R = T[:3, :3] @ Rotation.from_rotvec(rng.normal(0.0, 0.2, 3)).as_matrix()
    spec = {"kind": kind, "p": p, "R": R, "half_m": rng.uniform(0.0, 0.12, 3) * (rng.random(3) < 0.8)}
    if kind == "box":
        spec["half_rad"] = rng.uniform(0.0, 0.6, 3) * (rng.random(3) < 0.6)
        spec["half_m"][0] += 0.01
    elif kind == "limited turn":
        spec["axis"], spec["angles"] = np.eye(3)[rng.integers(3)], np.sort(rng.uniform(-1.5, 1.5, 2))
    elif kind == "cone":
        spec["angle"] = rng.uniform(0.1, 0.8)
    elif kind == "look at":
        spec |= {"point": p + R[:, 2] * rng.uniform(0.1, 0.3), "distances": (0.1, 0.5), "angle": rng.uniform(0.2, 1.5)}
    elif kind == "alternatives":
        spec["parts"] = [draw_spec("box", T, rng), draw_spec("turn", T, rng), draw_spec("cone", T, rng)]
    return spec


def make_region(spec: Spec) -> ikde.Region:
    """The same as ikde takes it."""
    kind, half = spec["kind"], spec["half_m"]
    if kind == "alternatives":
        return ikde.Region.any_of([make_region(part) for part in spec["parts"]])
    goal = ikde.Target(spec["p"], R_world_tool=spec["R"])
    if kind == "box":
        return ikde.Region.box(goal, half, spec["half_rad"])
    if kind == "turn":
        return ikde.Region.turn(goal, position_m=half)
    if kind == "limited turn":
        return ikde.Region.turn(goal, spec["axis"], spec["angles"], position_m=half)
    if kind == "cone":
        return ikde.Region.cone(goal, spec["angle"], position_m=half)
    return ikde.Region.look_at(spec["point"], spec["distances"], spec["R"][:, 2], spec["angle"])


def measure(spec: Spec, T: np.ndarray) -> tuple[float, float]:
    """How far out of a region a pose is, m and rad."""
    kind, p, R = spec["kind"], T[:3, 3], T[:3, :3]
    if kind == "alternatives":
        return min((measure(part, T) for part in spec["parts"]), key=lambda out: out[0] + 0.1 * out[1])
    if kind == "look at":
        sight = spec["point"] - p
        distance = float(np.linalg.norm(sight))
        off = max(angle_of(sight, R[:, 2]), angle_of(sight, spec["R"][:, 2]) - spec["angle"])
        low, high = spec["distances"]
        return max(low - distance, distance - high, 0.0), max(0.0, off - TOLERANCE_M / distance)
    inside = np.clip(spec["R"].T @ (p - spec["p"]), -spec["half_m"], spec["half_m"])
    far_m = float(np.linalg.norm(p - spec["p"] - spec["R"] @ inside))
    if kind == "cone":
        return far_m, max(0.0, angle_of(R[:, 2], spec["R"][:, 2]) - spec["angle"])
    if kind == "turn":
        return far_m, angle_of(R[:, 2], spec["R"][:, 2])
    off = Rotation.from_matrix(spec["R"].T @ R)
    if kind == "box":
        nearest = Rotation.from_rotvec(np.clip(off.as_rotvec(), -spec["half_rad"], spec["half_rad"]))
        return far_m, float((nearest.inv() * off).magnitude())
    low, high = spec["angles"]
    turns = [Rotation.from_rotvec(a * spec["axis"]) for a in np.clip(np.linspace(low, high, 1001), low, high)]
    return far_m, float((Rotation.concatenate(turns).inv() * off).magnitude().min()) - (high - low) / 2000


def angle_of(a: np.ndarray, b: np.ndarray) -> float:
    """Between two vectors, rad."""
    return float(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b))


def draw_targets(spec: Spec, count: int, rng: np.random.Generator) -> ikde.Targets:
    """Random exact targets of a region."""
    kind = spec["kind"]
    if kind == "alternatives":
        parts = [draw_targets(part, count // 3 + 1, rng) for part in spec["parts"]]
        return ikde.Targets.of([target for part in parts for target in part])
    p = spec["p"] + rng.uniform(-1.0, 1.0, (count, 3)) * spec["half_m"] @ spec["R"].T
    if kind in ("cone", "look at"):
        z = rng.uniform(np.cos(spec["angle"]), 1.0, count)
        around, across = rng.uniform(0.0, 2 * np.pi, count), np.sqrt(1.0 - z * z)
        axes = np.stack([across * np.cos(around), across * np.sin(around), z], axis=1) @ spec["R"].T
        if kind == "look at":
            p = spec["point"] - rng.uniform(*spec["distances"], (count, 1)) * axes
        return ikde.Targets(p, axis_world_tool=axes)
    if kind == "turn":
        return ikde.Targets(p, axis_world_tool=np.tile(spec["R"][:, 2], (count, 1)))
    vectors = (
        rng.uniform(-1.0, 1.0, (count, 3)) * spec["half_rad"]
        if kind == "box"
        else rng.uniform(*spec["angles"], (count, 1)) * spec["axis"]
    )
    return ikde.Targets(p, R_world_tool=spec["R"] @ Rotation.from_rotvec(vectors).as_matrix())


class Run:
    """What became of the regions of one robot."""

    def __init__(self, robot: ikde.Robot, twin: Twin, dense: int) -> None:
        self.robot, self.twin, self.dense = robot, twin, dense
        self.stops, self.kinds = Counter[str](), Counter[str]()
        self.times: dict[str, list[float]] = {"centre reached": [], "another pose": [], "not reached": [], "proved": []}
        self.poses: list[float] = []
        self.wrong: list[str] = []
        self.missed: list[str] = []
        self.blocked = self.blocked_found = self.dense_found = 0

    def ask(self, pair: ScenePair, kind: str, rng: np.random.Generator) -> None:
        """One region in the scene of one problem."""
        request, world = read_request(pair.request), ikde.load_world(pair.scene)
        question = make_question(self.robot, request.start, request.goal)
        spec = draw_spec(kind, np.vstack([question.target.T_world_tool, [0, 0, 0, 1]]), rng)
        region, model = make_region(spec), ikde.CollisionModel.of(self.robot).in_world(world)
        freeze, seed = question.held or None, int(rng.integers(2**32))
        result = ikde.solve(self.robot, region, collision=model, freeze=freeze, seed=seed)
        started = time.thread_time()
        again = ikde.solve(self.robot, region, collision=model, freeze=freeze, seed=seed)
        seconds = time.thread_time() - started
        assert again.q.tobytes() == result.q.tobytes()
        self.stops[str(result.stop_reason)] += 1
        is_first = result.reached and result.poses == 1
        is_sure = not result.reached and (is_proof(result.reason) or result.stop_reason is StopReason.OUT_OF_REACH)
        key = (
            "centre reached"
            if is_first
            else "another pose"
            if result.reached
            else "proved"
            if is_sure
            else "not reached"
        )
        self.times[key].append(seconds * 1e6)
        if result.reached:
            self.judge(result, spec, pair, question.held)
        if is_first:
            return
        centre = ikde.solve(self.robot, result.region.parts[0].target, collision=model, freeze=freeze)
        if centre.reached or is_sure:
            return
        self.blocked += 1
        if result.reached:
            self.blocked_found += 1
            self.poses.append(float(result.poses or 0))
        elif self.search(spec, model, freeze, rng):
            self.dense_found += 1
            self.missed.append(f"{pair.scene.parent.name}/{pair.scene.stem}, {kind}: {result.reason}")

    def search(self, spec: Spec, model: ikde.CollisionModel, freeze: Any, rng: np.random.Generator) -> bool:
        """Whether a dense search finds an answer."""
        settings = ikde.SolveSettings(method="lm", restarts=DENSE_ATTEMPTS)
        for _ in range(0, self.dense, 500):
            targets = draw_targets(spec, min(500, self.dense), rng)
            bulk = ikde.BulkOptions(explain=False)
            if ikde.solve_many(self.robot, targets, settings, collision=model, freeze=freeze, bulk=bulk).reached.any():
                return True
        return False

    def judge(self, result: ikde.SolveResult, spec: Spec, pair: ScenePair, held: Any) -> None:
        """Grades an answer from the text of URDF and scene."""
        values = {**dict(held), **dict(zip(result.joint_names, map(float, result.q), strict=True))}
        scene, where = read_yaml(pair.scene), f"{pair.scene.parent.name}/{pair.scene.stem}, {spec['kind']}"
        far_m, off_rad = measure(spec, self.twin.place_links(values)[self.twin.tool])
        if far_m > TOLERANCE_M + ROUNDING or off_rad > TOLERANCE_RAD + ROUNDING:
            self.wrong.append(f"{where}: {far_m} m and {off_rad} rad out of the region")
        gap, link, name = self.twin.nearest(values, scene)
        if not gap > -ROUNDING:
            self.wrong.append(f"{where}: {link} is {gap * 1e3:.6f} mm from {name}")

    def table(self) -> dict[str, Any]:
        """As plain data, times in us."""
        exist = self.blocked_found + self.dense_found
        return {
            "regions": self.stops.total(),
            "stop_reasons": dict(self.stops),
            "blocked_centres": self.blocked,
            "of those that exist": [self.blocked_found, exist],
            "us": {key: {"count": len(v), **summarise(v)} for key, v in self.times.items() if v},
            "poses of the found": summarise(self.poses) if self.poses else None,
            "missed": self.missed,
            "wrong": self.wrong,
        }


def main() -> None:
    """Reads the options, runs every robot, and ends with 1 where an answer is wrong."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--robot", nargs="*", default=[], help="a robot file for each folder")
    parser.add_argument("--count", type=int, default=334, help="regions of each robot")
    parser.add_argument("--dense", type=int, default=2000, help="poses of the dense search")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path)
    options = parser.parse_args()
    rows: dict[str, Any] = {}
    for place, folder in enumerate(options.folders):
        if options.robot:
            (urdf,), robot = folder.glob("*.urdf"), ikde.load_robot(Path(options.robot[place]))
            name = urdf.stem.split("_")[0]
            twin = Twin(urdf, TOOLS[name])
        else:
            name, robot, twin = read_robot(folder)
        pairs = [pair for family in find_pairs(folder).values() for pair in family]
        rng, run = np.random.default_rng(options.seed), Run(robot.whole, twin, options.dense)
        for number in range(options.count):
            run.ask(pairs[rng.integers(len(pairs))], KINDS[number % len(KINDS)], rng)
        rows[name] = run.table()
        print(name, json.dumps(rows[name], indent=1), flush=True)
    if options.out:
        options.out.write_text(json.dumps({"machine": describe(), "robots": rows}, indent=1) + "\n", encoding="utf-8")
    raise SystemExit(any(row["wrong"] for row in rows.values()))


if __name__ == "__main__":
    main()
