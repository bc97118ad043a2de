"""`solve_many` by the number of targets and threads, the loop of `solve` beside it, and the memory it takes.

    python -m benchmarks.versus benchmarks/bulk.py --before ../other_checkout [--only "qiao2021 pose"]
    python benchmarks/bulk.py --memory qiao2021 pose 1000000

Of each case a round gives microseconds a target: n at once on one or two threads, or one after the other (`loop`).
Targets are what uniformly drawn configurations reach, the free ones of them. `$IKDE_BULK_MOST` is the largest n, 1e5
unless it says otherwise, and `$IKDE_BULK_OF` keeps one robot and kind. With `--memory`: the largest resident set of one
process in MB, before and after one call.
"""

import os
import resource
import sys
import time
from collections.abc import Callable
from functools import partial

import numpy as np

import ikde
from ikde.solver.plain import compute_gaps  # the one import that is not public: `check` takes one at a time

COUNTS = (10, 30, 100, 1_000, 10_000, 100_000, 1_000_000, 10_000_000)
MOST = int(float(os.environ.get("IKDE_BULK_MOST", "1e5")))
DISTINCT = 2**15  # beyond these the same come again, with other streams: with other starts
OF = os.environ.get("IKDE_BULK_OF", "")  # such as "qiao2021 pose": 1e7 targets of all would not fit
LOOP = 300
LEAST = 2_000  # targets of a round, so that a short call is timed often enough
ROBOTS, KINDS = ("qiao2021", "ur5", "panda"), ("pose", "axis", "position")
CHUNK = 128


def draw(robot: ikde.Robot, kind: str, count: int) -> ikde.Targets:
    """Targets that free configurations reach."""
    rng, collision, free = np.random.default_rng(11), ikde.CollisionModel.of(robot), []
    while len(free) < min(count, DISTINCT):
        Q = rng.uniform(robot.lower, robot.upper, (CHUNK, len(robot.joints)))
        free.extend(Q[(compute_gaps(collision, Q) > collision.limit_m).all(axis=1)])
    T = ikde.forward(robot, np.array(free[: min(count, DISTINCT)]))[robot.tool]
    T = np.concatenate([T] * -(-count // len(T)))[:count]
    asked = {"pose": {"R_world_tool": T[:, :3, :3]}, "axis": {"axis_world_tool": T[:, :3, 2]}, "position": {}}[kind]
    return ikde.Targets(T[:, :3, 3], **asked)


def solve_at_once(robot: ikde.Robot, targets: ikde.Targets, threads: int) -> list[float]:
    """Microseconds a target of one call, as often as it takes to have enough targets."""
    spent, options = [], ikde.BulkOptions(threads=threads)
    for _ in range(max(1, LEAST // len(targets))):
        started = time.perf_counter()
        ikde.solve_many(robot, targets, bulk=options)
        spent.append((time.perf_counter() - started) / len(targets) * 1e6)
    return spent


def solve_in_a_loop(robot: ikde.Robot, targets: list[ikde.Target]) -> list[float]:
    """Microseconds a target, the mean of a loop."""
    started = time.perf_counter()
    for stream, target in enumerate(targets):
        ikde.solve(robot, target, stream=stream)
    return [(time.perf_counter() - started) / len(targets) * 1e6]


def cases() -> dict[str, Callable[[], list[float]]]:
    """What one round of each case runs."""
    counts = [count for count in COUNTS if count <= MOST]
    found: dict[str, Callable[[], list[float]]] = {}
    for name in ROBOTS:
        robot = ikde.load_robot(name)
        for kind in (kind for kind in KINDS if OF in f"{name} {kind}"):
            targets = draw(robot, kind, counts[-1])
            found[f"{name} {kind} loop"] = partial(solve_in_a_loop, robot, list(targets[:LOOP]))
            for count in counts:
                for threads in (1, 2):
                    case = partial(solve_at_once, robot, targets[:count], threads)
                    found[f"{name} {kind} n={count} threads={threads}"] = case
    return found


def measure_memory(name: str, kind: str, count: int) -> None:
    """Print the largest resident set before and after one call, MB."""
    robot = ikde.load_robot(name)
    targets = draw(robot, kind, count)
    ikde.solve_many(robot, targets[:1000])
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    results = ikde.solve_many(robot, targets)
    after = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    print(
        f"{count} targets, {results.reached.sum()} reached: {before / 1024:.0f} MB before, {after / 1024:.0f} MB after"
    )


if __name__ == "__main__":
    _, flag, name, kind, count = sys.argv
    measure_memory(name, kind, int(float(count)))
