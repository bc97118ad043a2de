"""Cases of `benchmarks/versus.py`: one target at a time from Python, plain, in a hot loop and after a pause.

python -m benchmarks.versus benchmarks/call.py --before ../other_checkout
"""

import time
from collections.abc import Callable

from reachable import draw_configurations, make_target
from versus import time_calls

import ikde

ROBOTS = ("qiao2021", "ur5", "panda")
KINDS = ("position", "axis", "pose")
TARGETS = 400
PAUSED = 40
PAUSE_S = 0.005


def cases() -> dict[str, Callable[[], list[float]]]:
    """A case for each robot and kind, hot, and after a pause."""
    made = {}
    for name in ROBOTS:
        robot = ikde.load_robot(name)
        drawn = draw_configurations(robot, TARGETS)
        for kind in KINDS:
            targets = [make_target(robot, q, kind) for q in drawn]
            made[f"{name} {kind}"] = _hot(robot, targets)
            if kind == "pose":
                made[f"{name} {kind}, after 5 ms of sleep"] = _paused(robot, targets)
    return made


def _hot(robot: ikde.Robot, targets: list[ikde.Target]) -> Callable[[], list[float]]:
    return lambda: time_calls(lambda k: ikde.solve(robot, targets[k], stream=k), len(targets))


def _paused(robot: ikde.Robot, targets: list[ikde.Target]) -> Callable[[], list[float]]:
    def run() -> list[float]:
        spent = []
        for k in range(PAUSED):
            time.sleep(PAUSE_S)
            started = time.perf_counter_ns()
            ikde.solve(robot, targets[k], stream=k)
            spent.append((time.perf_counter_ns() - started) * 1e-3)
        return spent

    return run
