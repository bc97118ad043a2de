"""The memetic search against plain and adaptive differential evolution: share of targets solved over evaluations.

    python benchmarks/memetic.py           # 100 targets a problem, up to 200,000 evaluations each: some minutes
    python benchmarks/memetic.py --quick   # 10 targets, 20,000 evaluations; writes nothing

Every target is the tool's pose in a random configuration that solves the problem, so all can be solved: 1e-5 m and
1e-4 rad, inside the ranges, free of collision, graded by `verify`. An evaluation is one forward kinematics with its
collision check; a damped step counts N + 1. Every search starts again until its evaluations are spent. The plain and
adaptive searches run with attempts as long as published and with attempts of 20,000 evaluations: what solved more,
summed over the logarithm of the evaluations, is drawn; the record holds both. Writes benchmarks/results/memetic.json
and docs/memetic.png.
"""

import argparse
import json
import math
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from machine import describe
from matplotlib.figure import Figure
from rich.console import Console
from rich.progress import track
from rich.table import Table

import ikde
from ikde.kernels.arrays import COUNTS, EVALUATIONS, REACHED, DescentArrays, MemeticArrays
from ikde.kernels.damped import make_descent_workspace, take_step
from ikde.kernels.evolution import solve_lane
from ikde.kernels.memetic import solve_memetic_lane
from ikde.kernels.mutation import MIDPOINT
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot, pack_targets
from ikde.plot import style
from ikde.plot.images import to_png
from ikde.solver.metrics import compute_clearances
from ikde.solver.problem import ROUNDING, Problem, make_problem, pack_search
from ikde.solver.search import usable_cores

RESULTS = Path(__file__).parent / "results" / "memetic.json"
FIGURE = Path(__file__).parent.parent / "docs" / "memetic.png"
SEED = 2024
BUDGETS = (300, 1_000, 3_000, 10_000, 30_000, 100_000, 200_000)
SHORT = 20_000  # evaluations of an attempt, where not as published
CLEARANCE_M = 0.03
MIN_HORIZONTAL = 0.3  # of a tool axis, to be turned horizontal
NEAR_M, NEAR_RAD = 0.2, 0.35  # half-widths of the box about a configuration
FROZEN = {"d_x": 0.0, "d_y": 0.0, "q_z": 0.0}
PAPER = {"population": 50, "weight": 0.5, "crossover": 0.9, "update": "generation"}

Case = tuple[Problem, ikde.Target]


@dataclass(frozen=True)
class Method:
    """A search and its settings: DE of fixed parameters (`plain`), else the memetic kernel."""

    plain: dict[str, Any] | None = None
    memetic: MemeticArrays = field(default_factory=MemeticArrays)
    family: str = ""  # whose NP depends on the number of joints
    published: int = 0  # evaluations of an attempt; 0: those of `memetic`


L_SHADE = MemeticArrays(
    last_population=4,
    memory=6,
    first_crossover=0.5,
    first_share=0.11,
    last_share=0.11,
    archive_share=2.6,
    is_weighted=False,
    polish_share=0.0,
)
JSO = MemeticArrays(last_population=4, first_weight=0.3, polish_share=0.0)
METHODS = {
    "memetic": Method(),
    "rand/1, Deb's rules": Method(plain={"strategy": "rand/1", "collision": "feasibility"}, published=50_050),
    "rand/1, reject": Method(plain={"strategy": "rand/1", "collision": "reject"}, published=50_050),
    "current-to-best/1": Method(plain={"strategy": "current-to-best/1", "collision": "feasibility"}, published=50_050),
    "L-SHADE settings": Method(memetic=L_SHADE, family="l-shade", published=10_000),
    "jSO settings": Method(memetic=JSO, family="jso", published=10_000),
    "memetic, polish alone": Method(memetic=MemeticArrays(polish_share=2.0)),
    "memetic, no polish": Method(memetic=MemeticArrays(polish_share=0.0)),
}
DRAWN = tuple(METHODS)[:6]


# ---- problems


def sample_free(problem: Problem, count: int, rng: np.random.Generator) -> list[np.ndarray]:
    """Random configurations inside the ranges and free of collision."""
    free: list[np.ndarray] = []
    while len(free) < count:
        Q = rng.uniform(problem.lower, problem.upper, (1000, len(problem.lower)))
        free += list(Q[~compute_clearances(problem.collision, Q).collides])
    return free[:count]


def make_pose(robot: ikde.Robot, q: np.ndarray) -> ikde.Target:
    """Where the tool is at `q`."""
    T = ikde.forward(robot, q)[robot.tool]
    return ikde.Target(T[:3, 3], R_world_tool=T[:3, :3])


def make_clear(robot: ikde.Robot, count: int, rng: np.random.Generator) -> list[Case]:
    """30 mm of clearance with a horizontal tool axis: free configurations whose axis damped steps turn horizontal."""
    detector = replace(CollisionModel.of(robot).detector, name="30 mm", safe_distance_m=CLEARANCE_M)
    problem = make_problem(robot, ikde.SolveSettings(), collision=detector, near=None, freeze=None)
    packed, ranges = pack_robot(robot), np.array([problem.lower, problem.upper])
    work = make_descent_workspace(packed, len(robot.joints), 6)
    cases: list[Case] = []
    while len(cases) < count:
        for q in sample_free(problem, 50, rng):
            T = ikde.forward(robot, q)[robot.tool]
            level = math.hypot(T[0, 2], T[1, 2])
            if level < MIN_HORIZONTAL:
                continue
            target = ikde.Target(T[:3, 3], axis_world_tool=T[:3, 2] * [1.0, 1.0, 0.0] / level)
            for _ in range(50):
                errors = take_step(packed, pack_targets([target]), 0, ranges, DescentArrays(), q, work)
            if (
                max(errors) < 1e-9
                and not compute_clearances(CollisionModel(robot=robot, detector=detector), q[None]).collides[0]
            ):
                cases.append((problem, target))
    return cases[:count]


def make_frozen(robot: ikde.Robot, count: int, rng: np.random.Generator) -> list[Case]:
    """Poses with the base frozen at home: six joints, no redundancy."""
    problem = make_problem(robot, ikde.SolveSettings(), collision=None, near=None, freeze=FROZEN)
    return [(problem, make_pose(robot, q)) for q in sample_free(problem, count, rng)]


def make_near(robot: ikde.Robot, count: int, rng: np.random.Generator) -> list[Case]:
    """Poses with every joint kept within 200 mm or 0.35 rad of a free configuration."""
    problem = make_problem(robot, ikde.SolveSettings(), collision=None, near=None, freeze=None)
    width = np.array([NEAR_M if joint.kind == "prismatic" else NEAR_RAD for joint in robot.joints])
    cases = []
    for q in sample_free(problem, count, rng):
        lower, upper = np.maximum(problem.lower, q - width), np.minimum(problem.upper, q + width)
        box = problem.with_ranges(lower, upper)
        cases.append((box, make_pose(robot, sample_free(box, 1, rng)[0])))
    return cases


def make_ordinary(robot: ikde.Robot, count: int, rng: np.random.Generator) -> list[Case]:
    """Poses, all joints free."""
    problem = make_problem(robot, ikde.SolveSettings(), collision=None, near=None, freeze=None)
    return [(problem, make_pose(robot, q)) for q in sample_free(problem, count, rng)]


PROBLEMS = {
    "30 mm of clearance, horizontal axis": make_clear,
    "base frozen": make_frozen,
    "near a configuration": make_near,
    "ordinary poses": make_ordinary,
}


# ---- searches


def settle(method: Method, joints: int, length: int) -> MemeticArrays:
    """The memetic kernel's settings; NP of L-SHADE is 18 D, of jSO 25 ln D sqrt D, D the joints that can move."""
    memetic = method.memetic
    if method.family == "l-shade":
        memetic = memetic._replace(first_population=18 * joints)
    if method.family == "jso":
        memetic = memetic._replace(first_population=round(25.0 * math.log(joints) * math.sqrt(joints)))
    return memetic._replace(evaluations=length) if method.family else memetic


def solve(method: Method, case: Case, stream: int, length: int, budget: int) -> float:
    """Evaluations until a verified solution, or infinity."""
    problem, target = case
    joints = int(np.sum(problem.upper > problem.lower))
    de = {"generations": length // PAPER["population"] - 1, **PAPER, **method.plain}
    chosen = problem.with_settings(method="de", de=de) if method.plain else problem
    search = pack_search(chosen)
    detector = problem.collision.arrays
    detector = detector._replace(safe_distance=detector.safe_distance + ROUNDING)
    q, score = np.zeros(len(problem.lower)), np.full(2, np.inf)
    counts, pairs = np.zeros(COUNTS, dtype=np.int64), np.zeros(detector.pairs.shape[0], dtype=np.int64)
    outputs = (q, score, counts, pairs)
    where = (pack_robot(problem.robot), detector, pack_targets([target]), 0)
    memetic = settle(method, joints, length)
    attempts = np.array([0, math.ceil(budget / (length if method.published else memetic.evaluations))])
    lane = (np.uint64(SEED), np.int64(stream), attempts)
    if method.plain:
        solve_lane(*where, search, *lane, *outputs)
    else:
        solve_memetic_lane(*where, search._replace(repair=MIDPOINT), memetic, DescentArrays(), *lane, *outputs)
    if not counts[REACHED] or counts[EVALUATIONS] > budget:
        return math.inf
    graded = ikde.verify(problem.robot, target, q, settings=chosen.settings, collision=problem.collision.detector)
    inside = bool(np.all((problem.lower <= q) & (q <= problem.upper)))
    if not (graded.accepted and inside):
        raise RuntimeError(f"{method} returned a configuration that is no solution: {graded}")
    return float(counts[EVALUATIONS])


def run(method: Method, cases: Sequence[Case], length: int, budget: int) -> dict[str, Any]:
    """All targets of a problem, on all cores."""
    solve(method, cases[0], 0, length, 1)  # compiles
    with ThreadPoolExecutor(usable_cores()) as pool:
        rows = pool.map(lambda item: solve(method, item[1], item[0], length, budget), list(enumerate(cases)))
        evaluations = np.array(list(rows))
    return {
        "attempt_evaluations": length or method.memetic.evaluations,
        "solved": int(np.isfinite(evaluations).sum()),
        "targets": len(cases),
        "median": quantile(evaluations, 0.5),
        "p95": quantile(evaluations, 0.95),
        "p99": quantile(evaluations, 0.99),
        "max": quantile(evaluations, 1.0),
        "share_solved": {str(b): float(np.mean(evaluations <= b)) for b in BUDGETS if b <= budget},
        "evaluations": sorted(int(e) for e in evaluations[np.isfinite(evaluations)]),
    }


def quantile(evaluations: np.ndarray, share: float) -> int | None:
    """Over all targets, solved or not: None where it is one that was not solved."""
    value = np.quantile(evaluations, share, method="higher")
    return int(value) if np.isfinite(value) else None


def run_best(method: Method, cases: Sequence[Case], budget: int) -> dict[str, Any]:
    """With attempts as long as published and shorter ones: what solves more over the logarithm of the evaluations."""
    if not method.published:
        return run(method, cases, 0, budget)
    joints = len(cases[0][0].robot.joints)
    published = method.published * joints if method.family else method.published
    both = [run(method, cases, length, budget) for length in (published, SHORT)]
    best, other = sorted(both, key=lambda row: -score(row, budget))
    return {**best, "other_length": other}


def score(row: dict[str, Any], budget: int) -> float:
    """Area under the curve of targets solved over the logarithm of the evaluations."""
    return float(np.sum(np.log(budget / np.array(row["evaluations"], dtype=float)))) if row["evaluations"] else 0.0


# ---- the record, the table, the figure


def show(records: dict[str, dict[str, Any]], budget: int) -> None:
    """A table a problem."""
    shown = [b for b in BUDGETS if b <= budget]
    for name, rows in records.items():
        table = Table("search", "attempt", "median", "p95", *(f"≤ {b:,}" for b in shown), title=name)
        for method, row in rows.items():
            numbers = [f"{row[key]:,}" if row[key] is not None else "not" for key in ("median", "p95")]
            shares = [f"{row['share_solved'][str(b)]:.0%}" for b in shown]
            table.add_row(method, f"{row['attempt_evaluations']:,}", *numbers, *shares)
        Console().print(table)


def draw(records: dict[str, dict[str, Any]], budget: int) -> None:
    """Share of targets solved over evaluations, a panel a problem."""
    ticks = matplotlib.ticker.FuncFormatter(lambda value, _: style.format_tick(value))
    with matplotlib.rc_context(style._STYLE):
        figure = Figure(figsize=(8.2, 6.4), layout="constrained")
        panels = figure.subplots(2, 2, sharex=True, sharey=True).ravel()
        for panel, (name, rows) in zip(panels, records.items(), strict=True):
            for k, label in enumerate(DRAWN):
                row = rows[label]
                x = np.concatenate([[50.0], row["evaluations"], [budget]])
                y = 100.0 * np.concatenate([[0], np.arange(1, row["solved"] + 1), [row["solved"]]]) / row["targets"]
                look = {"color": style.pick(style.COLORS, k), "linestyle": style.pick(style.DASHES, k)}
                panel.step(x, y, where="post", label=label, **look)
            panel.set_title(name, fontsize=10)
            panel.set(xscale="log", xlim=(50, budget), ylim=(0, 101))
            panel.xaxis.set_major_formatter(ticks)
            panel.grid(axis="y")
        figure.supxlabel("evaluations", fontsize=10)
        figure.supylabel("targets solved [%]", fontsize=10)
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper left", ncols=3, handlelength=2.4, columnspacing=1.4)
        FIGURE.write_bytes(to_png(figure))


def main() -> None:
    """Run all searches on all problems, print the tables, write record and figure."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="10 targets a problem, 20,000 evaluations; writes nothing")
    parser.add_argument("--targets", type=int, default=100, help="targets a problem")
    arguments = parser.parse_args()
    count, budget = (10, 20_000) if arguments.quick else (arguments.targets, BUDGETS[-1])
    robot, records = ikde.load_robot("qiao2021"), {}
    for number, (name, make) in enumerate(PROBLEMS.items()):
        cases = make(robot, count, np.random.default_rng([SEED, number]))
        records[name] = {
            label: run_best(method, cases, budget)
            for label, method in track(METHODS.items(), description=name, console=Console(stderr=True))
        }
    show(records, budget)
    if not arguments.quick:
        settings = {
            "position_tolerance_m": 1e-5,
            "orientation_tolerance_rad": 1e-4,
            "seed": SEED,
            "budget": budget,
            "memetic": MemeticArrays()._asdict(),
            "descent": DescentArrays()._asdict(),
        }
        RESULTS.write_text(json.dumps({"machine": describe(), "settings": settings, "problems": records}, indent=1))
        draw(records, budget)


if __name__ == "__main__":
    main()
