"""Table 3: seconds to place surface points and centres, by spatial transformation and by key points.

Another machine and another program than the paper's, so the seconds say little beside one another; the ratios may.
"""

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

from ikde.bench.approximation import APPROXIMATIONS
from ikde.bench.budget import FULL, Budget
from ikde.bench.misprints import Data
from ikde.kernels.arrays import CollisionArrays, Floats, RobotArrays
from ikde.kernels.placing import place_by_key_points, place_by_transformation
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot
from ikde.model.robot import Robot
from ikde.model.surface import M_STEPS, N_STEPS, surface_directions

POINTS = ("surface", "centres")
SCOPES = {
    "placing": "the spheres alone, all poses known",
    "kinematics": "from joint values: poses of the bodies, origins of the key points, then the spheres",
}
LOOP = {"surface": 2, "centres": 300}  # placements in a timed loop: some 50 us, fifty times what its call costs


def compute_timing(robot: Robot, published: Mapping[str, Any], budget: Budget = FULL) -> Data:
    """Table 3's columns as printed and ours, at ten moments of the published motion, and what they say of ratios.

    Args:
        robot: qiao2021.
        published: `io.published.load_published()`.
        budget: rounds of timing.
    """
    table = published["table_3"]
    placements = [make_placement(robot, column) for column in table["columns"]]
    moments = read_motion(table["motion"], len(table["rows_s"]))
    printed = summarise_printed(table)
    return {
        "exact": {
            "columns": table["columns"],
            "printed_rows_s": table["rows_s"],
            "printed_s": printed,
            "printed_ratios": [compare_printed(table, printed, *key) for key in product(POINTS, APPROXIMATIONS)],
            "placed": {name: _count_points(robot, name) for name in APPROXIMATIONS},
            "q": moments.tolist(),
        },
        "measured": {scope: _measure(placements, moments, scope, budget.timing_rounds) for scope in SCOPES},
        "settings": {
            "source": "[Qiao2021, Table 3 and section 5.3.2]",
            "printed_on": published["computer"],
            "scopes": SCOPES,
            "rounds": budget.timing_rounds,
            "moments": len(moments),
            "placements_in_a_loop": LOOP,
            "surface_grid": [M_STEPS, N_STEPS],
            "threads": 1,
        },
    }


def read_motion(motion: Mapping[str, Any], moments: int) -> Floats:
    """Configurations [moments, 9] of the published motion in m and rad, its start and end among them."""
    arm = np.linspace(motion["start_deg"], motion["end_deg"], moments)
    return np.radians(np.hstack([np.tile(np.asarray(motion["base"], dtype=float), (moments, 1)), arm]))


# ---- what is printed


def summarise_printed(table: Mapping[str, Any]) -> dict[str, dict[str, float]]:
    """The printed average of each column, and the mean and the median of its ten printed rows."""
    names, rows = [column["name"] for column in table["columns"]], np.array(table["rows_s"])
    summaries = {"average": table["average_s"], "mean": rows.mean(axis=0), "median": np.median(rows, axis=0)}
    return {kind: dict(zip(names, map(float, values), strict=True)) for kind, values in summaries.items()}


def compare_printed(
    table: Mapping[str, Any], printed: Mapping[str, Mapping[str, float]], points: str, approximation: str
) -> Data:
    """Time by key points over time by transformation: as the text says it, and as the table gives it."""
    slow, fast = (find_column(table["columns"], points, approximation, m) for m in ("transformation", "key_points"))
    names = [table["columns"][index]["name"] for index in (fast, slow)]
    return {
        "points": points,
        "approximation": approximation,
        "columns": names,
        "stated": table["stated_ratio"][points],
        **{f"from_{kind}": values[names[0]] / values[names[1]] for kind, values in printed.items()},
        "see": table["see"][points],
    }


def find_column(columns: Sequence[Mapping[str, str]], points: str, approximation: str, method: str) -> int:
    """Index of a column of Table 3."""
    asked = {"points": points, "approximation": approximation, "method": method}
    return next(index for index, column in enumerate(columns) if asked.items() <= column.items())


def _count_points(robot: Robot, approximation: str) -> dict[str, int]:
    spheres = sum(row.count for row in robot.approximations[approximation])
    return {"centres": spheres, "surface": spheres * M_STEPS * N_STEPS}


# ---- what is measured


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Placement:
    """One column of Table 3, ready to run."""

    column: Mapping[str, str]
    robot: RobotArrays
    detector: CollisionArrays
    directions: Floats  # [K, 3]; none for centres
    T_world_body: Floats
    T_world_frame: Floats
    centres: Floats  # [3, S]
    points: Floats  # [S, K, 3]

    def run(self, q: Floats, moves: bool, times: int) -> None:
        """Place everything `times` times, at the poses of `q` [N] if it `moves`, else where the last run left them."""
        asked = (self.robot, self.detector, self.directions, q, moves, times, self.T_world_body)
        if self.column["method"] == "transformation":
            place_by_transformation(*asked, self.centres, self.points)
        else:
            place_by_key_points(*asked, self.T_world_frame, self.centres, self.points)

    def measure(self, q: Floats, moves: bool) -> float:
        """Seconds of one placement."""
        self.run(q, True, 1)
        times = LOOP[self.column["points"]]
        begin = time.perf_counter_ns()
        self.run(q, moves, times)
        return 1e-9 * (time.perf_counter_ns() - begin) / times


def make_placement(robot: Robot, column: Mapping[str, str]) -> Placement:
    """Pack a column's approximation; every component takes part, since the detectors' pairs name them all."""
    arrays = pack_robot(robot)
    detector = CollisionModel.of(robot, column["approximation"]).arrays
    directions = surface_directions() if column["points"] == "surface" else np.empty((0, 3))
    return Placement(
        column=column,
        robot=arrays,
        detector=detector,
        directions=directions,
        T_world_body=np.empty((arrays.bodies.shape[0], 3, 4)),
        T_world_frame=np.zeros((arrays.frame_body.size, 3, 4)),
        centres=np.empty((3, detector.radius.size)),
        points=np.empty((detector.radius.size, len(directions), 3)),
    )


def _measure(placements: Sequence[Placement], moments: Floats, scope: str, rounds: int) -> Data:
    """Every column at every moment, all of them in turn in every round."""
    moves = scope == "kinematics"
    for placement in placements:
        placement.measure(moments[0], moves)
    times = np.array([[[p.measure(q, moves) for p in placements] for q in moments] for _ in range(rounds)])
    columns = [placement.column for placement in placements]
    return {
        "columns": [_summarise(column, times[:, :, index]) for index, column in enumerate(columns)],
        "ratios": [_compare(columns, times, *key) for key in product(POINTS, APPROXIMATIONS)],
    }


def _summarise(column: Mapping[str, str], times: Floats) -> Data:
    """One column's median over all rounds and moments [rounds, moments], its quartiles, and a median a moment."""
    low, median, high = np.percentile(times, (25, 50, 75))
    return {
        "name": column["name"],
        "median_s": float(median),
        "quartiles_s": [float(low), float(high)],
        "rows_s": np.median(times, axis=0).tolist(),
    }


def _compare(columns: Sequence[Mapping[str, str]], times: Floats, points: str, approximation: str) -> Data:
    """Time by key points over time by transformation, each pair measured in the same round at the same moment."""
    slow, fast = (find_column(columns, points, approximation, m) for m in ("transformation", "key_points"))
    low, median, high = np.percentile(times[:, :, fast] / times[:, :, slow], (25, 50, 75))
    return {
        "points": points,
        "approximation": approximation,
        "median": float(median),
        "quartiles": [float(low), float(high)],
    }
