"""Cases of `benchmarks/versus.py`: one target at a time from Python.

    python -m benchmarks.versus benchmarks/call.py --before ../other_checkout --out benchmarks/results/call.json

Plain, in a hot loop and after a pause; with another `near` at each call; with another value of a frozen joint; and out
of reach.
"""

import time
from collections.abc import Callable
from typing import Any

import numpy as np
from reachable import draw_configurations, make_target
from versus import time_calls

import ikde

ROBOTS = ("qiao2021", "ur5", "panda")
KINDS = ("position", "axis", "pose")
TARGETS, PAUSED, SLOW = 400, 40, 40
PAUSE_S = 0.005
NEAR_RAD = 0.2  # or m: what each joint differs by, in the mean
FROZEN = {"qiao2021": ("d_x", "q2"), "ur5": ("elbow_joint",), "panda": ("joint3",)}
FAR = (0.3, 9.0, 1.0)

Case = Callable[[], list[float]]


def cases() -> dict[str, Case]:
    """A case for each robot and what is asked of it."""
    made: dict[str, Case] = {}
    for name in ROBOTS:
        robot = ikde.load_robot(name)
        drawn = draw_configurations(robot, TARGETS)
        for kind in KINDS:
            made[f"{name} {kind}"] = _hot(robot, [make_target(robot, q, kind) for q in drawn])
        poses = [make_target(robot, q, "pose") for q in drawn]
        made[f"{name} pose, after 5 ms of sleep"] = _paused(robot, poses)
        rng = np.random.default_rng(1)
        nears = [{"near": np.clip(q + rng.normal(0.0, NEAR_RAD, len(q)), robot.lower, robot.upper)} for q in drawn]
        for kind in ("position", "pose"):
            targets = [make_target(robot, q, kind) for q in drawn]
            made[f"{name} {kind}, another near each time"] = _hot(robot, targets, nears)
        for joint in FROZEN[name]:
            k = robot.joint_names.index(joint)
            frozen = [{"freeze": {joint: float(q[k])}} for q in drawn[:SLOW]]
            targets = [make_target(robot, q, "position") for q in drawn[:SLOW]]
            made[f"{name} position, {joint} frozen elsewhere each time"] = _hot(robot, targets, frozen)
        made[f"{name} position, out of reach"] = _hot(
            robot, [ikde.Target(np.array(FAR) + 1e-3 * k) for k in range(SLOW)]
        )
    return made


def _hot(robot: ikde.Robot, targets: list[ikde.Target], asked: list[dict[str, Any]] | None = None) -> Case:
    every = asked or [{}] * len(targets)
    return lambda: time_calls(lambda k: ikde.solve(robot, targets[k], stream=k, **every[k]), len(targets))


def _paused(robot: ikde.Robot, targets: list[ikde.Target]) -> Case:
    def run() -> list[float]:
        spent = []
        for k in range(PAUSED):
            time.sleep(PAUSE_S)
            started = time.perf_counter_ns()
            ikde.solve(robot, targets[k], stream=k)
            spent.append((time.perf_counter_ns() - started) * 1e-3)
        return spent

    return run
