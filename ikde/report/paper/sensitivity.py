"""How Table 4 depends on what is not printed."""

from collections.abc import Mapping
from typing import Any

from ikde.plot.charts import Estimate, plot_forest
from ikde.plot.images import to_svg
from ikde.plot.style import Axis
from ikde.report.numbers import fixed, rate
from ikde.report.page import Column, Figure, Gallery, Section, Table, Text

Data = Mapping[str, Any]
READINGS = {
    "unequal": "unequal pairs (typical: all non-adjacent; improved: Formula 22 as printed)",
    "equal": "equal pairs (Formula 22 as meant, or as named)",
}


def make_sensitivity(data: Data) -> Section:
    """Every variation's four rates, and which come closest."""
    printed = data["exact"]["printed"]
    return Section(
        "Table 4: what it depends on",
        (
            _introduce(data),
            _make_closest(data),
            *(_make_table(data, printed, reading) for reading in READINGS),
            _draw(data, printed),
        ),
        anchor="sensitivity",
    )


def _introduce(data: Data) -> Text:
    searched = [row["cells"] for row in data["exact"]["rows"] if row["group"] != "judgement"]
    columns = zip(*searched, strict=True)
    rates = [[cell["rejected_pct"] for cell in column if cell["SN"]] for column in columns]
    spans = [f"{fixed(min(values), 0)} to {fixed(max(values), 0)} %" for values in rates]
    return Text(
        f"One setting changed at a time, {data['settings']['solves']:,} solves a cell, so 95 % intervals are several "
        "points wide. Over all searches and lists of pairs, target 1 is rejected at "
        f"{spans[0]} (typical) and {spans[1]} (improved), target 2 at {spans[2]} and {spans[3]}."
    )


def _make_closest(data: Data) -> Table:
    return Table(
        columns=(
            Column("change", align="left"),
            Column("pairs", align="left"),
            Column("farthest of four rates from the print", "points", mark="ours"),
        ),
        rows=tuple(
            (describe_change(row), row["reading"], fixed(row["farthest_points"], 1)) for row in data["exact"]["closest"]
        ),
        caption="The settings that come closest to the print",
        note=f"A rate's interval is up to ±{fixed(_widest(data), 1)} points wide, and all rows share their random "
        "streams: "
        "settings that differ by less cannot be told apart.",
    )


def _widest(data: Data) -> float:
    """Half the widest interval of the closest settings' rates."""
    closest = {(row["group"], row["value"], row["reading"]) for row in data["exact"]["closest"]}
    rows = [row for row in data["exact"]["rows"] if (row["group"], row["value"], row["reading"]) in closest]
    return max(0.5 * (cell["interval_pct"][1] - cell["interval_pct"][0]) for row in rows for cell in row["cells"])


def _make_table(data: Data, printed: Data, reading: str) -> Table:
    rows = [row for row in data["exact"]["rows"] if row["reading"] == reading]
    heads = [
        Column(
            f"{cell['spheres']}, print {fixed(_printed(printed, cell), 0)}",
            "%",
            group=f"target {cell['target']}",
            mark="ours",
        )
        for cell in rows[0]["cells"]
    ]
    return Table(
        columns=(Column("change", align="left"), Column("solved"), *heads, Column("farthest", "points")),
        rows=tuple(
            (
                describe_change(row),
                f"{sum(cell['SN'] for cell in row['cells'][::2]):,}",
                *(rate(cell) for cell in row["cells"]),
                "–" if row["farthest_points"] is None else fixed(row["farthest_points"], 1),
            )
            for row in rows
        ),
        caption=f"Rejected solutions, {READINGS[reading]}",
        note=f"Rates with Wilson's 95 % interval; {2 * data['settings']['solves']:,} solves a row, of both targets; "
        "farthest: the largest of four distances from the print.",
    )


def describe_change(row: Data) -> str:
    """`base range: ±20 mm`."""
    return row["group"] if row["group"] == "as stated" else f"{row['group']}: {row['value']}"


def _printed(printed: Data, cell: Data) -> float:
    return printed[cell["target"]][cell["spheres"]]["rejected_pct"]


def _draw(data: Data, printed: Data) -> Gallery:
    """A forest a cell, in the reading that meets the print."""
    rows = [row for row in data["exact"]["rows"] if row["reading"] == "unequal"]
    figures = []
    for k, head in enumerate(rows[0]["cells"]):
        estimates = [
            Estimate(
                label=describe_change(row),
                value=row["cells"][k]["rejected_pct"],
                lower=row["cells"][k]["interval_pct"][0],
                upper=row["cells"][k]["interval_pct"][1],
            )
            for row in rows
            if row["cells"][k]["SN"]
        ]
        name = f"target {head['target']}, {head['spheres']}"
        figure = plot_forest(estimates, x=Axis(label="rejected", unit="%"), published=_printed(printed, head))
        figures.append(
            Figure(
                image=to_svg(figure),
                alt=f"Rejected share for {name} under every variation, with the printed rate",
                caption=f"{name}, unequal pairs.",
            )
        )
    return Gallery(tuple(figures))
