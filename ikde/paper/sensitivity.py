"""How Table 4's rates depend on what the paper does not print: one setting changed at a time."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from itertools import product
from typing import Any, get_args

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.robot import Robot
from ikde.paper.columns import Shown, label, make_table, ours
from ikde.paper.inputs import APPROXIMATIONS, PAIR_LISTS, Inputs
from ikde.paper.plain_search import Setup, collides, solve_plainly
from ikde.paper.rejection import READINGS, PrintedRate, RejectionRate, describe_setup, rate_fields, read_print
from ikde.paper.section import Computed, make_collision
from ikde.paper.surface import M_STEPS, N_STEPS, Rule, check_surface_many
from ikde.plot.charts import Estimate, plot_forest
from ikde.plot.images import to_svg
from ikde.plot.style import Axis
from ikde.report.numbers import fixed
from ikde.report.page import Column, Figure, Gallery, Section, Table, Text

GRIDS = ((M_STEPS, N_STEPS), (10 * M_STEPS, 10 * N_STEPS))  # of surface points: ours, and a far finer one
BASES_M = (0.0, 0.02, 0.1, 0.5, 1.0, 5.0)
CLOSEST = 5
Printed = Mapping[str, Mapping[str, PrintedRate]]  # by target and detector
Reject = Callable[[str, Floats], np.ndarray]  # (detector, Q) -> which are rejected
READING_NAMES = {
    "unequal": "unequal pairs (typical: all non-adjacent; improved: Formula 22 as printed)",
    "equal": "equal pairs (Formula 22 as meant, or as named)",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Variation:
    """One thing changed."""

    group: str
    value: str
    setup: Setup


@dataclass(frozen=True, slots=True, kw_only=True)
class CellRate(RejectionRate):
    """Of one detector, at one target."""

    target: str
    spheres: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Distance:
    """A variation in one reading, and the largest distance of its rates from the print, in points."""

    group: str
    value: str
    reading: str
    distance_points: float | None  # None where a target has no solutions

    @property
    def change(self) -> str:
        """`base range: ±20 mm`."""
        return self.group if self.group == "as stated" else f"{self.group}: {self.value}"


@dataclass(frozen=True, slots=True, kw_only=True)
class VariedRates(Distance):
    """With its four cells."""

    cells: list[CellRate]


@dataclass(frozen=True, slots=True, kw_only=True)
class Sensitivity(Computed):
    """Every variation, those that come closest to the print, and the print."""

    rows: list[VariedRates]
    closest: list[Distance]
    printed: Printed


def list_variations() -> list[Variation]:
    """What the search leaves open, around the stated setting."""
    stated = Setup()

    def search(**changes: Any) -> Setup:
        return replace(stated, settings=stated.settings.with_changes(**changes))

    def de(**changes: Any) -> Setup:
        return search(de=changes)

    varied = {
        "as stated": {"the setting of Table 4 above": stated},
        "base range": {f"±{1e3 * b:g} mm": replace(stated, base_half_width_m=b) for b in BASES_M},
        "start population": {
            **{f"middle {100 * s:g} % of each range": de(start_share=s) for s in (0.5, 0.25, 0.1)},
            **{f"NP = {n}": de(population=n) for n in (20, 100, 200)},
        },
        "joint limits": {
            "key-point convention": replace(stated, limits="key_point"),
            "half a turn either way": replace(stated, limits="half_turn"),
            "a turn either way": replace(stated, limits="full_turn"),
        },
        "out of range": {b: de(bounds=b) for b in ("clip", "parent", "midpoint", "none")},
        "mutation": {s: de(strategy=s) for s in ("rand/1", "rand-to-best/1", "current-to-best/1")},
        "update": {"at the end of the generation": de(update="generation")},
        "tolerance": {f"{1e3 * t:g} mm": search(position_tolerance_m=t) for t in (1e-5, 1e-3)},
    }
    return [Variation(group=group, value=v, setup=s) for group, setups in varied.items() for v, s in setups.items()]


def compute_sensitivity(inputs: Inputs) -> Sensitivity:
    """Rates of both readings for every variation, and how far each is from the print."""
    printed = {name: read_print(inputs.published["table_4"][name]) for name in inputs.targets}
    rows = [_rate(printed, *row) for row in _list_rows(inputs)]
    known = (row for row in rows if row.distance_points is not None)
    ranked = sorted(known, key=lambda row: row.distance_points or 0.0)
    return Sensitivity(
        rows=rows,
        closest=[
            Distance(group=row.group, value=row.value, reading=row.reading, distance_points=row.distance_points)
            for row in ranked[:CLOSEST]
        ],
        printed=printed,
        settings={"solves": inputs.budget.variation_solves, "readings": READINGS, **describe_setup(Setup())},
    )


def _list_rows(inputs: Inputs) -> Iterator[tuple[str, str, str, Mapping[str, Floats], Reject]]:
    """(group, value, reading, solutions by target, rejection): each variation, then the stated one judged otherwise."""
    robot, stated = inputs.robot, {}
    for variation in list_variations():
        solves = partial(solve_plainly, inputs, variation.setup, solves=inputs.budget.variation_solves)
        Q = {name: solves(target).Q for name, target in inputs.targets.items()}
        stated = stated or Q
        for reading, pairing in READINGS.items():
            yield variation.group, variation.value, reading, Q, partial(_reject_by_centres, robot, pairing)
    for pairs in PAIR_LISTS[1:]:
        pairing = dict.fromkeys(APPROXIMATIONS, pairs)
        yield "pairs of both", pairs.replace("_", " "), "equal", stated, partial(_reject_by_centres, robot, pairing)
    for rule, (m, n) in product(get_args(Rule), GRIDS):
        value = f"surface points, {rule}, {m} × {n} a sphere"
        yield "judgement", value, "equal", stated, partial(_reject_by_surface, robot, rule, (m, n))


def _reject_by_centres(robot: Robot, pairing: Mapping[str, str], spheres: str, Q: Floats) -> np.ndarray:
    return collides(make_collision(robot, spheres, pairing[spheres]), Q)


def _reject_by_surface(robot: Robot, rule: Rule, grid: tuple[int, int], spheres: str, Q: Floats) -> np.ndarray:
    return check_surface_many(robot, Q, make_collision(robot, spheres, "formula_22"), rule=rule, grid=grid)


def _rate(
    printed: Printed, group: str, value: str, reading: str, Q: Mapping[str, Floats], reject: Reject
) -> VariedRates:
    cells = []
    for name, spheres in product(Q, APPROXIMATIONS):
        rejected = reject(spheres, Q[name])
        cells.append(CellRate(target=name, spheres=spheres, **rate_fields(int(rejected.sum()), len(rejected))))
    worst = max(abs(cell.percent - printed[cell.target][cell.spheres].percent) for cell in cells)
    largest = worst if all(cell.SN for cell in cells) else None
    return VariedRates(group=group, value=value, reading=reading, cells=cells, distance_points=largest)


def show_sensitivity(data: Sensitivity, _: Inputs) -> Section:
    """Every variation's four rates, and which come closest."""
    return Section(
        "Table 4: what it depends on",
        (
            _introduce(data),
            _make_closest(data),
            *(_make_rates(data, reading) for reading in READING_NAMES),
            _draw(data),
        ),
        anchor="sensitivity",
    )


def _introduce(data: Sensitivity) -> Text:
    columns = zip(*(row.cells for row in data.rows if row.group != "judgement"), strict=True)
    rates = [[cell.percent for cell in column if cell.SN] for column in columns]
    spans = [f"{fixed(min(values), 0)} to {fixed(max(values), 0)} %" for values in rates]
    return Text(
        f"One setting changed at a time, {data.settings['solves']:,} solves a cell, so 95 % intervals are several "
        "points wide. Over all searches and lists of pairs, target 1 is rejected at "
        f"{spans[0]} (typical) and {spans[1]} (improved), target 2 at {spans[2]} and {spans[3]}."
    )


def _make_closest(data: Sensitivity) -> Table:
    closest = {(row.change, row.reading) for row in data.closest}
    intervals = [cell.interval_pct for row in data.rows if (row.change, row.reading) in closest for cell in row.cells]
    widest = max(0.5 * (high - low) for low, high in intervals)
    return make_table(
        data.closest,
        label("change", lambda row: row.change),
        label("pairs", lambda row: row.reading),
        ours("largest distance of four rates from the print", "points", _format_distance),
        caption="The settings that come closest to the print",
        note=f"A rate's interval is up to ±{fixed(widest, 1)} points wide, and all rows share their random "
        "streams: settings that differ by less cannot be distinguished.",
    )


def _format_distance(row: Distance) -> str:
    return "–" if row.distance_points is None else fixed(row.distance_points, 1)


def _make_rates(data: Sensitivity, reading: str) -> Table:
    rows = [row for row in data.rows if row.reading == reading]
    return make_table(
        rows,
        label("change", lambda row: row.change),
        (Column("solved"), lambda row: f"{sum(cell.SN for cell in row.cells[::2]):,}"),
        *(_show_cell(data, k) for k in range(len(rows[0].cells))),
        (Column("largest distance", "points"), _format_distance),
        caption=f"Rejected solutions, {READING_NAMES[reading]}",
        note=f"Rates with Wilson's 95 % interval; {2 * data.settings['solves']:,} solves a row, of both targets; "
        "largest distance: that of four rates from the print.",
    )


def _show_cell(data: Sensitivity, k: int) -> Shown[VariedRates]:
    head = data.rows[0].cells[k]
    title = f"{head.spheres}, print {fixed(_printed(data, head), 0)}"
    return ours(title, "%", lambda row: row.cells[k].text, f"target {head.target}")


def _printed(data: Sensitivity, cell: CellRate) -> float:
    return data.printed[cell.target][cell.spheres].percent


def _draw(data: Sensitivity) -> Gallery:
    """A forest a cell, in the reading that meets the print."""
    rows = [row for row in data.rows if row.reading == "unequal"]
    figures = []
    for k, head in enumerate(rows[0].cells):
        estimates = [
            Estimate(label=row.change, value=cell.percent, lower=cell.interval_pct[0], upper=cell.interval_pct[1])
            for row in rows
            if (cell := row.cells[k]).SN
        ]
        figure = plot_forest(estimates, x=Axis(label="rejected", unit="%"), published=_printed(data, head))
        name = f"target {head.target}, {head.spheres}"
        alt = f"Rejected share for {name} under every variation, with the printed rate"
        figures.append(Figure(image=to_svg(figure), alt=alt, caption=f"{name}, unequal pairs."))
    return Gallery(tuple(figures))
