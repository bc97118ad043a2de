"""What `near` costs and gives.

    python -m benchmarks.versus benchmarks/near.py --before ../other_checkout --rounds 15
    python -m benchmarks.near [targets]

The first: us a call of `ikde.solve(near=)` in a loop, another `near` each time, which `versus` runs in both checkouts.
The second: us of the descent alone, the motion before and after it, and how much less scipy finds from where it ends.
"""

import sys
import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

import ikde

ROBOTS, KINDS, ANGLES_DEG, CALLS = ("qiao2021", "ur5", "panda"), ("position", "axis", "pose"), (5.0, 30.0), 300
Asked = list[tuple[Any, "ikde.Target"]]


def draw(robot: "ikde.Robot", kind: str, angle_deg: float, count: int) -> Asked:
    """Free configurations, and for each a target that the tool meets so far away, in the mean of the joints."""
    rng, asked = np.random.default_rng(7), []
    while len(asked) < count:
        near = rng.uniform(robot.lower, robot.upper)
        step = rng.standard_normal(len(near))
        q = near + np.radians(angle_deg) * step / np.sqrt(np.mean(step**2))
        q = np.clip(q, robot.lower, robot.upper)
        if not (ikde.check(robot, near).collision or ikde.check(robot, q).collision):
            T = ikde.forward(robot, q)[robot.tool]
            turn = {"position": {}, "axis": {"axis_world_tool": T[:3, 2]}, "pose": {"R_world_tool": T[:3, :3]}}[kind]
            asked.append((near, ikde.Target(T[:3, 3], **turn)))
    return asked


def time_solves(robot: "ikde.Robot", asked: Asked) -> Callable[[], Sequence[float]]:
    """Microseconds of each call."""

    def run() -> list[float]:
        spent, clock = [], time.perf_counter_ns
        for near, target in asked:
            started = clock()
            ikde.solve(robot, target, near=near)
            spent.append((clock() - started) * 1e-3)
        return spent

    return run


def cases() -> dict[str, Callable[[], Sequence[float]]]:
    """For `benchmarks.versus`."""
    found = {}
    for name in ROBOTS:
        robot = ikde.load_robot(name)
        for kind in KINDS:
            for angle in ANGLES_DEG:
                found[f"{name} {kind} {angle:g} deg"] = time_solves(robot, draw(robot, kind, angle, CALLS))
    return found


def measure(name: str, kind: str, angle_deg: float, count: int) -> str:
    """A line about the descent from what `lm` finds."""
    from ikde.kernels.least_motion import reduce_motion
    from ikde.model.pack import pack_targets
    from ikde.solver.engines.engine import make_descent, make_ranges
    from ikde.solver.problem import make_problem, pack_searched
    from ikde.solver.search import search
    from tests.kernels.optimum import find_optimum, motion, room

    robot, spent, before, after, gaps, touching = ikde.load_robot(name), [], [], [], [], 0
    for near, target in draw(robot, kind, angle_deg, count):
        settings = ikde.SolveSettings(method="lm")
        problem = make_problem(robot, settings, collision=None, near=None, freeze=None)
        found = search(problem, [target], seed=0, streams=range(1))
        if not found.metrics.accepted[0]:
            continue
        problem = make_problem(robot, settings, collision=None, near=near, freeze=None)
        arrays = make_ranges(problem), make_descent(problem, kind), problem.weights
        models, targets, times = pack_searched(problem.collision), pack_targets([target]), []
        for _ in range(9):
            q = found.q[0].copy()
            started = time.perf_counter_ns()
            reduce_motion(*models, targets, 0, *arrays, q)
            times.append((time.perf_counter_ns() - started) * 1e-3)
        spent.append(min(times))
        before.append(motion(problem.weights, near, found.q[0]))
        after.append(motion(problem.weights, near, q))
        if room(problem.collision, q).min() < 1e-6:
            touching += 1
        elif len(gaps) < 40:
            gaps.append(after[-1] / find_optimum(problem, target, q) - 1.0)
    us = " / ".join(f"{np.percentile(spent, share):.1f}" for share in (50, 95, 99, 100))
    moved = f"motion {np.median(before):.3f} -> {np.median(after):.3f}"
    worst = f"beyond scipy's {np.median(gaps):.1e}, at most {np.max(gaps):.1e} (of {len(gaps)})"
    return f"{name} {kind} {angle_deg:g} deg: {len(spent)} answers, us {us}; {moved}; {touching} in contact; {worst}"


def main() -> None:
    """A line a robot, kind of target and distance."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    for name in ROBOTS:
        for kind in KINDS:
            for angle in ANGLES_DEG:
                print(measure(name, kind, angle, count), flush=True)


if __name__ == "__main__":
    main()
