"""Other solvers beside ikde on grasp poses among obstacles: MotionBenchMaker's problems, interleaved.

    .venv-peers/bin/python -m benchmarks.scene_peers FOLDER ... [--every 6] [--rounds 5] [--only NAME ...] [--out FILE]

Folders as for `benchmarks/scenes.py`; each peer is a process of its own on one core (`benchmarks/peers`). All get the
robot as ikde exports it (spheres, limits, the pairs that its detector compares) and the solids of the scene, which no
sphere that a joint moves may touch. Problem by problem, in a drawn order, each peer loads the scene and then solves,
`--rounds` times, in an order drawn anew; a target's time is the median of its rounds. Times are those of the process
on a processor, so neighbours on a busy machine do not count. One that has used its share of time for a robot is asked
no more; as the order is drawn, what it was asked is a sample.

An answer counts if the tool is within the tolerances of what was asked, by `scenes.Twin` from the text of the URDF, all
joints are inside their limits, no sphere touches a solid, by `scenes.Twin`, and no pair of spheres touches, by coal
on all pairs. Whoever returns something else has not solved, and how many times is on record.
"""

import argparse
import json
import sys
import tempfile
import time
from dataclasses import dataclass, field
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parent / "peers"))

import pinocchio as pin
from client import Client, Lost
from protocol import Answer, Setup, Solid, angle_between
from roster import EVERY, IN_SCENES
from world_checkers import read_spheres

import ikde
from benchmarks.machine import describe
from benchmarks.scenes import Twin, read_goal, read_pose, read_robot, read_yaml
from ikde.io.scene_pairs import ScenePair, find_pairs, read_request

RESULTS = Path(__file__).parent / "results" / "scene_peers.json"
TOLERANCE, SEED, WARM, TOUCH_M = (1e-4, 1e-3), 17, 3, 1e-9
SHARES = {"median": 50, "p95": 95, "p99": 99, "max": 100}


@dataclass(frozen=True, kw_only=True, eq=False)
class Problem:
    """One scene and what is asked in it."""

    name: str
    scene: dict[str, Any]
    solids: list[Solid]
    p: np.ndarray
    R: np.ndarray


@dataclass
class Tally:
    """One peer's answers for one robot."""

    prepare: dict[str, float] = field(default_factory=dict)
    names: list[str] = field(default_factory=list)
    rounds: list[list[Answer]] = field(default_factory=list)
    """Of each problem."""
    load_s: list[float] = field(default_factory=list)
    solved: list[bool] = field(default_factory=list)
    wrong: list[str] = field(default_factory=list)
    lost: str | None = None

    @property
    def spent_s(self) -> float:
        """Time used so far, but for loading."""
        return sum(seconds for answers in self.rounds for seconds, _ in answers)

    @property
    def times_s(self) -> np.ndarray:
        """Of each problem, the median of its rounds."""
        return np.array([np.median([seconds for seconds, _ in answers]) for answers in self.rounds])


class Grader:
    """What an answer is worth, by code that no peer shares."""

    def __init__(self, robot: ikde.Robot, twin: Twin, urdf: Path) -> None:
        self.robot, self.twin = robot, twin
        self.model = pin.buildModelFromUrdf(str(urdf))
        self.data = self.model.createData()
        self.geometry = read_spheres(robot, self.model, urdf)
        self.geometry_data = pin.GeometryData(self.geometry)

    def find_fault(self, q: np.ndarray, problem: Problem) -> str | None:
        """What is wrong with joint values [N], None if nothing."""
        robot, twin = self.robot, self.twin
        values = dict(zip(robot.joint_names, q.tolist(), strict=True))
        if np.any(q < robot.lower - TOUCH_M) or np.any(q > robot.upper + TOUCH_M):
            return "outside the limits"
        T = twin.place_links(values)[twin.tool]
        off_m, off_rad = np.linalg.norm(T[:3, 3] - problem.p), angle_between(T[:3, :3], problem.R)
        if off_m > TOLERANCE[0] + TOUCH_M or off_rad > TOLERANCE[1] + TOUCH_M:
            return f"{off_m:.1e} m and {off_rad:.1e} rad from the target"
        gap, link, name = twin.nearest(values, problem.scene)
        if gap <= -TOUCH_M:
            return f"{link} is {gap * 1e3:.3f} mm from {name}"
        if pin.computeCollisions(self.model, self.data, self.geometry, self.geometry_data, q, True):
            return "the robot touches itself"
        return None


def read_problem(pair: ScenePair, robot: ikde.Robot, twin: Twin) -> Problem:
    """Solids in the world, and the tool's pose at the request's goal."""
    scene, placed = read_yaml(pair.scene), twin.place_links({})
    goal = read_goal(read_request(pair.request), robot)
    T_tool = twin.place_links(dict(zip(robot.joint_names, goal.tolist(), strict=True)))[twin.tool]
    solids = []
    for entry in scene["world"]["collision_objects"]:
        T = placed.get(entry.get("header", {}).get("frame_id", ""), np.eye(4)) @ read_pose(entry.get("pose"))
        for shape, pose in zip(entry["primitives"], entry["primitive_poses"], strict=True):
            size = shape["dimensions"] if shape["type"] == "box" else shape["dimensions"][::-1]
            solids.append(Solid(kind=shape["type"], size_m=tuple(size), T_world_solid=T @ read_pose(pose)))
    return Problem(name=pair.name, scene=scene, solids=solids, p=T_tool[:3, 3].copy(), R=T_tool[:3, :3].copy())


def run_robot(folder: Path, clients: list[Client], options: argparse.Namespace) -> tuple[str, dict[str, Any]]:
    """All peers on the problems of one robot: its name, and a row a peer."""
    name, robot, twin = read_robot(folder)
    pairs = [pair for pairs in find_pairs(folder).values() for pair in pairs][:: options.every]
    problems, random = [read_problem(pair, robot, twin) for pair in pairs], np.random.default_rng(SEED)
    random.shuffle(problems)
    tallies = [Tally() for _ in clients]
    with tempfile.TemporaryDirectory() as folder_of_files:
        urdf, mjcf = Path(folder_of_files) / "robot.urdf", Path(folder_of_files) / "robot.xml"
        urdf.write_text(ikde.format_urdf(robot))
        mjcf.write_text(ikde.format_mjcf(robot))
        told = dict(zip(("position_tolerance_m", "orientation_tolerance_rad"), TOLERANCE, strict=True))
        setup = Setup(
            robot=robot, urdf=urdf, mjcf=mjcf, kind="pose", seed=SEED, check="coal", clock=time.process_time, **told
        )
        for client, tally in zip(clients, tallies, strict=True):
            prepare(client, tally, setup, problems, options)
        grader = Grader(robot, twin, urdf)
        for problem in problems:
            for k in random.permutation(len(clients)):
                take_turn(clients[k], tallies[k], problem, grader, options)
    ours = dict(zip(tallies[0].names, tallies[0].times_s, strict=True))
    rows = {c.entry.name: summarise(tally, ours) for c, tally in zip(clients, tallies, strict=True)}
    return name, {"problems": len(problems), "rows": rows}


def prepare(client: Client, tally: Tally, setup: Setup, problems: list[Problem], options: argparse.Namespace) -> None:
    """A peer with the robot loaded, after a few problems that do not count."""
    p, R = (np.array([getattr(problem, key) for problem in problems[:WARM]]) for key in ("p", "R"))
    try:
        tally.prepare = client.prepare(setup, p, R, 0.2)
        for problem in problems[:WARM]:
            client.meet(problem.solids, (problem.p, problem.R), options.limit, options.rounds)
    except Lost as lost:
        tally.lost = str(lost)
    print(f"  {client.entry.name}: {tally.lost or 'ready'}", flush=True)


def take_turn(client: Client, tally: Tally, problem: Problem, grader: Grader, options: argparse.Namespace) -> None:
    """One peer's answers to one problem, unless its time is used up; each of its answers is graded."""
    if tally.lost is not None or tally.spent_s > options.share:
        return
    started = time.perf_counter()
    try:
        load_s, answers = client.meet(problem.solids, (problem.p, problem.R), options.limit, options.rounds)
    except Lost as lost:
        tally.lost, load_s, answers = str(lost), 0.0, [(time.perf_counter() - started, None)]
    faults = [grader.find_fault(q, problem) for _, q in answers if q is not None]
    tally.wrong += [f"{problem.name}: {fault}" for fault in faults if fault]
    late = [seconds > options.limit for seconds, _ in answers]
    tally.solved.append(len(faults) == len(answers) and not any(faults) and not any(late))
    tally.names.append(problem.name)
    tally.rounds.append(answers)
    tally.load_s.append(load_s)


def summarise(tally: Tally, ours: dict[str, float]) -> dict[str, Any]:
    """As plain data; `ratio` is of medians over the problems that both were asked."""
    if not tally.names:
        return {"lost": tally.lost}
    times, common = tally.times_s, [name in ours for name in tally.names]
    beside = np.median([ours[name] for name in tally.names if name in ours] or [np.nan])
    worst = [max(seconds for seconds, _ in answers) for answers in tally.rounds]
    firsts = [answers[0][0] for answers in tally.rounds]
    row = {
        "asked": len(times),
        "solved": sum(tally.solved),
        "ms": {key: round_ms(np.percentile(times, share)) for key, share in SHARES.items()},
        "ms_worst_round": round_ms(max(worst)),
        "ms_first": round_ms(np.median(firsts)),
        "ms_load": round_ms(np.median(tally.load_s)),
        "ratio": float(f"{np.median(times[common]) / beside:.3g}"),
        "wrong": len(tally.wrong),
        "wrong_first": tally.wrong[:5],
        "prepare": {key: round(float(value), 3) for key, value in tally.prepare.items()},
    }
    return row if tally.lost is None else {**row, "lost": tally.lost}


def round_ms(seconds: float) -> float:
    """Three digits."""
    return float(f"{1e3 * seconds:.3g}")


def start(only: list[str] | None) -> tuple[list[Client], dict[str, str]]:
    """Peers that are there, and why others are not."""
    clients, missing = [], {}
    for entry in IN_SCENES:
        if only is None or any(word in f"{entry.adapter} {entry.name}" for word in ["ikde:", *only]):
            try:
                clients.append(Client(EVERY.index(entry)))
            except Lost as lost:
                missing[entry.name] = str(lost)
    return clients, missing


def show(name: str, found: dict[str, Any]) -> None:
    """Prints the rows of a robot."""
    print(f"{name}, {found['problems']} problems")
    for peer, row in sorted(found["rows"].items(), key=lambda item: item[1].get("ms", {}).get("median", np.inf)):
        if "ms" not in row:
            print(f"  {peer}: {row['lost']}")
            continue
        marks = " / ".join(f"{row['ms'][key]:g}" for key in SHARES)
        more = f"first {row['ms_first']:g}, load {row['ms_load']:g}, x{row['ratio']:g}, wrong {row['wrong']}"
        print(f"  {peer}: {row['solved']} of {row['asked']}, ms {marks}; {more} {row.get('lost', '')}", flush=True)
        print("".join(f"    {line}\n" for line in row["wrong_first"]), end="")


def main() -> None:
    """Reads the options, asks all peers for every robot, writes the record."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--every", type=int, default=6, help="each so manieth problem; default 6")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--limit", type=float, default=2.0, help="seconds a target")
    parser.add_argument("--share", type=float, default=8.0, help="seconds a peer and robot")
    parser.add_argument("--only", nargs="+", metavar="NAME", help="beside ikde")
    parser.add_argument("--out", type=Path, default=RESULTS)
    options = parser.parse_args()
    clients, missing = start(options.only)
    record = {
        "machine": describe(),
        "options": {
            "tolerance": TOLERANCE,
            **{key: vars(options)[key] for key in ("every", "rounds", "limit", "share")},
        },
        "coal": version("coal"),
        "peers": {c.entry.name: {"use": c.entry.use, "versions": c.versions} for c in clients},
        "missing": missing,
        "robots": {},
    }
    for folder in options.folders:
        name, found = run_robot(folder, clients, options)
        record["robots"][name] = found
        show(name, found)
        options.out.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    for client in clients:
        client.close()


if __name__ == "__main__":
    main()
