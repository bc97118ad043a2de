"""The same tool paths followed by ikde, Pink and mink: error, limit violations, collisions and time side by side.

    .venv-peers/bin/python benchmarks/peers/tracks.py     # ten minutes: benchmarks/results/peer_tracks.json
    .venv-peers/bin/python benchmarks/peers/tracks.py --tasks task3 --rounds 1 --starts 2 --out try.json

All begin where ikde's `continuation` chooses to begin with an omnidirectional base; `verify_track` and `certify` grade
all alike. In each round every way follows the whole path, in a new order; a sample's time is its median over the
rounds. Then all begin at random free configurations at the first pose: from how many do they get to the end? README.md
says how each library is used.
"""

import argparse
import json
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from adapters.differential import Manner
from adapters.following import Followed, follow
from adapters.mink_ import MinkProgram
from adapters.pink_ import PinkProgram

import ikde
from ikde.io.plan_file import load_track
from ikde.model.base_motion import Drive
from ikde.track import trajectory
from ikde.track.comparison import draw_random_starts, measure
from ikde.track.follow_path import grade_motion
from ikde.track.follower import Follower, make_follower
from ikde.track.plan import TrackPlan
from ikde.track.run import run_track
from ikde.track.settings import NULLSPACE_WEIGHTS
from ikde.track.summary import summarise_track
from ikde.track.verify_track import verify_track

ROOT = Path(__file__).parent.parent.parent
RESULTS = ROOT / "benchmarks" / "results" / "peer_tracks.json"
TASKS = ("task1", "task2", "task3", "task4")
PACKAGES = ("ikde", "pin-pink", "pin", "mink", "mujoco", "daqp", "qpsolvers")
MAX_STEPS = 10
DEFAULT_GAIN = 0.85  # of mink's CollisionAvoidanceLimit
NEAR_M, NEAR_RAD = 1e-3, 1e-2  # what counts as followed from a random start
TIMES = {"median": 50, "p99": 99, "max": 100}
STARTED = time.perf_counter()


@dataclass(frozen=True, kw_only=True)
class Way:
    """One way to follow a path."""

    name: str
    run: Callable[[np.ndarray], Followed]
    """From a start [N]."""
    drive: Drive = "omnidirectional"


def make_ways(plan: TrackPlan, files: dict[str, Path]) -> list[Way]:
    """Those that are timed."""
    drives: tuple[tuple[str, Drive], ...] = (("ikde", "omnidirectional"), ("ikde, differential", "differential"))
    ways = [Way(name=name, run=partial(run_ikde, plan, drive), drive=drive) for name, drive in drives]
    usual, split = make_manner(plan, is_split=False), make_manner(plan, is_split=True)
    many = f"up to {MAX_STEPS} steps"
    for name, kind, manner, steps in (
        ("Pink, one step", PinkProgram, usual, 1),
        (f"Pink, {many}", PinkProgram, split, MAX_STEPS),
        ("mink, one step", MinkProgram, usual, 1),
        (f"mink, {many}", MinkProgram, split, MAX_STEPS),
        ("mink, one step, default gain", MinkProgram, replace(usual, approach=DEFAULT_GAIN / usual.dt_s), 1),
    ):
        program = kind(plan.robot, files["urdf" if kind is PinkProgram else "mjcf"], manner)
        run = partial(follow, program, plan.path, dt_s=manner.dt_s, most_steps=steps)
        ways.append(Way(name=name, run=run))
    return ways


def make_manner(plan: TrackPlan, *, is_split: bool) -> Manner:
    """How both programs are posed: what followed best of what was tried."""
    turn = {"free": 0.0, "axis": (10.0, 10.0, 0.0), "pose": 10.0}[plan.path.orientation]
    return Manner(
        dt_s=plan.path.dt_s,
        position_cost=50.0,
        orientation_cost=turn,
        posture_cost=0.01,
        approach=0.4,
        range_gain=0.95,
        speed=plan.limits.speed,
        is_split=is_split,
        solver_options={"primal_tol": 1e-12},  # its default, 1e-6, lets speeds exceed their limit by 1e-4 of it
    )


def run_ikde(plan: TrackPlan, drive: Drive, start: np.ndarray) -> Followed:
    """`run_track`; the time of a sample is what `Trajectory.seconds` says."""
    motion = run_track(plan, drive=drive, start=start)
    return Followed(q=motion.q, seconds=motion.seconds)


def run_greedy(follower: Follower, start: np.ndarray) -> Followed:
    """Its steps alone, as it tries them first: from sample to sample, no backtracking."""
    rollout = follower.begin(start, np.array(NULLSPACE_WEIGHTS[0])).resume()
    return Followed(q=rollout.q, seconds=np.empty(0))


def run_task(plan: TrackPlan, ways: list[Way], rounds: int, rng: np.random.Generator) -> dict[str, Any]:
    """All ways from the start that ikde chooses, in rounds."""
    for drive in ("differential", "omnidirectional"):
        run_track(plan, drive=drive)  # compiles
    began = time.perf_counter()
    start = run_track(plan, drive="omnidirectional").q[0]
    chosen_s = time.perf_counter() - began
    runs: dict[str, list[Followed]] = {way.name: [] for way in ways}
    for _ in range(rounds):
        for k in rng.permutation(len(ways)):
            runs[ways[k].name].append(ways[k].run(start))
    figures = {way.name: grade(plan, way, runs[way.name]) for way in ways}
    for name, row in figures.items():
        say(f"{plan.name}: {name}: {row['reached_points']} reached, {row['ms']['median']:.3g} ms")
    return {"name": plan.name, "points": plan.path.samples, "run_track_s": round(chosen_s, 3), "ways": figures}


def grade(plan: TrackPlan, way: Way, runs: list[Followed]) -> dict[str, Any]:
    """The judge's figures of a motion, and times in the middle of its rounds."""
    assert all(np.array_equal(run.q, runs[0].q) for run in runs), f"{way.name}: another motion in another round"
    first, seconds = runs[0], np.median([run.seconds for run in runs], axis=0)
    motion = trajectory.Followed(q=first.q, stop=None, seconds=seconds, search_seconds=float(seconds.sum()))
    graded = grade_motion(replace(plan, drive=way.drive), motion)
    error = graded.error_m[1:]
    figures = measure(summarise_track(plan.collision, graded))
    return {
        **{key: figures[key] for key in figures if key not in ("median_s", "p99_s", "stop")},
        "points_within_1_mm": int((np.linalg.norm(error, axis=1) <= NEAR_M).sum()),
        "rms_axis_errors_mm": (1e3 * np.sqrt((error**2).mean(axis=0))).tolist(),
        "largest_axis_errors_mm": (1e3 * np.abs(error).max(axis=0)).tolist(),
        "steps": first.steps,
        "unanswered": first.unanswered,
        "ms": {name: 1e3 * float(np.percentile(seconds, p)) for name, p in TIMES.items()},
    }


def count_followed(plan: TrackPlan, ways: list[Way], count: int) -> dict[str, Any]:
    """From how many random starts each way gets to the end, and what was wrong with the rest."""
    follower = make_follower(plan.with_changes(drive="omnidirectional"))
    starts = draw_random_starts(plan, count, plan.seed)
    greedy = Way(name="ikde, its steps alone", run=partial(run_greedy, follower))
    record: dict[str, Any] = {"starts": len(starts), "ways": {}}
    for way in (ways[0], ways[1], greedy, *ways[2:]):
        began = time.perf_counter()
        found = Counter(find_fault(plan, way, way.run(start)) for start in starts)
        record["ways"][way.name] = {**found, "seconds": round(time.perf_counter() - began, 2)}
        say(f"{plan.name}: from random starts: {way.name}: {dict(found)}")
    return record


def find_fault(plan: TrackPlan, way: Way, followed: Followed) -> str:
    """`followed`, or the first of what is wrong: too short, colliding, beyond a limit, too far from the path."""
    near = replace(plan.limits, position_error_m=NEAR_M, orientation_error_rad=NEAR_RAD)
    broken = verify_track(plan.collision, plan.path, followed.q, drive=way.drive, limits=near).violations
    if len(followed.q) <= plan.path.samples:
        return "ended early"
    if broken.collision:
        return "collided"
    if broken.total > broken.error:
        return "beyond a limit"
    return "off the path" if broken.error else "followed"


def write_robot(robot: ikde.Robot, folder: Path) -> dict[str, Path]:
    """The robot as files for the libraries."""
    files = {"urdf": folder / "robot.urdf", "mjcf": folder / "robot.xml"}
    files["urdf"].write_text(ikde.format_urdf(robot))
    files["mjcf"].write_text(ikde.format_mjcf(robot))
    return files


def say(text: str) -> None:
    """Progress on stderr."""
    print(f"[{time.perf_counter() - STARTED:4.0f} s] {text}", file=sys.stderr, flush=True)


def read_options() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tasks", nargs="+", choices=TASKS, default=TASKS)
    parser.add_argument("--rounds", type=int, default=3, help="times that every way follows a path for its times")
    parser.add_argument("--starts", type=int, default=15, help="random starts a task")
    parser.add_argument("--seed", type=int, default=1, help="of the order in a round")
    parser.add_argument("--out", type=Path, default=RESULTS)
    return parser.parse_args()


def describe() -> dict[str, Any]:
    """What it ran on, as benchmarks/machine.py says."""
    sys.path.append(str(ROOT / "benchmarks"))
    from machine import describe

    return describe()


def main() -> None:
    """Run, record."""
    options = read_options()
    record: dict[str, Any] = {
        "made": datetime.now(UTC).isoformat(timespec="seconds"),
        "machine": describe(),
        "versions": {package: version(package) for package in PACKAGES},
        "options": {key: getattr(options, key) for key in ("rounds", "starts", "seed")},
        "tasks": {},
        "starts": {},
    }
    rng = np.random.default_rng(options.seed)
    with tempfile.TemporaryDirectory() as folder:
        for task in options.tasks:
            plan = load_track(ROOT / "configs" / "tracks" / f"qiao2022_{task}.yaml")
            ways = make_ways(plan, write_robot(plan.robot, Path(folder)))
            record["tasks"][task] = run_task(plan, ways, options.rounds, rng)
            record["starts"][task] = count_followed(plan, ways, options.starts)
            record["seconds"] = round(time.perf_counter() - STARTED)
            options.out.write_text(json.dumps(record, indent=1) + "\n")


if __name__ == "__main__":
    main()
