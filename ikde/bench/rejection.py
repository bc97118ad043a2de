"""Table 4: how many solutions of a plain search each detector rejects; what of it is spheres, and what is pairs."""

import time
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from ikde.batch.statistics import Z_95, Rate, compute_spread
from ikde.bench.approximation import APPROXIMATIONS as SPHERES
from ikde.bench.budget import FULL, Budget
from ikde.bench.detection import PAIR_LISTS, check_centres_many, compare_pairs
from ikde.bench.misprints import Data
from ikde.bench.plain_search import (
    SEED,
    Advance,
    Setup,
    Solutions,
    collides,
    make_collision,
    make_setup_problem,
    read_targets,
    solve_plainly,
)
from ikde.kernels.arrays import Floats
from ikde.model.collision_model import CollisionModel
from ikde.model.robot import Robot
from ikde.model.target import Target
from ikde.solver.rows import Rows, solve_rows

Pairing = dict[str, str]
READINGS: dict[str, Pairing] = {
    "equal": {"typical": "formula_22", "improved": "formula_22"},
    "unequal": {"typical": "non_adjacent", "improved": "formula_22_printed"},
}
"""Which pairs each detector looks at. `equal` compares the spheres alone. `unequal` is the one reading found that meets
all four printed rates: the typical detector looks at every pair, the improved one at Formula 22 to the letter."""
PAPERS_SAMPLE = 100
WAITS_IN_TURN = 50


def compute_rejection(
    robot: Robot,
    published: Mapping[str, Any],
    budget: Budget = FULL,
    *,
    advance: Advance | None = None,
) -> Data:
    """Table 4, both targets: one set of solutions a target, graded by every detector.

    Args:
        robot: qiao2021.
        published: `io.published.load_published()`.
        budget: how many solves.
        advance: called with the number of finished solves.
    """
    setup, targets = Setup(), read_targets(published)
    dropped, added = compare_pairs(robot, *READINGS["unequal"].values())
    solutions = {
        name: solve_plainly(robot, setup, target, budget.solves, first_stream=k * budget.solves, advance=advance)
        for k, (name, target) in enumerate(targets.items())
    }
    return {
        "exact": {
            "targets": [
                {
                    "target": name,
                    "position_mm": published["targets_mm"][name],
                    "printed": read_print(published["table_4"][name]),
                    "printed_gain": unpaired_gain(
                        *(Rate(row["CN"], row["SN"]) for row in published["table_4"][name].values())
                    ),
                    "samples": [
                        grade_sample(robot, solutions[name], solves)
                        for solves in sorted({min(PAPERS_SAMPLE, budget.solves), budget.solves})
                    ],
                }
                for name in targets
            ]
        },
        "measured": [
            _time_solves(robot, name, solutions[name], published["table_4"][name], budget) for name in targets
        ],
        "settings": {
            "source": "[Qiao2021, Table 4]",
            "seed": SEED,
            "readings": READINGS,
            "lists": {"dropped": dropped, "added": added},
            **describe_setup(setup),
        },
    }


def describe_setup(setup: Setup) -> Data:
    """A setup as plain data."""
    settings = setup.settings
    tolerances = {name: getattr(settings, name) for name in ("position_tolerance_m", "orientation_tolerance_rad")}
    return {
        "base_half_width_mm": setup.base_half_width_m * 1e3,
        "limits": setup.limits,
        "search": {**tolerances, "restarts": settings.restarts, **asdict(settings.evolution)},
    }


def read_print(printed: Mapping[str, Any]) -> Data:
    """A target's printed cells by detector, with their rates."""
    return {spheres: {**row, **rate_data(Rate(row["CN"], row["SN"]))} for spheres, row in printed.items()}


def rate_data(rate: Rate) -> Data:
    """A rate of rejection in %, None of nothing, with its interval."""
    low, high = rate.interval
    return {
        "CN": rate.count,
        "SN": rate.total,
        "rejected_pct": 100 * rate.share if rate.total else None,
        "interval_pct": [100 * low, 100 * high],
    }


def grade_sample(robot: Robot, solutions: Solutions, solves: int) -> Data:
    """The first so many solves of a target: what each detector over each list of pairs rejects of the solutions."""
    Q = solutions.first(solves)
    rejected = {
        (spheres, pairs): collides(make_collision(robot, spheres, pairs), Q)
        for spheres in SPHERES
        for pairs in PAIR_LISTS
    }
    return {
        "solves": solves,
        "solved": len(Q),
        "rates": [
            {"spheres": spheres, "pairs": pairs, **rate_data(Rate(int(verdicts.sum()), len(Q)))}
            for (spheres, pairs), verdicts in rejected.items()
        ],
        "paired": [
            {"reading": name, **pair_verdicts(*(rejected[spheres, reading[spheres]] for spheres in SPHERES))}
            for name, reading in READINGS.items()
        ],
        "gain": split_gain(rejected),
    }


def pair_verdicts(typical: np.ndarray, improved: np.ndarray) -> Data:
    """Both detectors on the same solutions."""
    return {
        "both_free": int((~typical & ~improved).sum()),
        "only_improved_free": int((typical & ~improved).sum()),
        "only_typical_free": int((~typical & improved).sum()),
        "both_reject": int((typical & improved).sum()),
    }


def split_gain(rejected: Mapping[tuple[str, str], np.ndarray]) -> Data:
    """From the typical detector over all pairs to the improved one over Formula 22 as printed, in points of the rate.

    In both orders, since spheres and pairs interact: what a step brings depends on what was changed before it.
    """
    start, end = rejected["typical", "non_adjacent"], rejected["improved", "formula_22_printed"]
    return {
        "total": paired_gain(start, end),
        "orders": [
            {"first": first, "steps": [paired_gain(start, rejected[between]), paired_gain(rejected[between], end)]}
            for first, between in (
                ("spheres", ("improved", "non_adjacent")),
                ("pairs", ("typical", "formula_22_printed")),
            )
        ],
    }


def paired_gain(before: np.ndarray, after: np.ndarray) -> Data:
    """By how many points fewer of the same solutions are rejected, with the 95 % interval of paired proportions."""
    count = max(len(before), 1)
    freed, lost = int((before & ~after).sum()), int((~before & after).sum())
    points = (freed - lost) / count
    return _interval(points, (freed + lost - (freed - lost) ** 2 / count) / count**2)


def unpaired_gain(before: Rate, after: Rate) -> Data:
    """The same for two independent samples, as the print gives them."""
    variance = sum(rate.share * (1.0 - rate.share) / rate.total for rate in (before, after))
    return _interval(before.share - after.share, variance)


def _interval(gain: float, variance: float) -> Data:
    margin = Z_95 * variance**0.5
    return {"points": 100 * gain, "interval_points": [100 * (gain - margin), 100 * (gain + margin)]}


def time_verdict_us(collision: CollisionModel, Q: Floats, rounds: int) -> Data:
    """Microseconds of a mean verdict by centres over `Q`, one after the other: median and quartiles of the rounds."""
    seconds = []
    for _ in range(rounds + 1):  # the first compiles, or warms up
        started = time.perf_counter()
        check_centres_many(collision, Q)
        seconds.append((time.perf_counter() - started) / len(Q))
    low, median, high = np.percentile(1e6 * np.array(seconds[1:]), [25, 50, 75])
    return {"median": float(median), "quartiles": [float(low), float(high)], "rounds": rounds}


def _time_solves(robot: Robot, name: str, solutions: Solutions, printed: Mapping[str, Any], budget: Budget) -> Data:
    """AT split: a solve's search, and one verdict on its solution, by centres; the paper's AT beside them."""
    return {
        "target": name,
        "search_ms": spread_data(1e3 * solutions.seconds),
        "evaluations": spread_data(solutions.evaluations),
        "detection": [
            {
                "spheres": spheres,
                "printed_AT_s": printed[spheres]["AT_s"],
                "verdict_us": time_verdict_us(
                    make_collision(robot, spheres, "formula_22"), solutions.Q, budget.timing_rounds
                ),
            }
            for spheres in SPHERES
        ],
    }


def spread_data(values: np.ndarray) -> Data:
    """Median, 95th percentile and maximum."""
    spread = compute_spread(values)
    return asdict(spread) if spread else {}


def compute_waiting(
    robot: Robot,
    published: Mapping[str, Any],
    budget: Budget = FULL,
    *,
    advance: Advance | None = None,
) -> Data:
    """What a user waits for: attempts and time until the first solution that the detector accepts.

    The search of Table 4's setting, started again until its solution is free, a stream of its own for each solve.
    """
    setup = Setup(settings=Setup().settings.with_changes(restarts=1000))
    cells = [
        _Wait(name, target, reading, make_collision(robot, spheres, pairing[spheres]), spheres, pairing[spheres])
        for name, target in read_targets(published).items()
        for reading, pairing in READINGS.items()
        for spheres in SPHERES
    ]
    problems = [make_setup_problem(robot, setup, cell.collision.detector) for cell in cells]
    for begin in range(0, budget.waits, WAITS_IN_TURN):
        count = min(WAITS_IN_TURN, budget.waits - begin)
        for cell, problem in zip(cells, problems, strict=True):
            cell.rows.append(solve_rows(problem, [cell.target] * count, seed=SEED, first_stream=begin, probe=False))
            if advance:
                advance(count)
    return {
        "exact": {"rows": [{**cell.key, **cell.outcome} for cell in cells]},
        "measured": {"rows": [{**cell.key, "ms": spread_data(1e3 * cell.gather("seconds"))} for cell in cells]},
        "settings": {"source": "[Qiao2021, Table 4]", "seed": SEED, **describe_setup(setup)},
    }


@dataclass(frozen=True, slots=True)
class _Wait:
    """A target and a detector; cells take turns, so that a slow minute of the machine hits all of them."""

    name: str
    target: Target
    reading: str
    collision: CollisionModel
    spheres: str
    pairs: str
    rows: list[Rows] = field(default_factory=list)

    @property
    def key(self) -> Data:
        """What the cell is."""
        return {
            "target": self.name,
            "reading": self.reading,
            "spheres": self.spheres,
            "pairs": self.pairs,
        }

    @property
    def outcome(self) -> Data:
        """What came of it."""
        reached = np.concatenate([rows.reached for rows in self.rows])
        attempts = np.concatenate([rows.attempts for rows in self.rows])
        return {"solves": len(reached), "reached": int(reached.sum()), "attempts": spread_data(attempts)}

    def gather(self, column: str) -> Floats:
        """A column of what was found."""
        return np.concatenate([getattr(rows.found, column) for rows in self.rows])
