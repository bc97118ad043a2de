"""The walks of benchmarks/servo.py with mink and Pink: error, limits, collisions, standing still, time.

    .venv-peers/bin/python benchmarks/peers/servo.py              # benchmarks/results/peer_servo.json
    .venv-peers/bin/python benchmarks/peers/servo.py --walks 3 --out try.json

A UR5 among 20 boxes and cylinders follows targets of 10 ms, a step of each library a target. Accelerations are not
limited, since neither keeps any. mink keeps its collision limit against all of the world, Pink its self-collision
barrier, with the solids among its pairs. Plain numpy grades all alike: speeds, ranges, collisions at every step. Times
are of the processor.
"""

import argparse
import json
import sys
import tempfile
import time
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).parent.parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "benchmarks")]

from adapters.differential import Manner, Program  # noqa: E402
from adapters.mink_ import MinkProgram  # noqa: E402
from adapters.pink_ import PinkProgram  # noqa: E402
from machine import describe  # noqa: E402
from protocol import Solid  # noqa: E402

import ikde  # noqa: E402
from benchmarks.servo import DT_S, STEPS, Walk, count_frozen, draw  # noqa: E402
from ikde.solver.plain import compute_gaps  # noqa: E402
from ikde.solver.verify import compute_orientation_errors  # noqa: E402

RESULTS = ROOT / "benchmarks" / "results" / "peer_servo.json"
CASE = ("ur5", "omnidirectional", False)
PACKAGES = ("ikde", "mink", "mujoco", "pin-pink", "pin", "daqp")


def list_solids(world: ikde.World) -> list[Solid]:
    """Its boxes and cylinders."""
    solids = []
    for obstacle in world.active:
        T = np.eye(4)
        T[:3] = obstacle.T_world_obstacle
        solids.append(Solid(kind=obstacle.solids[0].kind, size_m=obstacle.solids[0].size_m, T_world_solid=T))
    return solids


def run_program(program: Program, walk: Walk) -> tuple[np.ndarray, np.ndarray, int]:
    """Configurations [M + 1, N], seconds [M], and steps without an answer."""
    configuration = program.begin(walk.robot.home)
    R = program.rotation(configuration).copy()
    q, seconds, unanswered = [configuration.q.copy()], np.empty(len(walk.targets)), 0
    for k, target in enumerate(walk.targets):
        began = time.thread_time()
        goal = target.R_world_tool if target.kind == "pose" else R
        program.task.set_target(program.pose(target.p_world_tool, goal))
        v = program.step(configuration)
        if v is None:
            unanswered += 1
        else:
            configuration.integrate_inplace(v, DT_S)
        seconds[k] = time.thread_time() - began
        q.append(configuration.q.copy())
    return np.array(q), seconds, unanswered


def run_servo(walk: Walk) -> tuple[np.ndarray, np.ndarray, int]:
    """The same of ikde."""
    servo = ikde.Servo(walk.robot, walk.robot.home, world=walk.world, limits=walk.limits, drive=walk.drive)
    q, seconds = [walk.robot.home], np.empty(len(walk.targets))
    for k, target in enumerate(walk.targets):
        began = time.thread_time()
        q.append(servo.step(target, DT_S).q)
        seconds[k] = time.thread_time() - began
    return np.array(q), seconds, 0


def make_program(kind: type, walk: Walk, files: dict[str, Path]) -> Program:
    """As for paths (`tracks.py`), with solids."""
    turn = 10.0 if walk.kind == "pose" else 0.0
    manner = Manner(
        dt_s=DT_S,
        position_cost=50.0,
        orientation_cost=turn,
        approach=0.4,
        range_gain=0.95,
        speed=walk.limits.speed,
        solver_options={"primal_tol": 1e-12},
    )
    solids = list_solids(walk.world)
    if kind is MinkProgram:
        return MinkProgram(walk.robot, files["mjcf"], manner, solids)
    program = PinkProgram(walk.robot, files["urdf"], manner)
    program.surround(solids)
    return program


def grade(walk: Walk, q: np.ndarray, seconds: np.ndarray, unanswered: int) -> dict[str, Any]:
    """Figures of a walk, by plain numpy."""
    model = ikde.CollisionModel.of(walk.robot).in_world(walk.world)
    T = ikde.forward(walk.robot, q[1:])[walk.robot.tool]
    targets = ikde.Targets.of(walk.targets)
    clear = compute_gaps(model, q[1:]).min(axis=1)
    speed = np.abs(np.diff(q, axis=0)) / DT_S
    outside = (q[1:] < walk.robot.lower - 1e-9) | (q[1:] > walk.robot.upper + 1e-9)
    return {
        "errors_m": np.linalg.norm(T[:, :3, 3] - targets.p_world_tool, axis=1),
        "angles_rad": compute_orientation_errors(targets, T[:, :3, :3]),
        "colliding": int((clear <= model.limit_m).sum()),
        "least_m": float(clear.min()),
        "too_fast": int((speed > walk.limits.speed * (1 + 1e-6)).any(axis=1).sum()),
        "outside": int(outside.any(axis=1).sum()),
        "frozen": count_frozen(T[::5, :3, 3], targets.p_world_tool[::5]),
        "unanswered": unanswered,
        "seconds": seconds,
    }


def summarise(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Of all walks."""
    errors, angles, seconds = (
        np.concatenate([row[key] for row in rows]) for key in ("errors_m", "angles_rad", "seconds")
    )
    names = ("colliding", "too_fast", "outside", "frozen", "unanswered")
    counts = {name: int(sum(row[name] for row in rows)) for name in names}
    return {
        "steps": len(errors),
        "position_error_mm": {f"p{p}": round(1e3 * float(np.percentile(errors, p)), 4) for p in (50, 95)},
        "orientation_error_rad": {f"p{p}": round(float(np.percentile(angles, p)), 5) for p in (50, 95)},
        "least_clearance_mm": round(1e3 * min(row["least_m"] for row in rows), 4),
        **counts,
        "us_of_processor": {f"p{p}": round(1e6 * float(np.percentile(seconds, p)), 1) for p in (50, 99)},
    }


def main() -> None:
    """All walks by all three."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--walks", type=int, default=40)
    parser.add_argument("--steps", type=int, default=STEPS)
    parser.add_argument("--out", type=Path, default=RESULTS)
    options = parser.parse_args()
    found: dict[str, list[dict[str, Any]]] = {"ikde": [], "mink": [], "Pink": []}
    with tempfile.TemporaryDirectory() as folder:
        robot = ikde.load_robot(CASE[0])
        files = {"urdf": Path(folder) / "robot.urdf", "mjcf": Path(folder) / "robot.xml"}
        files["urdf"].write_text(ikde.format_urdf(robot))
        files["mjcf"].write_text(ikde.format_mjcf(robot))
        for seed in range(options.walks):
            walk = draw(seed, options.steps, CASE)
            if walk.kind == "axis":  # neither has a task for it
                continue
            runs = {
                "ikde": lambda walk=walk: run_servo(walk),
                "mink": lambda walk=walk: run_program(make_program(MinkProgram, walk, files), walk),
                "Pink": lambda walk=walk: run_program(make_program(PinkProgram, walk, files), walk),
            }
            for name, run in runs.items():
                found[name].append(grade(walk, *run()))
            print(f"walk {seed} ({walk.kind})", flush=True)
    record = {"machine": describe(), "versions": {name: version(name) for name in PACKAGES if name != "ikde"}}
    record |= {"walks": len(found["ikde"]), "ways": {name: summarise(rows) for name, rows in found.items()}}
    options.out.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    print(json.dumps(record["ways"], indent=1))


if __name__ == "__main__":
    main()
