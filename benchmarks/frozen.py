"""What frozen joints cost: making their seeds, and the attempts from them, beside a pool drawn for each value.

    python -m benchmarks.frozen [--count 60] [--kind pose] [--robots qiao2021,ur5,panda]

Random targets that can be reached with the joint where it is. `NUMBA_DISABLE_JIT=1` gives the same attempts without
compiling. One line a choice of joints; a pool drawn for each value is of 2,048 configurations.
"""

import argparse
import time
from collections.abc import Iterator

import numpy as np

import ikde
from ikde.kernels.arrays import ATTEMPTS, COUNTS, REACHED, SeedArrays
from ikde.kernels.flat_arguments import flatten_search
from ikde.model.base_motion import find_planar_base
from ikde.model.target import KINDS
from ikde.solver.engines.engine import make_descent, make_ranges
from ikde.solver.engines.pool import _find_narrow, load_kernels, make_seeds
from ikde.solver.problem import Problem, make_problem, pack_searched
from ikde.solver.settings import SolveSettings, choose_settings

MOST = 300
WAYS = {
    "moved": make_seeds,
    "drawn": lambda problem, kind: _find_narrow(
        problem.collision, kind, tuple(problem.lower.tolist()), tuple(problem.upper.tolist())
    ),
}


def list_choices(robot: ikde.Robot) -> Iterator[tuple[int, ...]]:
    """Every joint alone, two of an arm, and of a base all that can be frozen together."""
    base = [k for k in find_planar_base(robot).tolist() if k >= 0]
    arm = [k for k in range(len(robot.joints)) if k not in base]
    yield from ((k,) for k in [*base, *arm])
    yield arm[1], arm[3]
    if base:
        yield from (tuple(base[:2]), (base[0], base[2]), tuple(base), (base[0], arm[1]))


def ask(robot: ikde.Robot, joints: tuple[int, ...], kind: str, count: int) -> Iterator[tuple[Problem, ikde.Target]]:
    """Problems with these joints frozen, and a target that a free configuration meets."""
    rng, settings = np.random.default_rng(7), choose_settings(SolveSettings(), "lm")
    for _ in range(count):
        q = rng.uniform(robot.lower, robot.upper)
        while ikde.check(robot, q).collision:
            q = rng.uniform(robot.lower, robot.upper)
        T = ikde.forward(robot, q)[robot.tool]
        turn = {"position": {}, "axis": {"axis_world_tool": T[:3, 2]}, "pose": {"R_world_tool": T[:3, :3]}}[kind]
        freeze = {robot.joint_names[k]: float(q[k]) for k in joints}
        yield make_problem(robot, settings, collision=None, near=None, freeze=freeze), ikde.Target(T[:3, 3], **turn)


def search(problem: Problem, target: ikde.Target, seeds: SeedArrays, stream: int) -> tuple[int, bool]:
    """Attempts made, and whether the target was reached."""
    kind = KINDS[ikde.Targets.of([target]).kind[0]]
    models = pack_searched(problem.collision)
    block = flatten_search(*models, make_ranges(problem), make_descent(problem, kind), seeds)
    q, score, counts = np.empty(len(problem.lower)), np.full(2, np.inf), np.zeros(COUNTS, dtype=np.int64)
    pairs = np.zeros(len(problem.collision.pairs), dtype=np.int64)
    where = (np.array([KINDS.index(kind)]), target.T_world_tool[None], 0, np.uint64(0), stream, 0, MOST)
    with np.errstate(over="ignore"):
        load_kernels(problem.collision, kind).solve_target(*block, *where, q, score, counts, pairs)
    return int(counts[ATTEMPTS]), bool(counts[REACHED])


def main() -> None:
    """Print both ways, one line a choice of joints."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=60)
    parser.add_argument("--kind", choices=KINDS, default="pose")
    parser.add_argument("--robots", default="qiao2021,ur5,panda")
    given = parser.parse_args()
    print(f"{'':28}" + "".join(f"{way + ': attempts, p95':>24}{'reached':>9}{'seeds us':>10}" for way in WAYS))
    for robot in map(ikde.load_robot, given.robots.split(",")):
        for joints in list_choices(robot):
            line = f"{robot.name} {'+'.join(robot.joint_names[k] for k in joints)}"[:27]
            for make in WAYS.values():
                attempts, reached, seconds = [], 0, []
                for stream, (problem, target) in enumerate(ask(robot, joints, given.kind, given.count)):
                    started = time.perf_counter()
                    seeds = make(problem, given.kind)
                    seconds.append(time.perf_counter() - started)
                    made, is_met = search(problem, target, seeds, stream)
                    attempts.append(made)
                    reached += is_met
                text = f"{np.mean(attempts):.2f}, {np.percentile(attempts, 95):.0f}"
                line = f"{line:28}" if make is make_seeds else line
                line += f"{text:>24}{reached / given.count:>9.1%}{1e6 * np.median(seconds):>10.0f}"
            print(line, flush=True)


if __name__ == "__main__":
    main()
