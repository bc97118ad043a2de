"""Cases of `benchmarks/versus.py`: what cannot be reached, and what may not move, one target at a time from Python.

python -m benchmarks.versus benchmarks/no_answer.py --before ../other_checkout
"""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from reachable import draw_configurations, make_target
from versus import time_calls

import ikde

ROBOTS = ("qiao2021", "ur5", "panda")
SCARA = Path(__file__).parent / "robots" / "scara.yaml"
TARGETS = 60
FAR = (20.0, 3.0, 1.0)
TILTED = (1.0, 0.0, -1.0)


def cases() -> dict[str, Callable[[], list[float]]]:
    """Far away on each robot, tilted on a SCARA, and with every joint frozen: at the target, and beside it."""
    made = {}
    for name in ROBOTS:
        robot = ikde.load_robot(name)
        drawn = draw_configurations(robot, TARGETS)
        far = [ikde.Target(np.array(FAR) + 0.01 * k) for k in range(TARGETS)]
        made[f"{name}, out of reach"] = _time(robot, far)
        held = [dict(zip(robot.joint_names, q.tolist(), strict=True)) for q in drawn]
        made[f"{name}, all frozen, met"] = _time(robot, [make_target(robot, q, "pose") for q in drawn], held)
        # `lm` alone, since before it was three engines' whole budgets: a minute and a half.
        made[f"{name}, all frozen, not met"] = _time(robot, far[:5], held, method="lm")
    scara = ikde.load_robot(SCARA)
    drawn = draw_configurations(scara, TARGETS)
    places = [make_target(scara, q, "position").p_world_tool for q in drawn]
    tilted = [ikde.Target(p, axis_world_tool=TILTED) for p in places]
    made["scara, out of reach"] = _time(scara, [ikde.Target(FAR)] * TARGETS)
    made["scara, tilted axis"] = _time(scara, tilted[:5], settings=ikde.SolveSettings(restarts=1))
    return made


def _time(
    robot: ikde.Robot, targets: list[ikde.Target], held: list[dict[str, float]] | None = None, **asked: Any
) -> Callable[[], list[float]]:
    def call(k: int) -> object:
        frozen = {"freeze": held[k]} if held else {}
        return ikde.solve(robot, targets[k], stream=k, **frozen, **asked)

    return lambda: time_calls(call, len(targets))
