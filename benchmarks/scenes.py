"""Grasp poses among obstacles: MotionBenchMaker's problems, each answered by `ikde.solve` in its scene.

    IKDE_COMPILE=wait python -m benchmarks.scenes FOLDER ... [--first N] [--margin MM ...] [--out FILE]

A folder holds one robot: URDF with spheres, SRDF, and below `problems` a folder a family with sceneNNNN.yaml and
requestNNNN.yaml. What is asked for is the pose that the tool has at the request's goal, with default settings.
*new* is the first call in a world that was not seen before, *again* the median of five further ones. Each answer's
tool pose, and distances from objects, are measured once more by this script, from the text of URDF and scene alone: it
shares nothing with ikde. Self-collision is not measured again.
"""

import argparse
import json
import os
import sys
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import yaml

os.environ.setdefault("IKDE_COMPILE", "wait")

import ikde
from benchmarks.machine import describe
from ikde.batch.scenes import make_question
from ikde.io.scene_pairs import Request, ScenePair, find_pairs, read_request
from ikde.solver.explain import is_proof

TOOLS = {"ur5": "ee_link", "panda": "panda_hand", "fetch": "gripper_link"}
WARM, REPEATED, CHECKED, MOVED_M = 3, 5, 200, 1e-4
TOLERANCE_M, TOLERANCE_RAD = ikde.SolveSettings().position_tolerance_m, ikde.SolveSettings().orientation_tolerance_rad
TOUCH_M = 1e-9  # what rounding may make of a contact
LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


@dataclass
class Tally:
    """What became of the problems of one family."""

    times: dict[str, list[float]] = field(default_factory=dict)
    stops: Counter[str] = field(default_factory=Counter)
    blockers: Counter[str] = field(default_factory=Counter)
    solved: int = 0
    proved: int = 0
    slowest: tuple[float, str] = (0.0, "")
    unsolved: list[str] = field(default_factory=list)
    wrong: list[str] = field(default_factory=list)
    least_m: float = np.inf
    """Of all answers, the smallest distance from an obstacle, by this script."""

    def take(self, key: str, seconds: float) -> None:
        """One time more."""
        self.times.setdefault(key, []).append(seconds * 1e6)

    def join(self, other: "Tally") -> None:
        """Adds the counts of another one."""
        for key, values in other.times.items():
            self.times.setdefault(key, []).extend(values)
        self.stops += other.stops
        self.blockers += other.blockers
        self.solved, self.proved = self.solved + other.solved, self.proved + other.proved
        self.slowest, self.least_m = max(self.slowest, other.slowest), min(self.least_m, other.least_m)
        self.unsolved, self.wrong = self.unsolved + other.unsolved, self.wrong + other.wrong

    def table(self) -> dict[str, Any]:
        """As plain data, times in us."""
        return {
            "problems": self.stops.total(),
            "solved": self.solved,
            "proved_no": self.proved,
            "us": {key: summarise(values) for key, values in self.times.items()},
            "slowest": self.slowest[1],
            "stop_reasons": dict(self.stops),
            "blockers": dict(self.blockers.most_common(8)),
            "unsolved": self.unsolved[:50],
            "wrong": self.wrong,
            "least_distance_mm": None if np.isinf(self.least_m) else round(self.least_m * 1e3, 4),
        }


def summarise(values: list[float]) -> dict[str, float]:
    """Four quantiles, to four digits."""
    marks = zip(("median", "p95", "p99", "max"), np.quantile(values, (0.5, 0.95, 0.99, 1.0)), strict=True)
    return {name: float(f"{value:.4g}") for name, value in marks}


class Twin:
    """Spheres of a URDF among boxes and cylinders of a scene, from their text alone."""

    def __init__(self, urdf: Path, tool: str) -> None:
        self.tool = tool
        root = ElementTree.parse(urdf).getroot()
        self.spheres: dict[str, list[tuple[np.ndarray, float]]] = {}
        for link in root.iter("link"):
            balls = self.spheres[link.get("name", "")] = []
            for shape in link.findall("collision"):
                ball = shape.find("geometry/sphere")
                assert ball is not None, f"{link.get('name')}: only spheres are understood"
                balls.append((read_origin(shape)[:3, 3], float(ball.get("radius", ""))))
        self.joints = [read_joint(joint) for joint in root.findall("joint")]

    def place_links(self, values: dict[str, float]) -> dict[str, np.ndarray]:
        """Link -> its pose [4, 4] in the root link; joints without a value stand at 0."""
        parents = {child: (parent, name, kind, T, axis) for name, kind, parent, child, T, axis in self.joints}
        placed: dict[str, np.ndarray] = {}

        def place(link: str) -> np.ndarray:
            if link not in placed:
                if link not in parents:
                    return placed.setdefault(link, np.eye(4))
                parent, name, kind, T, axis = parents[link]
                placed[link] = place(parent) @ T @ move_joint(kind, axis, values.get(name, 0.0))
            return placed[link]

        for link in self.spheres:
            place(link)
        return placed

    def nearest(self, values: dict[str, float], scene: dict[str, Any]) -> tuple[float, str, str]:
        """The smallest distance of a sphere that joints move from an object, in m, with link and object."""
        placed, elsewhere = self.place_links(values), self.place_links({key: x + 0.3 for key, x in values.items()})
        moved = [link for link in self.spheres if not np.allclose(placed[link], elsewhere[link])]
        balls = [(link, placed[link] @ [*centre, 1.0], R) for link in moved for centre, R in self.spheres[link]]
        centres, radii = np.array([ball[1][:3] for ball in balls]), np.array([ball[2] for ball in balls])
        best = (np.inf, "", "")
        for entry in scene["world"]["collision_objects"]:
            T = placed.get(entry.get("header", {}).get("frame_id", ""), np.eye(4)) @ read_pose(entry.get("pose"))
            for shape, pose in zip(entry["primitives"], entry["primitive_poses"], strict=True):
                T_world_solid = T @ read_pose(pose)
                gaps = measure(shape, (centres - T_world_solid[:3, 3]) @ T_world_solid[:3, :3]) - radii
                best = min(best, (float(gaps.min()), balls[int(gaps.argmin())][0], entry["id"]))
        return best


def measure(shape: dict[str, Any], points: np.ndarray) -> np.ndarray:
    """Signed distances of points [K, 3] from a solid in its own frame, m."""
    if shape["type"] == "box":
        out = np.abs(points) - np.array(shape["dimensions"]) / 2
    else:
        assert shape["type"] == "cylinder", shape["type"]
        height, radius = shape["dimensions"]
        out = np.stack([np.hypot(points[:, 0], points[:, 1]) - radius, np.abs(points[:, 2]) - height / 2], axis=1)
    most = out.max(axis=1)
    return np.where(most <= 0, most, np.linalg.norm(np.maximum(out, 0), axis=1))


def turn(axis: np.ndarray, angle: float) -> np.ndarray:
    """[3, 3] about a unit vector, by Rodrigues' formula."""
    x, y, z = axis
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K


def read_origin(element: ElementTree.Element) -> np.ndarray:
    """[4, 4] of a joint or shape in its parent; angles about the fixed axes x, y, z."""
    origin, T = element.find("origin"), np.eye(4)
    if origin is not None:
        roll, pitch, yaw = map(float, origin.get("rpy", "0 0 0").split())
        X, Y, Z = np.eye(3)
        T[:3, :3] = turn(Z, yaw) @ turn(Y, pitch) @ turn(X, roll)
        T[:3, 3] = list(map(float, origin.get("xyz", "0 0 0").split()))
    return T


def read_joint(joint: ElementTree.Element) -> tuple[str, str, str, str, np.ndarray, np.ndarray]:
    """Name, kind, parent, child, origin [4, 4] and unit axis."""
    (parent,), (child,) = joint.findall("parent"), joint.findall("child")
    written = joint.find("axis")
    axis = np.array(list(map(float, ("1 0 0" if written is None else written.get("xyz", "1 0 0")).split())))
    name, kind = joint.get("name", ""), joint.get("type", "")
    axis = axis / (np.linalg.norm(axis) or 1.0)
    return name, kind, parent.get("link", ""), child.get("link", ""), read_origin(joint), axis


def move_joint(kind: str, axis: np.ndarray, value: float) -> np.ndarray:
    """[4, 4] of what a joint adds at a value in m or rad."""
    T = np.eye(4)
    if kind == "prismatic":
        T[:3, 3] = axis * value
    elif kind != "fixed":
        T[:3, :3] = turn(axis, value)
    return T


def read_pose(pose: dict[str, Any] | None) -> np.ndarray:
    """[4, 4]; quaternions are x, y, z, w. None: the identity."""
    T = np.eye(4)
    if pose:
        x, y, z, w = np.array(pose["orientation"], float) / np.linalg.norm(pose["orientation"])
        sine = np.sqrt(x * x + y * y + z * z)
        T[:3, :3] = turn(np.array([x, y, z]) / (sine or 1.0), 2 * np.arctan2(sine, w))
        T[:3, 3] = pose["position"]
    return T


def read_yaml(path: Path) -> dict[str, Any]:
    """A file as plain data."""
    return yaml.load(path.read_text(encoding="utf-8"), LOADER)


def read_goal(request: Request, robot: ikde.Robot) -> np.ndarray:
    """[N] a request's goal in the robot's order."""
    return np.array([request.goal[name] for name in robot.joint_names])


def read_robot(folder: Path) -> tuple[str, ikde.Robot, Twin]:
    """Name, robot and its twin."""
    (urdf,), (srdf,) = folder.glob("*.urdf"), folder.glob("*.srdf")
    name = urdf.stem.split("_")[0]
    options = ikde.ImportOptions(tool=TOOLS.get(name), srdf=srdf, base="fixed")
    robot = ikde.read_urdf(urdf, options).robot
    return name, robot, Twin(urdf, robot.tool)


def run_problem(robot: ikde.Robot, twin: Twin, pair: ScenePair, margin_m: float, tally: Tally) -> None:
    """One scene and its request."""
    request, scene = read_request(pair.request), pair.scene
    q, target = read_goal(request, robot), make_question(robot, request.start, request.goal).target
    world, own = ikde.load_world(scene), ikde.CollisionModel.of(robot)
    started = time.perf_counter()
    model = own.in_world(world, margin_m=margin_m)
    packed = time.perf_counter()
    result = ikde.solve(robot, target, collision=model)
    answered = time.perf_counter()
    spent = [time_again(robot, target, model, result) for _ in range(REPEATED)]
    tally.take("pack", packed - started)
    tally.take("new" if result.reached else "new, not reached", answered - packed - result.compile_seconds)
    tally.take("again" if result.reached else "again, not reached", float(np.median(spent)))
    tally.slowest = max(tally.slowest, (float(np.median(spent)), f"{scene.parent.name}/{scene.stem}"))
    name, T_moved = world.names[0], world.obstacles[0].T_world_obstacle.copy()
    T_moved[2, 3] += MOVED_M
    started = time.perf_counter()
    ikde.solve(robot, target, collision=own.in_world(world.move(name, T_moved), margin_m=margin_m))
    tally.take("moved", time.perf_counter() - started)
    drawn = np.random.default_rng(0).uniform(*robot.drawn, (CHECKED, len(q)))
    started = time.perf_counter()
    ikde.check_many(robot, drawn, collision=model)
    tally.take("check_many, a configuration", (time.perf_counter() - started) / CHECKED)
    started = time.perf_counter()
    ikde.check(robot, result.q, collision=model)
    tally.take("check", time.perf_counter() - started)
    judge(result, q, twin, scene, tally, margin_m)


def time_again(robot: ikde.Robot, target: ikde.Target, model: ikde.CollisionModel, first: ikde.SolveResult) -> float:
    """Seconds of the same call once more, which gives the same bits."""
    started = time.perf_counter()
    result = ikde.solve(robot, target, collision=model)
    ended = time.perf_counter()
    assert np.array_equal(result.q, first.q)
    return ended - started


def judge(result: ikde.SolveResult, goal: np.ndarray, twin: Twin, scene: Path, tally: Tally, margin_m: float) -> None:
    """Counts an answer; one that is called reached is measured once more."""
    where = f"{scene.parent.name}/{scene.stem}"
    tally.stops[str(result.stop_reason)] += 1
    if not result.reached:
        tally.unsolved.append(f"{where}: {result.reason}")
        tally.proved += is_proof(result.reason)
        tally.blockers.update(f"{a} x {b}" for a, b in result.blocking_pairs)
        return
    tally.solved += 1
    found, asked = (dict(zip(result.joint_names, map(float, q), strict=True)) for q in (result.q, goal))
    gap, link, name = twin.nearest(found, read_yaml(scene))
    T, T_asked = (twin.place_links(values)[twin.tool] for values in (found, asked))
    off_m = float(np.linalg.norm(T[:3, 3] - T_asked[:3, 3]))
    off_rad = 2 * float(np.arcsin(min(1.0, np.linalg.norm(T[:3, :3] - T_asked[:3, :3]) / np.sqrt(8))))
    if off_m > TOLERANCE_M + TOUCH_M or off_rad > TOLERANCE_RAD + TOUCH_M:
        tally.wrong.append(f"{where}: the tool is {off_m} m and {off_rad} rad from what was asked")
    tally.least_m = min(tally.least_m, gap)
    if not gap > margin_m - TOUCH_M:
        tally.wrong.append(f"{where}: {link} is {gap * 1e3:.6f} mm from {name}")


def run_robot(folder: Path, margin_mm: float, first: int | None) -> tuple[str, dict[str, Any]]:
    """Title and rows of one robot: a row a family, then all."""
    name, robot, twin = read_robot(folder)
    scenes = {family: pairs[:first] for family, pairs in find_pairs(folder).items()}
    for paths in scenes.values():  # compiles, and fills caches that do not depend on a world
        for pair in paths[:WARM]:
            run_problem(robot, twin, pair, margin_mm * 1e-3, Tally())
    everything, rows = Tally(), {}
    for family, paths in scenes.items():
        tally = Tally()
        for pair in paths:
            run_problem(robot, twin, pair, margin_mm * 1e-3, tally)
        rows[family] = tally.table()
        everything.join(tally)
        show(family, rows[family])
    rows["all"] = everything.table()
    title = name if margin_mm == 0 else f"{name}, {margin_mm:g} mm"
    show(title, rows["all"])
    return title, rows


def show(title: str, row: dict[str, Any]) -> None:
    """Prints a row."""
    parts = [f"{title}: {row['solved']} of {row['problems']} solved, {row['proved_no']} no proved"]
    for key, marks in row["us"].items():
        parts.append(f"  {key}, us: " + ", ".join(f"{name} {value:g}" for name, value in marks.items()))
    if row["stop_reasons"].keys() - {"reached"}:
        parts.append(f"  {row['stop_reasons']}, blocked by {row['blockers']}")
    parts += [f"  WRONG {line}" for line in row["wrong"]]
    print("\n".join(parts), flush=True)


def main() -> None:
    """Reads the options, runs every robot with every margin, and ends with 1 where an answer is wrong."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--margin", nargs="*", type=float, default=[0.0], help="kept from all obstacles, mm")
    parser.add_argument("--first", type=int, help="scenes of each family; default all")
    parser.add_argument("--out", type=Path)
    options = parser.parse_args()
    record: dict[str, Any] = {"machine": describe(), "robots": {}}
    if options.out and options.out.exists():
        record["robots"] = json.loads(options.out.read_text(encoding="utf-8"))["robots"]
    wrong = 0
    for folder in options.folders:
        for margin in options.margin:
            title, rows = run_robot(folder, margin, options.first)
            record["robots"][title] = rows
            wrong += len(rows["all"]["wrong"])
            if options.out:
                options.out.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    sys.exit(wrong > 0)


if __name__ == "__main__":
    main()
