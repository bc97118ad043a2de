"""A servo after targets that wander: limits, stops, collisions and times at every step of a thousand walks.

    python benchmarks/servo.py                        # 1,000 walks of 10 s: an hour on one core
    python benchmarks/servo.py --walks 30 --oracle 20 # a few, and an independent quadratic program at some steps

Each walk is drawn from its seed: a world of 20 boxes and cylinders, a target (pose, axis or position) that wanders and
jumps. One walk in twenty is drawn out of reach or into an object. After every step plain numpy, not the kernels, checks
speeds, accelerations and ranges, and the way from where the robot stood to where it would stop: both ends and three
places between, and in each tenth walk the certificate of all of it (`track/certify.py`). Times are those of
`Servo.step`, the Python call included: by the clock, and of the processor, which other work on the machine disturbs
less. Writes benchmarks/results/servo.json.
"""

import argparse
import json
import time
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from machine import describe

import ikde
from ikde.model.robot import Drive
from tests.track.servo_oracle import find_better_step
from tests.track.servo_walks import draw_walk, draw_world, find_offences, limits_of, tool_error

HERE = Path(__file__).parent
RESULTS = HERE / "results" / "servo.json"
DT_S, STEPS, EVERY, CERTIFIED, WRITTEN = 0.01, 1000, 20, 10, 20
KINDS = ("pose", "position", "axis")
CASES: tuple[tuple[str, Drive, bool], ...] = (
    ("ur5", "omnidirectional", True),
    ("qiao2021", "differential", True),
    ("qiao2021", "omnidirectional", True),
    ("ur5", "omnidirectional", False),
)
"""Robot, drive, and whether accelerations are limited, in turn."""
FROZEN_STEPS, FROZEN_M, FAR_M, MOVED_M = 30, 1e-3, 5e-3, 0.02
BETTER_M = 1e-4


@dataclass(frozen=True, kw_only=True)
class Walk:
    """One walk's robot, world and targets."""

    robot: ikde.Robot
    drive: Drive
    limits: ikde.MotionLimits
    world: ikde.World
    kind: str
    targets: list[ikde.Target]
    is_hard: bool


def draw(seed: int, steps: int, case: tuple[str, Drive, bool] | None = None) -> Walk:
    """Walk number `seed`."""
    name, drive, has_acceleration = CASES[seed % len(CASES)] if case is None else case
    robot, rng = ikde.load_robot(name), np.random.default_rng(seed)
    world = draw_world(robot, robot.home, rng, 20, kinds=("box", "cylinder"))
    kind, is_hard = KINDS[seed // len(CASES) % len(KINDS)], seed % EVERY == seed // EVERY % len(CASES)
    into = world.obstacles[int(rng.integers(20))].T_world_obstacle[:, 3] if is_hard and seed // EVERY % 2 else None
    away_m = 1.5 if is_hard and into is None else 0.0
    targets = draw_walk(robot, robot.home, rng, steps, DT_S, kind=kind, away_m=away_m, into=into)
    limits = limits_of(robot, has_acceleration)
    return Walk(robot=robot, drive=drive, limits=limits, world=world, kind=kind, targets=targets, is_hard=is_hard)


def follow(walk: Walk, oracle_every: int, *, certifies: bool = True) -> dict[str, Any]:
    """All its steps, and what is wrong with them."""
    servo = ikde.Servo(walk.robot, walk.robot.home, world=walk.world, limits=walk.limits, drive=walk.drive)
    steps, seconds, cpu, judged = [], np.empty(len(walk.targets)), np.empty(len(walk.targets)), Counter[str]()
    for k, target in enumerate(walk.targets):
        asks = oracle_every > 0 and k % oracle_every == oracle_every - 1 and walk.drive == "omnidirectional"
        before = tool_error(walk.robot, servo.q, target, servo.rotation_length_m) if asks else 0.0
        better_m = find_better_step(servo, target, DT_S, servo.rotation_length_m) if asks else 0.0
        began, began_cpu = time.perf_counter(), time.thread_time()
        steps.append(servo.step(target, DT_S))
        cpu[k], seconds[k] = time.thread_time() - began_cpu, time.perf_counter() - began
        if better_m > BETTER_M:
            lowers = tool_error(walk.robot, steps[-1].q, target, servo.rotation_length_m) < before
            judged["lowered" if lowers else ("named" if steps[-1].held_by else "neither")] += 1
    tools = np.array([ikde.forward(walk.robot, step.q)[walk.robot.tool][:3, 3] for step in steps[::5]])
    return {
        "offences": find_offences(servo, walk.robot.home, steps, DT_S, walk.drive, certifies=certifies),
        "seconds": seconds,
        "cpu_seconds": cpu,
        "errors_m": np.array([step.error_m for step in steps]),
        "position_errors_m": np.array([step.position_error_m for step in steps]),
        "held": Counter("nothing" if step.held_by is None else step.held_by.kind for step in steps),
        "braking": sum(step.is_braking for step in steps),
        "not_proved": sum(not step.stop_is_free for step in steps),
        "contacts": sum(step.contact is not None for step in steps),
        "clearance_m": min(step.clearance_m for step in steps),
        "frozen": count_frozen(tools, np.array([target.p_world_tool for target in walk.targets[::5]])),
        "oracle": judged,
    }


def count_frozen(tools: np.ndarray, targets: np.ndarray, every: int = 5) -> int:
    """Spans of 0.3 s in which the tool stays where it is, though its target moves and is not met."""
    count, k, span = 0, 0, FROZEN_STEPS // every
    while k + span < len(tools):
        some, goals = tools[k : k + span + 1], targets[k : k + span + 1]
        is_still = np.linalg.norm(some - some[0], axis=1).max() < FROZEN_M
        is_far = np.linalg.norm(some - goals, axis=1).min() > FAR_M
        moves = np.linalg.norm(goals - goals[0], axis=1).max() > MOVED_M
        is_frozen = is_still and is_far and moves
        count, k = count + int(is_frozen), k + (span if is_frozen else 1)
    return count


def tell_us(seconds: np.ndarray) -> dict[str, float]:
    """Percentiles, us."""
    return {f"p{p:g}": round(1e6 * float(np.percentile(seconds, p)), 1) for p in (50, 90, 99, 99.9)}


def summarise(rows: list[tuple[Walk, dict[str, Any]]]) -> dict[str, Any]:
    """Figures of some walks."""
    times = {name: np.concatenate([row[name][1:] for _, row in rows]) for name in ("seconds", "cpu_seconds")}
    errors = np.concatenate([row["position_errors_m"] for _, row in rows])
    easy = [row["position_errors_m"] for walk, row in rows if not walk.is_hard]
    near = np.concatenate(easy) if easy else errors
    offences = [offence for _, row in rows for offence in row["offences"]]
    return {
        "walks": len(rows),
        "hard_walks": sum(walk.is_hard for walk, _ in rows),
        "steps": len(errors),
        "us": tell_us(times["seconds"]),
        "us_of_processor": tell_us(times["cpu_seconds"]),
        "position_error_mm": {
            name: round(1e3 * float(np.percentile(near, p)), 4) for name, p in (("median", 50), ("p95", 95))
        },
        "offences": offences[:20],
        "steps_that_brake": sum(row["braking"] for _, row in rows),
        "stops_not_proved": sum(row["not_proved"] for _, row in rows),
        "steps_in_contact": sum(row["contacts"] for _, row in rows),
        "least_clearance_mm": 1e3 * min(row["clearance_m"] for _, row in rows),
        "frozen_spans": sum(row["frozen"] for _, row in rows),
        "held_by": dict(sum((row["held"] for _, row in rows), Counter())),
        "oracle": dict(sum((row["oracle"] for _, row in rows), Counter())),
    }


def tell(rows: list[tuple[Walk, dict[str, Any]]]) -> dict[str, Any]:
    """The record of the walks so far."""
    record: dict[str, Any] = {"machine": describe(), "dt_s": DT_S, "all": summarise(rows), "cases": {}}
    for name, drive, has_acceleration in CASES:
        some = [
            (walk, row)
            for walk, row in rows
            if (walk.robot.name, walk.drive, walk.limits.acceleration is not None) == (name, drive, has_acceleration)
        ]
        label = f"{name}, {drive}{'' if has_acceleration else ', any acceleration'}"
        record["cases"] |= {label: summarise(some)} if some else {}
    return record


def main() -> None:
    """Run the walks."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--walks", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0, help="number of the first walk")
    parser.add_argument("--steps", type=int, default=STEPS)
    parser.add_argument("--oracle", type=int, default=0, help="ask the quadratic program at every so many steps")
    parser.add_argument("--out", type=Path, default=RESULTS)
    options = parser.parse_args()
    began, rows = time.perf_counter(), []
    last = options.first + options.walks - 1
    for seed in range(options.first, last + 1):
        walk = draw(seed, options.steps)
        rows.append((walk, follow(walk, options.oracle, certifies=seed % CERTIFIED == 0)))
        if rows[-1][1]["offences"] or seed % 50 == 49:
            print(f"[{time.perf_counter() - began:.0f} s] walk {seed}: {rows[-1][1]['offences']}", flush=True)
        if seed % WRITTEN == WRITTEN - 1 or seed == last:
            options.out.write_text(json.dumps(tell(rows), indent=1) + "\n", encoding="utf-8")
    print(json.dumps(tell(rows)["all"], indent=1))


if __name__ == "__main__":
    main()
