"""How Table 4's rates depend on what the paper does not print: one setting changed at a time."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import product
from typing import Any, get_args

import numpy as np

from ikde.batch.statistics import Rate
from ikde.bench.approximation import APPROXIMATIONS as SPHERES
from ikde.bench.budget import FULL, Budget
from ikde.bench.detection import PAIR_LISTS
from ikde.bench.misprints import Data
from ikde.bench.plain_search import SEED, Advance, Setup, collides, make_collision, read_targets, solve_plainly
from ikde.bench.rejection import READINGS, describe_setup, rate_data, read_print
from ikde.kernels.arrays import Floats
from ikde.model.robot import Robot
from ikde.model.surface import M_STEPS, N_STEPS
from ikde.solver.surface import Rule, check_surface_many

Cells = list[Data]
GRIDS = ((M_STEPS, N_STEPS), (10 * M_STEPS, 10 * N_STEPS))  # of surface points: ours, and a far finer one


@dataclass(frozen=True, slots=True, kw_only=True)
class Variation:
    """One thing changed."""

    group: str
    value: str
    setup: Setup


def list_variations() -> list[Variation]:
    """What the search leaves open, around the stated setting."""
    stated = Setup()

    def vary(group: str, values: Mapping[str, dict[str, Any]]) -> list[Variation]:
        changed = {value: stated.settings.with_changes(**changes) for value, changes in values.items()}
        return [Variation(group=group, value=v, setup=replace(stated, settings=s)) for v, s in changed.items()]

    def vary_de(group: str, values: Mapping[str, dict[str, Any]]) -> list[Variation]:
        return vary(group, {value: {"de": changes} for value, changes in values.items()})

    bases = (0.0, 0.02, 0.1, 0.5, 1.0, 5.0)
    limits = {
        "key-point convention": "key_point",
        "half a turn either way": "half_turn",
        "a turn either way": "full_turn",
    }
    return [
        Variation(group="as stated", value="the setting of Table 4 above", setup=stated),
        *(
            Variation(group="base range", value=f"±{1e3 * b:g} mm", setup=replace(stated, base_half_width_m=b))
            for b in bases
        ),
        *vary_de(
            "start population",
            {f"middle {100 * s:g} % of each range": {"start_share": s} for s in (0.5, 0.25, 0.1)},
        ),
        *vary_de("start population", {f"NP = {n}": {"population": n} for n in (20, 100, 200)}),
        *(Variation(group="joint limits", value=v, setup=replace(stated, limits=k)) for v, k in limits.items()),
        *vary_de("out of range", {b: {"bounds": b} for b in ("clip", "parent", "midpoint", "none")}),
        *vary_de("mutation", {s: {"strategy": s} for s in ("rand/1", "rand-to-best/1", "current-to-best/1")}),
        *vary_de("update", {"at the end of the generation": {"update": "generation"}}),
        *vary("tolerance", {f"{1e3 * t:g} mm": {"position_tolerance_m": t} for t in (1e-5, 1e-3)}),
    ]


def compute_sensitivity(
    robot: Robot,
    published: Mapping[str, Any],
    budget: Budget = FULL,
    *,
    advance: Advance | None = None,
) -> Data:
    """Rates of both readings for every variation, and how far each is from the print.

    Args:
        robot: qiao2021.
        published: `io.published.load_published()`.
        budget: how many solves a cell.
        advance: called with the number of finished solves.
    """
    targets = read_targets(published)
    rows, stated = [], {}
    for variation in list_variations():
        Q = {
            name: solve_plainly(robot, variation.setup, target, budget.variation_solves, advance=advance).Q
            for name, target in targets.items()
        }
        stated = stated or Q
        for reading, pairing in READINGS.items():
            cells = [
                _grade(name, spheres, collides(make_collision(robot, spheres, pairing[spheres]), Q[name]))
                for name in targets
                for spheres in SPHERES
            ]
            rows.append(_row(variation.group, variation.value, reading, cells, published))
    rows += _vary_judgement(robot, stated, published)
    return {
        "exact": {
            "rows": rows,
            "closest": _rank(rows),
            "printed": {name: read_print(published["table_4"][name]) for name in targets},
        },
        "measured": {},
        "settings": {
            "source": "[Qiao2021, Table 4]",
            "seed": SEED,
            "solves": budget.variation_solves,
            "readings": READINGS,
            **describe_setup(Setup()),
        },
    }


def _vary_judgement(robot: Robot, stated: Mapping[str, Floats], published: Mapping[str, Any]) -> list[Data]:
    """The stated setting's solutions judged otherwise: over other pairs, or by surface points."""
    rows, formula_22 = [], {spheres: make_collision(robot, spheres, "formula_22") for spheres in SPHERES}
    for pairs in PAIR_LISTS[1:]:
        cells = [
            _grade(name, spheres, collides(make_collision(robot, spheres, pairs), Q))
            for name, Q in stated.items()
            for spheres in SPHERES
        ]
        rows.append(_row("pairs of both", pairs.replace("_", " "), "equal", cells, published))
    for rule, (m, n) in product(get_args(Rule), GRIDS):
        cells = [
            _grade(name, spheres, check_surface_many(robot, Q, detector, rule=rule, m_steps=m, n_steps=n))
            for name, Q in stated.items()
            for spheres, detector in formula_22.items()
        ]
        rows.append(_row("judgement", f"surface points, {rule}, {m} × {n} a sphere", "equal", cells, published))
    return rows


def _grade(target: str, spheres: str, rejected: np.ndarray) -> Data:
    return {"target": target, "spheres": spheres, **rate_data(Rate(int(rejected.sum()), len(rejected)))}


def _row(group: str, value: str, reading: str, cells: Cells, published: Mapping[str, Any]) -> Data:
    """A variation with its four cells, and the largest distance of a rate from its print, in points."""
    table = published["table_4"]
    printed = [100 * table[c["target"]][c["spheres"]]["CN"] / table[c["target"]][c["spheres"]]["SN"] for c in cells]
    gaps = [abs(cell["rejected_pct"] - p) if cell["SN"] else None for cell, p in zip(cells, printed, strict=True)]
    known = [gap for gap in gaps if gap is not None]
    worst = max(known) if len(known) == len(gaps) else None
    return {"group": group, "value": value, "reading": reading, "cells": cells, "farthest_points": worst}


def _rank(rows: list[Data], count: int = 5) -> list[Data]:
    """The variations that come closest to the print."""
    ranked = sorted((row for row in rows if row["farthest_points"] is not None), key=lambda row: row["farthest_points"])
    return [{key: row[key] for key in ("group", "value", "reading", "farthest_points")} for row in ranked[:count]]
