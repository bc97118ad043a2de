"""Table 5 and Figure 8: the published solutions graded again, and solutions of our own."""

from collections.abc import Mapping
from itertools import count
from typing import Any

import numpy as np

from ikde.bench.approximation import APPROXIMATIONS
from ikde.bench.misprints import Data, meant
from ikde.bench.plain_search import limit_base
from ikde.kernels.arrays import Floats
from ikde.model.convention import to_convention
from ikde.model.robot import Robot
from ikde.model.target import Target
from ikde.solver.check import check
from ikde.solver.distinct import solve_distinct
from ikde.solver.forward import forward
from ikde.solver.joints import joints_outside, read_joints
from ikde.solver.result import SolveResult
from ikde.solver.settings import SolveSettings
from ikde.solver.solve import solve

SETTINGS = SolveSettings.for_method("de")
SEED, SOLUTIONS, BASE_M = 1, 3, 0.1


def compute_solutions(robot: Robot, published: Mapping[str, Any]) -> Data:
    """Table 5's rows, graded, and for each target free solutions and a colliding one of ours.

    Args:
        robot: qiao2021.
        published: `io.published.load_published()`.
    """
    near = limit_base(robot, BASE_M)
    targets = published["targets_mm"]
    return {
        "exact": {
            "published": [_grade_row(robot, row, targets[row["target"]]) for row in published["table_5"]],
            "ours": [row for name in targets for row in _solve_target(near, name, targets[name])],
        },
        "measured": {},
        "settings": {
            "source": "[Qiao2021, Table 5]",
            "targets_mm": targets,
            "convention": "classical",
            "units": "d_x, d_y in mm, the rest in rad",
            "method": "de",
            "position_tolerance_mm": 1e3 * SETTINGS.position_tolerance_m,
            "base_range_mm": 1e3 * BASE_M,
            "seed": SEED,
            "free": "free with the typical detector (and so graded by the improved one as well)",
            "colliding": "searched with no detector: the first stream whose solution the typical detector rejects",
        },
    }


def read_row(robot: Robot, row: Mapping[str, Any]) -> Floats:
    """A row of Table 5 as q [9] in the robot's own convention, m and rad."""
    return read_joints(robot, [*np.array(row["q"][:2]) / 1e3, *row["q"][2:]], "classical")


def _grade_row(robot: Robot, row: Mapping[str, Any], target_mm: list[float]) -> Data:
    q = read_row(robot, row)
    graded = grade(robot, q, target_mm)
    label = "free with both" if row["row"].startswith("s") else "typical collides"
    typical, improved = (graded["detectors"][name]["collides"] for name in APPROXIMATIONS)
    shown = not (typical or improved) if label == "free with both" else typical
    return {
        "target": row["target"],
        "row": row["row"],
        "printed_q": row["q"],
        "ME_mm": {"printed": row["ME_mm"], "meant": meant(row)["ME_mm"], "ours": graded["largest_error_mm"]},
        "label": {"printed": label, "ours": describe_verdict(typical, improved), "agrees": shown},
        "misprint": row.get("misprint"),
        "outside_limits": list(joints_outside(robot, q)),
        **graded,
    }


def grade(robot: Robot, q: Floats, target_mm: list[float]) -> Data:
    """Errors per axis in mm and what both detectors see, for `q` [9] in the robot's own convention."""
    errors = np.abs(1e3 * forward(robot, q)["tool"][:3, 3] - target_mm)
    return {
        "q": q.tolist(),
        "error_mm": errors.tolist(),
        "largest_error_mm": float(errors.max()),
        "detectors": {name: _look(robot, q, name) for name in APPROXIMATIONS},
    }


def _look(robot: Robot, q: Floats, detector: str) -> Data:
    seen = check(robot, q, detector)
    colliding = [[pair.a, pair.b] for pair in seen.pairs if pair.collides]
    return {
        "collides": seen.collision,
        "clearance_mm": 1e3 * seen.pairs[0].clearance_m,
        "pair": [seen.pairs[0].a, seen.pairs[0].b],
        "colliding_pairs": colliding,
        "colliding_components": sorted({name for pair in colliding for name in pair}),
    }


def describe_verdict(typical: bool, improved: bool) -> str:
    """What two verdicts say, in the words of Table 5's labels."""
    if not typical and not improved:
        return "free with both"
    return "both collide" if typical and improved else "typical collides" if typical else "improved collides"


def _solve_target(robot: Robot, name: str, target_mm: list[float]) -> list[Data]:
    target = Target(np.array(target_mm) / 1e3)
    free = solve_distinct(robot, target, SOLUTIONS, SETTINGS, rank="found", seed=SEED, collision="typical")
    rows = [_describe(robot, name, f"s{k + 1}", target_mm, result) for k, result in enumerate(free)]
    return [*rows, _describe(robot, name, "f1", target_mm, find_colliding(robot, target))]


def find_colliding(robot: Robot, target: Target) -> SolveResult:
    """The first stream of the plain search, blind to collisions, whose solution the typical detector rejects."""
    blind = (solve(robot, target, SETTINGS, seed=SEED, stream=stream, collision="none") for stream in count())
    return next(found for found in blind if found.reached and check(robot, found.q, "typical").collision)


def _describe(robot: Robot, target: str, row: str, target_mm: list[float], result: SolveResult) -> Data:
    q = to_convention(robot, result.q, "classical")
    return {
        "target": target,
        "row": row,
        "printed_q": [*(1e3 * q[:2]).tolist(), *q[2:].tolist()],
        "reached": result.reached,
        "detector": result.detector,
        "stream": result.stream,
        "attempts": result.attempts,
        **grade(robot, result.q, target_mm),
    }
