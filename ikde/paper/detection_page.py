"""The cost of self-collision detection, and where its variants disagree, as a section of the page."""

from collections.abc import Iterable

from ikde.paper.columns import label, make_table, ours
from ikde.paper.detection import Detection, SurfaceDifference
from ikde.paper.inputs import Inputs
from ikde.paper.section import name_pairs
from ikde.report.numbers import count_of, fixed, significant
from ikde.report.page import Cell, Column, Section, Table, Text

LIST_NAMES = {
    "formula_22": "Formula 22 as meant",
    "formula_22_printed": "Formula 22 as printed",
    "non_adjacent": "all non-adjacent",
}
BY_CENTRES = "a verdict by centres"


def show_detection(data: Detection, _: Inputs) -> Section:
    """Lists of pairs, and centres against surface points."""
    return Section(
        "Detection cost: pairs, centres and surface points",
        (_introduce(data), _make_lists(data), _make_differences(data), _make_surface(data), _make_times(data)),
        anchor="detection",
    )


def _introduce(data: Detection) -> Text:
    settings, measured = data.settings, data.measured
    slowest = max(1e6 * row.median_s for row in measured.lists)
    plain = [row.every_point.median_s for row in measured.surface]
    blind, sees = ([row for row in data.surface_differs if row.rule == rule] for rule in ("eq. 18", "eq. 20"))
    extra = ((f"with {_name_grid(row)} points a sphere", row.only_surface_collides, row.approximation) for row in sees)
    changed = ((LIST_NAMES[row.pairs], row.changed, row.approximation) for row in data.lists_differ)
    return Text(
        f"Over {settings['verdicts']:,} random configurations, {settings['configurations']} (the same for all, "
        f"{settings['surface_verdicts']:,} of them for surface points). A verdict by centres (eq. 21) takes at most "
        f"{significant(slowest, 2)} µs in the median; every surface point against every other, as the paper did "
        f"before, takes {significant(min(plain), 2)} to {significant(max(plain), 2)} s. Eq. 18, which asks for points "
        f"that coincide, sees {sum(row.surface_collides for row in blind):,} of "
        f"{sum(row.centres_collide for row in blind):,} collisions; eq. 20, which allows for the grid's spacing, "
        f"reports collisions that centres do not: {_count(extra)}.\n\n"
        f"The list decides, too. Verdicts that differ from Formula 22 as meant: {_count(changed)}."
    )


def _count(rows: Iterable[tuple[str, int, str]]) -> str:
    """Counts by name and approximation: `all non-adjacent 3 (typical), 363 (improved)`."""
    found: dict[str, list[str]] = {}
    for name, count, approximation in rows:
        found.setdefault(name, []).append(f"{count:,} ({approximation})")
    return "; ".join(f"{name} {', '.join(counts)}" for name, counts in found.items())


def _name_grid(row: SurfaceDifference) -> str:
    return " × ".join(map(str, row.grid))


def _make_lists(data: Detection) -> Table:
    count = f"{data.settings['verdicts']:,}"
    return make_table(
        zip(data.lists, data.measured.lists, strict=True),
        label("spheres", lambda row: row[0].approximation),
        label("list of pairs", lambda row: LIST_NAMES[row[0].pairs]),
        ours("component pairs", "", lambda row: f"{row[0].component_pairs}"),
        ours("sphere pairs", "", lambda row: f"{row[0].sphere_pairs}"),
        ours("colliding", "", lambda row: f"{row[0].colliding:,} of {count}"),
        ours("median", "µs", lambda row: significant(1e6 * row[1].median_s), BY_CENTRES),
        ours("p95", "µs", lambda row: significant(1e6 * row[1].p95_s), BY_CENTRES),
        ours("mean", "µs", lambda row: significant(1e6 * row[1].mean_s), BY_CENTRES),
        caption="Lists of pairs, by centres (eq. 21)",
        note=f"The time includes {data.settings['time_includes']}; {data.settings['threads']} thread. Median and "
        "p95 judge each configuration again and again; the mean takes them one after the other.",
    )


def _make_differences(data: Detection) -> Table:
    return make_table(
        data.lists_differ,
        label("spheres", lambda row: row.approximation),
        label("list", lambda row: LIST_NAMES[row.pairs]),
        label("compares also", lambda row: name_pairs(row.pairs_added)),
        label("does not compare", lambda row: name_pairs(row.pairs_missing)),
        ours("collide by this list alone", "", lambda row: f"{row.only_this_collides:,}"),
        ours("by Formula 22 alone", "", lambda row: f"{row.only_the_other_collides:,}"),
        caption="Verdicts that differ from those over Formula 22 as meant",
        note=f"Of {data.settings['verdicts']:,} configurations.",
    )


def _make_surface(data: Detection) -> Table:
    return make_table(
        data.surface_differs,
        label("spheres", lambda row: row.approximation),
        label("rule", lambda row: row.rule),
        (Column("points a sphere"), _name_grid),
        label("home", lambda row: Cell("collides", "off") if row.home_collides else "free", mark="ours"),
        ours("colliding by points", "", lambda row: f"{row.surface_collides:,}"),
        ours("by centres", "", lambda row: f"{row.centres_collide:,}"),
        ours("by points alone", "", lambda row: f"{row.only_surface_collides:,}"),
        ours("by centres alone", "", lambda row: f"{row.only_centres_collide:,}"),
        caption="Surface points against centres, pairs of Formula 22",
        note=f"Of {data.settings['surface_verdicts']:,} configurations. Where points call home a collision (≠), "
        "their spacing is wider than the clearance that centres see there ([Table 2](#table-2)).",
    )


def _make_times(data: Detection) -> Table:
    settings, surface = data.settings, data.measured.surface
    centres_s = {row.approximation: row.median_s for row in data.measured.lists if row.pairs == "formula_22"}
    return make_table(
        ((row, centres_s[row.approximation], row.every_point.median_s) for row in surface),
        label("spheres", lambda row: row[0].approximation),
        ours("centres", "µs", lambda row: significant(1e6 * row[1])),
        ours("points that can matter", "µs", lambda row: significant(1e6 * row[0].quick.median_s)),
        ours("every point", "ms", lambda row: significant(1e3 * row[2])),
        ours("every point / centres", "", lambda row: fixed(row[2] / row[1], 0)),
        caption="Median time of a verdict, pairs of Formula 22",
        note=f"Every point: {count_of(settings['plain_verdicts'], 'configuration')}; the others "
        f"{settings['timed_verdicts']}. Of the verdicts by every point {sum(row.same_verdicts for row in surface)} of "
        f"{sum(row.every_point.timed for row in surface)} are those by the points that can matter.",
    )
