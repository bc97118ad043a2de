"""What self-collision detection costs, and where its variants disagree."""

from collections.abc import Mapping
from typing import Any

from ikde.report.numbers import fixed, significant
from ikde.report.page import Cell, Column, Section, Table, Text

LIST_NAMES = {
    "formula_22": "Formula 22 as meant",
    "formula_22_printed": "Formula 22 as printed",
    "non_adjacent": "all non-adjacent",
}
Data = Mapping[str, Any]


def make_detection(data: Data) -> Section:
    """Lists of pairs, and centres against surface points."""
    return Section(
        "Detection cost: pairs, centres and surface points",
        (_introduce(data), _make_lists(data), _make_differences(data), _make_surface(data), _make_times(data)),
        anchor="detection",
    )


def _introduce(data: Data) -> Text:
    settings, measured = data["settings"], data["measured"]
    slowest = max(1e6 * row["median_s"] for row in measured["lists"])
    plain = [row["every_point"]["median_s"] for row in measured["surface"]]
    blind = [row for row in data["exact"]["surface_differs"] if row["rule"] == "eq. 18"]
    return Text(
        f"Over {settings['verdicts']:,} random configurations, {settings['configurations']} (the same for all, "
        f"{settings['surface_verdicts']:,} of them for surface points). A verdict by centres (eq. 21) takes at most "
        f"{significant(slowest, 2)} µs in the median; every surface point against every other, as the paper did "
        f"before, takes {significant(min(plain), 2)} to {significant(max(plain), 2)} s. Eq. 18, which asks for points "
        f"that coincide, sees {sum(row['surface_collides'] for row in blind):,} of "
        f"{sum(row['centres_collide'] for row in blind):,} collisions; eq. 20, which allows for the grid's spacing, "
        f"reports collisions that centres do not: {_count_extra(data['exact']['surface_differs'])}.\n\n"
        f"The list decides, too. Verdicts that differ from Formula 22 as meant: "
        f"{_count_changed(data['exact']['lists_differ'])}."
    )


def _count_extra(rows: list[Data]) -> str:
    """What eq. 20 adds, grid by grid: `36 × 18 points a sphere 120 (typical), 61 (improved)`."""
    found: dict[str, list[str]] = {}
    for row in rows:
        if row["rule"] == "eq. 20":
            found.setdefault(_name_grid(row), []).append(f"{row['only_surface_collides']:,} ({row['approximation']})")
    return "; ".join(f"with {grid} points a sphere {', '.join(counts)}" for grid, counts in found.items())


def _count_changed(rows: list[Data]) -> str:
    """Verdicts that another list changes: `all non-adjacent 3 (typical), 363 (improved)`."""
    found: dict[str, list[str]] = {}
    for row in rows:
        changed = row["only_this_collides"] + row["only_the_other_collides"]
        found.setdefault(LIST_NAMES[row["pairs"]], []).append(f"{changed:,} ({row['approximation']})")
    return "; ".join(f"{name} {', '.join(counts)}" for name, counts in found.items())


def _name_grid(row: Data) -> str:
    return " × ".join(map(str, row["grid"]))


def _make_lists(data: Data) -> Table:
    rows = zip(data["exact"]["lists"], data["measured"]["lists"], strict=True)
    return Table(
        columns=(
            Column("spheres", align="left"),
            Column("list of pairs", align="left"),
            Column("component pairs", mark="ours"),
            Column("sphere pairs", mark="ours"),
            Column("colliding", mark="ours"),
            Column("median", "µs", group="a verdict by centres", mark="ours"),
            Column("p95", "µs", group="a verdict by centres", mark="ours"),
            Column("mean", "µs", group="a verdict by centres", mark="ours"),
        ),
        rows=tuple(
            (
                exact["approximation"],
                LIST_NAMES[exact["pairs"]],
                f"{exact['component_pairs']}",
                f"{exact['sphere_pairs']}",
                f"{exact['colliding']:,} of {data['settings']['verdicts']:,}",
                significant(1e6 * measured["median_s"]),
                significant(1e6 * measured["p95_s"]),
                significant(1e6 * measured["mean_s"]),
            )
            for exact, measured in rows
        ),
        caption="Lists of pairs, by centres (eq. 21)",
        note=f"The time includes {data['settings']['time_includes']}; {data['settings']['threads']} thread. Median and "
        "p95 judge each configuration again and again; the mean takes them one after the other.",
    )


def _make_differences(data: Data) -> Table:
    return Table(
        columns=(
            Column("spheres", align="left"),
            Column("list", align="left"),
            Column("looks also at", align="left"),
            Column("does not look at", align="left"),
            Column("collide by this list alone", mark="ours"),
            Column("by Formula 22 alone", mark="ours"),
        ),
        rows=tuple(
            (
                row["approximation"],
                LIST_NAMES[row["pairs"]],
                name_pairs(row["pairs_added"]),
                name_pairs(row["pairs_missing"]),
                f"{row['only_this_collides']:,}",
                f"{row['only_the_other_collides']:,}",
            )
            for row in data["exact"]["lists_differ"]
        ),
        caption="Verdicts that differ from those over Formula 22 as meant",
        note=f"Of {data['settings']['verdicts']:,} configurations.",
    )


def name_pairs(pairs: list[list[str]]) -> str:
    """`(G, L1), (G, L2)`; a dash of none."""
    return ", ".join(f"({a}, {b})" for a, b in pairs) or "–"


def _make_surface(data: Data) -> Table:
    return Table(
        columns=(
            Column("spheres", align="left"),
            Column("rule", align="left"),
            Column("points a sphere"),
            Column("home", align="left", mark="ours"),
            Column("colliding by points", mark="ours"),
            Column("by centres", mark="ours"),
            Column("by points alone", mark="ours"),
            Column("by centres alone", mark="ours"),
        ),
        rows=tuple(
            (
                row["approximation"],
                row["rule"].replace(" ", "\N{NO-BREAK SPACE}"),
                _name_grid(row),
                Cell("collides", "off") if row["home_collides"] else "free",
                f"{row['surface_collides']:,}",
                f"{row['centres_collide']:,}",
                f"{row['only_surface_collides']:,}",
                f"{row['only_centres_collide']:,}",
            )
            for row in data["exact"]["surface_differs"]
        ),
        caption="Surface points against centres, pairs of Formula 22",
        note=f"Of {data['settings']['surface_verdicts']:,} configurations. Where points call home a collision (≠), "
        "their spacing is wider than the clearance that centres see there ([Table 2](#table-2)).",
    )


def _make_times(data: Data) -> Table:
    centres = {r["approximation"]: r for r in data["measured"]["lists"] if r["pairs"] == "formula_22"}
    return Table(
        columns=(
            Column("spheres", align="left"),
            Column("centres", "µs", mark="ours"),
            Column("points that can matter", "µs", mark="ours"),
            Column("every point", "ms", mark="ours"),
            Column("every point / centres", mark="ours"),
        ),
        rows=tuple(
            (
                row["approximation"],
                significant(1e6 * centres[row["approximation"]]["median_s"]),
                significant(1e6 * row["quick"]["median_s"]),
                significant(1e3 * row["every_point"]["median_s"]),
                fixed(row["every_point"]["median_s"] / centres[row["approximation"]]["median_s"], 0),
            )
            for row in data["measured"]["surface"]
        ),
        caption="Median time of a verdict, pairs of Formula 22",
        note=f"Every point: {data['settings']['plain_verdicts']} configurations; the others "
        f"{data['settings']['timed_verdicts']}. Of the verdicts by every point "
        f"{sum(row['same_verdicts'] for row in data['measured']['surface'])} of "
        f"{sum(row['every_point']['timed'] for row in data['measured']['surface'])} are those by the points that can "
        "matter.",
    )
