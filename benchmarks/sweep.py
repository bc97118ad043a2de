"""How many poses that an arm on one further joint does not reach among boxes are proved to have no solution.

python benchmarks/sweep.py [--poses 120]

qiao2021 with one joint of its base free: a rail of a metre, or its yaw. What is proved must not be reached.
"""

import argparse
import time
from collections import Counter
from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

import ikde
from ikde.kernels.arrays import REACHED
from ikde.model.collision_model import CollisionModel
from ikde.model.target import Targets
from ikde.solver.problem import make_problem
from ikde.solver.proof import prove, rule_out
from ikde.solver.search import search
from ikde.solver.settings import SolveSettings
from ikde.solver.sweep import rule_out_by_sweep

LOW, HIGH = [-1, -1, 0.6], [1, 1, 1.6]


def main():
    """A line a joint."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--poses", type=int, default=120)
    count, robot, rng = parser.parse_args().poses, ikde.load_robot("qiao2021"), np.random.default_rng(0)
    boxes = {f"b{k}": {"box": [0.3] * 3, "position": p} for k, p in enumerate(rng.uniform(LOW, HIGH, (8, 3)).tolist())}
    model = CollisionModel.of(robot).in_world(ikde.load_world({"obstacles": boxes}))
    for joint in ("d_x", "q_z"):
        others = {name: 0.0 for name in ("d_x", "d_y", "q_z") if name != joint}
        problem = make_problem(robot, SolveSettings(), collision=model, near=None, freeze=others)
        rail = np.arange(9) == (0 if joint == "d_x" else 9)
        ends = {"lower": np.where(rail, -0.5, problem.lower), "upper": np.where(rail, 0.5, problem.upper)}
        report(joint, replace(problem, **ends), count, rng)


def report(joint, problem, count, rng):
    """What became of poses anywhere about the robot, and the time of a proof, or of giving up."""
    found, took = Counter(), []
    for p in rng.uniform([-1, -1, 0.3], HIGH, (count, 3)):
        target = ikde.Target(tuple(p), R_world_tool=Rotation.random(rng=rng).as_matrix())
        if prove(problem, target) != (0.0, 0.0) or rule_out(problem, Targets.of([target]))[0] >= 0:
            found["by bounds or by the tool"] += 1
            continue
        started = time.perf_counter()
        swept = rule_out_by_sweep(problem, target)
        seconds = time.perf_counter() - started
        is_reached = search(problem, [target], seed=0, streams=[0]).counts[0, REACHED] == 1
        assert not (swept and is_reached)
        took += [] if is_reached else [seconds]
        found["proved" if swept else "reached" if is_reached else "open"] += 1
    print(joint, dict(found), f"ms: median {1e3 * np.median(took):.0f}, max {1e3 * max(took):.0f}")


if __name__ == "__main__":
    main()
