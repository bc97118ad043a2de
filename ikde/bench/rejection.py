"""Table 4: how many solutions of a plain search each detector rejects; what of it is spheres, and what is pairs."""

import time
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from ikde.batch.statistics import Rate, compute_spread
from ikde.bench.budget import FULL, Budget
from ikde.bench.detection import check_centres_many
from ikde.bench.misprints import Data
from ikde.bench.plain_search import (
    SEED,
    Advance,
    Setup,
    Solutions,
    collides,
    make_detector,
    make_setup_problem,
    read_targets,
    solve_plainly,
)
from ikde.kernels.arrays import Floats
from ikde.model.robot import Detector, Robot
from ikde.solver.rows import solve_rows

SPHERES = ("typical", "improved")
PAIR_LISTS = ("formula_22", "formula_22_printed", "non_adjacent")
Pairing = dict[str, str]
READINGS: dict[str, Pairing] = {
    "equal": {"typical": "formula_22", "improved": "formula_22"},
    "unequal": {"typical": "non_adjacent", "improved": "formula_22_printed"},
}
"""Which pairs each detector looks at. `equal` compares the spheres alone. `unequal` is the one reading found that meets
all four printed rates: the typical detector looks at every pair, the improved one at Formula 22 to the letter."""
PAPERS_SAMPLE = 100


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
                    "printed": _read_print(published["table_4"][name]),
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
        "settings": {"source": "[Qiao2021, Table 4]", "seed": SEED, "readings": READINGS, **describe_setup(setup)},
    }


def describe_setup(setup: Setup) -> Data:
    """A setup as plain data."""
    return {
        "base_half_width_mm": setup.base_half_width_m * 1e3,
        "limits": setup.limits,
        "search": asdict(setup.settings),
    }


def _read_print(printed: Mapping[str, Any]) -> Data:
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
        (spheres, pairs): collides(robot, make_detector(robot, spheres, pairs), Q)
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

    First the spheres change, then the pairs: the two steps add up to the whole.
    """
    start, middle, end = (
        100 * float(rejected[key].mean()) if rejected[key].size else 0.0
        for key in (("typical", "non_adjacent"), ("improved", "non_adjacent"), ("improved", "formula_22_printed"))
    )
    return {"spheres_points": start - middle, "pairs_points": middle - end, "total_points": start - end}


def time_verdicts_us(robot: Robot, detector: Detector, Q: Floats, rounds: int) -> Data:
    """Microseconds a verdict by centres, over `Q` one after the other: the spread of the rounds."""
    seconds = []
    for _ in range(rounds + 1):  # the first compiles, or warms up
        started = time.perf_counter()
        check_centres_many(robot, Q, detector)
        seconds.append((time.perf_counter() - started) / len(Q))
    return spread_data(1e6 * np.array(seconds[1:]))


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
                "verdict_us": time_verdicts_us(
                    robot, make_detector(robot, spheres, "formula_22"), solutions.Q, budget.timing_rounds
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
    setup = Setup()
    setup = Setup(settings=setup.settings.with_changes(restarts=1000))
    rows: list[tuple[Data, Data]] = []
    for name, target in read_targets(published).items():
        for reading, pairing in READINGS.items():
            for spheres in SPHERES:
                detector = make_detector(robot, spheres, pairing[spheres])
                problem = make_setup_problem(robot, setup, detector)
                found = solve_rows(problem, [target] * budget.waits, seed=SEED, probe=False)
                if advance:
                    advance(budget.waits)
                key = {"target": name, "reading": reading, "spheres": spheres, "pairs": detector.pairs}
                counts = {"solves": budget.waits, "reached": int(found.reached.sum())}
                attempts = spread_data(found.attempts)
                rows.append(
                    ({**key, **counts, "attempts": attempts}, {**key, "ms": spread_data(1e3 * found.found.seconds)})
                )
    return {
        "exact": {"rows": [exact for exact, _ in rows]},
        "measured": {"rows": [measured for _, measured in rows]},
        "settings": {"source": "[Qiao2021, Table 4]", "seed": SEED, **describe_setup(setup)},
    }
