"""Table 4, and what a user waits for."""

from collections.abc import Mapping
from typing import Any

from ikde.plot.charts import Bars, plot_bars
from ikde.plot.images import to_svg
from ikde.plot.style import Axis
from ikde.report.numbers import fixed, rate, significant, spread
from ikde.report.page import Cell, Column, Figure, Section, Table, Text
from ikde.report.paper.detection import name_pairs

SPHERES = ("typical", "improved")
READING_NAMES = {
    "equal": "equal pairs (Formula 22 as meant, both)",
    "unequal": "unequal pairs (typical: all non-adjacent; improved: Formula 22 as printed)",
}
Data = Mapping[str, Any]


def make_rejection(data: Data) -> Section:
    """Table 4 in both readings, paired, split into spheres and pairs."""
    return Section(
        "Table 4: how many solutions a detector rejects",
        (
            _introduce(data),
            *(_make_table(data, reading) for reading in READING_NAMES),
            _judge(data),
            _draw(data),
            _make_lists(data),
            _make_paired(data),
            _make_gain(data),
            _make_times(data),
        ),
        anchor="table-4",
    )


def make_waiting(data: Data) -> Section:
    """Attempts and time to the first solution that a detector accepts."""
    rows = zip(data["exact"]["rows"], data["measured"]["rows"], strict=True)
    return Section(
        "What a user waits for",
        (
            Text(
                "The same search, started again from a new population until its solution is free. The cells take turns."
            ),
            Table(
                columns=(
                    Column("target", align="left"),
                    Column("pairs", align="left"),
                    Column("detector", align="left"),
                    Column("reached", mark="ours"),
                    Column("attempts: median / p95 / max", mark="ours"),
                    Column("time: median / p95 / max", "ms", mark="ours"),
                ),
                rows=tuple(
                    (
                        exact["target"],
                        exact["pairs"].replace("_", " "),
                        exact["spheres"],
                        f"{exact['reached']:,} of {exact['solves']:,}",
                        " / ".join(f"{exact['attempts'][key]:g}" for key in ("median", "p95", "max")),
                        spread(measured["ms"]),
                    )
                    for exact, measured in rows
                ),
                caption="To the first collision-free solution",
                note="Wall time of a solve while all cores are busy with others.",
            ),
        ),
        anchor="waiting",
    )


def find_rate(sample: Data, spheres: str, pairs: str) -> Data:
    """The rate of one detector over one list of pairs."""
    return next(cell for cell in sample["rates"] if (cell["spheres"], cell["pairs"]) == (spheres, pairs))


def _introduce(data: Data) -> Text:
    settings = data["settings"]
    search = settings["search"]
    return Text(
        "SN solutions of a plain search that ignores collision; CN of them the detector rejects; SR = 1 - CN / SN. One "
        "set of solutions a target is graded by every detector, so the comparison is paired.\n\n"
        "The paper prints neither the search's settings nor the base's range. **Stated setting**, chosen among those "
        "of "
        f"the [next section](#sensitivity) because it comes closest to the print: {search['strategy']}, NP = "
        f"{search['population']}, F = {search['weight']}, CR = {search['crossover']}, at most "
        f"{search['generations']:,} generations, updated {search['update'].replace('_', ' ')}, out-of-range values: "
        f"{search['bounds']}, base within ±{settings['base_half_width_mm']:g} mm, the joint limits of [Qiao2022] "
        f"counted in the {settings['limits']} convention, {1e3 * search['position_tolerance_m']:g} mm."
    )


def _make_table(data: Data, reading: str) -> Table:
    pairing = data["settings"]["readings"][reading]
    return Table(
        columns=(
            Column("target", align="left"),
            Column("detector", align="left"),
            Column("CN of SN", group="printed", mark="published"),
            Column("rejected", "%", group="printed", mark="published"),
            Column("CN of SN", group="ours, as few", mark="ours"),
            Column("CN of SN", group="ours", mark="ours"),
            Column("rejected", "%", group="ours", mark="ours"),
            Column("SR", "%", group="ours", mark="ours"),
            Column("print in ours", align="left"),
            Column("ours in print", align="left"),
        ),
        rows=tuple(
            _make_row(target, spheres, pairing[spheres]) for target in data["exact"]["targets"] for spheres in SPHERES
        ),
        caption=f"Table 4, {READING_NAMES[reading]}",
        note="Rates with Wilson's 95 % interval. The last two columns: whether the printed rate lies within our "
        "interval, "
        "and ours within the print's, which allows for its own sample.",
    )


def _make_row(target: Data, spheres: str, pairs: str) -> tuple[str | Cell, ...]:
    printed = target["printed"][spheres]
    few, many = (find_rate(sample, spheres, pairs) for sample in (target["samples"][0], target["samples"][-1]))
    return (
        target["target"],
        spheres,
        _count(printed),
        rate(printed),
        _count(few),
        _count(many),
        rate(many),
        fixed(100 - many["rejected_pct"], 1),
        _say(_is_inside(printed["rejected_pct"], many)),
        _say(_is_inside(many["rejected_pct"], printed)),
    )


def _count(cell: Data) -> str:
    return f"{cell['CN']:,} of {cell['SN']:,}"


def _is_inside(value_pct: float, cell: Data) -> bool:
    low, high = cell["interval_pct"]
    return low <= value_pct <= high


def _say(agrees: bool) -> str | Cell:
    return "yes" if agrees else Cell("no", "off")


def _judge(data: Data) -> Text:
    """Which printed rates the stated setting meets, told from the intervals."""
    lines = []
    for reading, name in READING_NAMES.items():
        pairing = data["settings"]["readings"][reading]
        cells = [
            (target["printed"][spheres], find_rate(target["samples"][-1], spheres, pairing[spheres]))
            for target in data["exact"]["targets"]
            for spheres in SPHERES
        ]
        met = sum(_is_inside(ours["rejected_pct"], printed) for printed, ours in cells)
        exact = sum(_is_inside(printed["rejected_pct"], ours) for printed, ours in cells)
        worst = max(abs(ours["rejected_pct"] - printed["rejected_pct"]) for printed, ours in cells)
        lines.append(
            f"- {name}: {met} of {len(cells)} of our rates lie within the sampling error of the print, "
            f"{exact} of the printed ones within our narrower intervals; the farthest is {fixed(worst, 1)} points off."
        )
    return Text("\n".join(lines))


def _draw(data: Data) -> Figure:
    targets = data["exact"]["targets"]
    groups = [f"target {target['target']}, {spheres}" for target in targets for spheres in SPHERES]
    printed = [target["printed"][spheres]["rejected_pct"] for target in targets for spheres in SPHERES]
    bars = []
    for reading in READING_NAMES:
        pairing = data["settings"]["readings"][reading]
        cells = [find_rate(t["samples"][-1], spheres, pairing[spheres]) for t in targets for spheres in SPHERES]
        lower, upper = zip(*(cell["interval_pct"] for cell in cells), strict=True)
        bars.append(
            Bars(
                label=f"ours, {reading} pairs",
                values=[cell["rejected_pct"] for cell in cells],
                lower=lower,
                upper=upper,
                published=printed,
            )
        )
    figure = plot_bars([group.replace(", ", "\n") for group in groups], bars, y=Axis(label="rejected", unit="%"))
    return Figure(
        image=to_svg(figure),
        alt="Bars of the rejected share for both targets and detectors in two readings, with the printed rates",
        caption="Rejected solutions in both readings with 95 % intervals; diamonds: the printed rates.",
    )


def _make_lists(data: Data) -> Table:
    rows = []
    for target in data["exact"]["targets"]:
        sample = target["samples"][-1]
        for pairs in dict.fromkeys(cell["pairs"] for cell in sample["rates"]):
            rates = [rate(find_rate(sample, spheres, pairs)) for spheres in SPHERES]
            rows.append((target["target"], pairs.replace("_", " "), *rates))
    return Table(
        columns=(
            Column("target", align="left"),
            Column("pairs that both look at", align="left"),
            *(Column(f"rejected, {spheres}", "%", mark="ours") for spheres in SPHERES),
        ),
        rows=tuple(rows),
        caption="The same solutions over every list of pairs",
        note="With Wilson's 95 % interval.",
    )


def _make_paired(data: Data) -> Table:
    return Table(
        columns=(
            Column("target", align="left"),
            Column("pairs", align="left"),
            Column("solutions"),
            Column("both free", mark="ours"),
            Column("only the improved says free", mark="ours"),
            Column("only the typical says free", mark="ours"),
            Column("both reject", mark="ours"),
        ),
        rows=tuple(
            (
                target["target"],
                f"{paired['reading']}",
                f"{target['samples'][-1]['solved']:,}",
                *(
                    f"{paired[key]:,}"
                    for key in ("both_free", "only_improved_free", "only_typical_free", "both_reject")
                ),
            )
            for target in data["exact"]["targets"]
            for paired in target["samples"][-1]["paired"]
        ),
        caption="Both detectors on the same solutions",
    )


def _make_gain(data: Data) -> Table:
    lists = data["settings"]["lists"]
    return Table(
        columns=(
            Column("target", align="left"),
            Column("in all", "points", group="printed gain", mark="published"),
            Column("in all", "points", group="our gain", mark="ours"),
            Column("changed first", align="left"),
            Column("by spheres", "points", group="our gain, split", mark="ours"),
            Column("by pairs", "points", group="our gain, split", mark="ours"),
        ),
        rows=tuple(
            _gain_row(target, order)
            for target in data["exact"]["targets"]
            for order in target["samples"][-1]["gain"]["orders"]
        ),
        caption="What the improved detector's gain is made of, with unequal pairs",
        note="From the typical spheres over all non-adjacent pairs to the improved ones over Formula 22 as printed, "
        "which "
        f"drops {name_pairs(lists['dropped'])} and adds {name_pairs(lists['added'])}. Spheres and pairs interact, so "
        "what each brings depends on which is changed first. With 95 % intervals: paired for ours; the print's two "
        "rates "
        "are taken as independent samples.",
    )


def _gain_row(target: Data, order: Data) -> tuple[str, ...]:
    spheres, pairs = order["steps"] if order["first"] == "spheres" else reversed(order["steps"])
    return (
        target["target"],
        _gain(target["printed_gain"]),
        _gain(target["samples"][-1]["gain"]["total"]),
        order["first"],
        _gain(spheres),
        _gain(pairs),
    )


def _gain(gain: Data) -> str:
    low, high = gain["interval_points"]
    return f"{fixed(gain['points'], 1)} ({fixed(low, 1)} to {fixed(high, 1)})"


def _make_times(data: Data) -> Table:
    return Table(
        columns=(
            Column("target", align="left"),
            Column("detector", align="left"),
            Column("printed AT", "s", mark="published"),
            Column("search: median / p95 / max", "ms", mark="ours"),
            Column("mean verdict: median (quartiles)", "µs", mark="ours"),
            Column("detection in a solve", "%", mark="ours"),
        ),
        rows=tuple(
            (
                row["target"],
                cell["spheres"],
                fixed(cell["printed_AT_s"], 4),
                spread(row["search_ms"]),
                _quartiles(cell["verdict_us"]),
                significant(100 * 1e-3 * cell["verdict_us"]["median"] / row["search_ms"]["median"], 2),
            )
            for row in data["measured"]
            for cell in row["detection"]
        ),
        caption="AT split: search, and one verdict on its solution",
        note="AT is printed as the time of self-collision detection in a solve. Ours is one verdict by centres a "
        "solve: its "
        "mean over all solutions, median and quartiles over rounds. The search's spread is over the solves, each timed "
        "while all cores are busy.",
    )


def _quartiles(times: Data) -> str:
    low, high = times["quartiles"]
    return f"{significant(times['median'])} ({significant(low)} to {significant(high)})"
