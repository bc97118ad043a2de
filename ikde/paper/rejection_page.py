"""Table 4 as a section of the page."""

from collections.abc import Iterator
from functools import partial
from itertools import product

from ikde.paper.columns import label, make_table, ours, published
from ikde.paper.inputs import APPROXIMATIONS, PAIR_LISTS, Inputs
from ikde.paper.rejection import Gain, GainOrder, ListRate, PrintedRate, Rejection, RejectionRate, TargetRates
from ikde.paper.section import format_range, format_spread, name_pairs
from ikde.plot.charts import Bars, plot_bars
from ikde.plot.images import to_svg
from ikde.plot.style import Axis
from ikde.report.numbers import fixed, significant
from ikde.report.page import Cell, Column, Figure, Section, Table, Text

READING_NAMES = {
    "equal": "equal pairs (Formula 22 as meant, both)",
    "unequal": "unequal pairs (typical: all non-adjacent; improved: Formula 22 as printed)",
}


def show_rejection(data: Rejection, _: Inputs) -> Section:
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


def _list_cells(data: Rejection, reading: str) -> Iterator[tuple[TargetRates, str, PrintedRate, ListRate, ListRate]]:
    """(target, detector, its printed rate, ours of a sample as small, and of the whole one) in a reading."""
    pairing = data.settings["readings"][reading]
    for target, spheres in product(data.targets, APPROXIMATIONS):
        few, many = (sample.rate(spheres, pairing[spheres]) for sample in (target.samples[0], target.samples[-1]))
        yield target, spheres, target.printed[spheres], few, many


def _introduce(data: Rejection) -> Text:
    settings = data.settings
    search = settings["search"]
    return Text(
        "SN solutions of a plain search that ignores collision; CN of them the detector rejects; SR = 1 - CN / SN. One "
        "set of solutions a target is graded by every detector, so the comparison is paired.\n\n"
        "The paper prints neither the search's settings nor the base's range. **Stated setting**, chosen among those "
        f"of the [next section](#sensitivity) because it comes closest to the print: {search['strategy']}, NP = "
        f"{search['population']}, F = {search['weight']}, CR = {search['crossover']}, at most "
        f"{search['generations']:,} generations, updated {search['update'].replace('_', ' ')}, out-of-range values: "
        f"{search['bounds']}, base within ±{settings['base_half_width_mm']:g} mm, the joint limits of [Qiao2022] "
        f"counted in the {settings['limits']} convention, {1e3 * search['position_tolerance_m']:g} mm."
    )


def _make_table(data: Rejection, reading: str) -> Table:
    return make_table(
        _list_cells(data, reading),
        label("target", lambda row: row[0].target),
        label("detector", lambda row: row[1]),
        published("CN of SN", "", lambda row: _count(row[2]), "printed"),
        published("rejected", "%", lambda row: row[2].text, "printed"),
        ours("CN of SN", "", lambda row: _count(row[3]), "ours, as few"),
        ours("CN of SN", "", lambda row: _count(row[4]), "ours"),
        ours("rejected", "%", lambda row: row[4].text, "ours"),
        ours("SR", "%", lambda row: fixed(100 - row[4].percent, 1), "ours"),
        label("print in ours", lambda row: _say(row[4].contains(row[2]))),
        label("ours in print", lambda row: _say(row[2].contains(row[4]))),
        caption=f"Table 4, {READING_NAMES[reading]}",
        note="Rates with Wilson's 95 % interval. The last two columns: whether the printed rate lies within our "
        "interval, and ours within the print's, which allows for its own sample.",
    )


def _count(rate: RejectionRate) -> str:
    return f"{rate.CN:,} of {rate.SN:,}"


def _say(agrees: bool) -> str | Cell:
    return "yes" if agrees else Cell("no", "off")


def _judge(data: Rejection) -> Text:
    """Which printed rates the stated setting meets, by the intervals."""
    lines = []
    for reading, name in READING_NAMES.items():
        cells = [(printed, ours) for *_, printed, _, ours in _list_cells(data, reading)]
        met = sum(printed.contains(ours) for printed, ours in cells)
        exact = sum(ours.contains(printed) for printed, ours in cells)
        worst = max(abs(ours.percent - printed.percent) for printed, ours in cells)
        lines.append(
            f"- {name}: {met} of {len(cells)} of our rates lie within the sampling error of the print, "
            f"{exact} of the printed ones within our narrower intervals; the largest distance {fixed(worst, 1)} points."
        )
    return Text("\n".join(lines))


def _draw(data: Rejection) -> Figure:
    groups = [f"{target.target}, {spheres}" for target, spheres in product(data.targets, APPROXIMATIONS)]
    bars = []
    for reading in READING_NAMES:
        *_, printed, _, rates = zip(*_list_cells(data, reading), strict=True)
        lower, upper = zip(*(rate.interval_pct for rate in rates), strict=True)
        bars.append(
            Bars(
                label=f"ours, {reading} pairs",
                values=[rate.percent for rate in rates],
                lower=lower,
                upper=upper,
                published=[rate.percent for rate in printed],
            )
        )
    return Figure(
        image=to_svg(plot_bars(groups, bars, x=Axis(label="target, detector"), y=Axis(label="rejected", unit="%"))),
        alt="Bars of the rejected share for both targets and detectors in two readings, with the printed rates",
        caption="Rejected solutions in both readings with 95 % intervals; diamonds: the printed rates.",
    )


def _make_lists(data: Rejection) -> Table:
    return make_table(
        product(data.targets, PAIR_LISTS),
        label("target", lambda row: row[0].target),
        label("pairs that both compare", lambda row: row[1].replace("_", " ")),
        ours("rejected, typical", "%", lambda row: row[0].samples[-1].rate("typical", row[1]).text),
        ours("rejected, improved", "%", lambda row: row[0].samples[-1].rate("improved", row[1]).text),
        caption="The same solutions over every list of pairs",
        note="With Wilson's 95 % interval.",
    )


def _make_paired(data: Rejection) -> Table:
    return make_table(
        ((target, paired) for target in data.targets for paired in target.samples[-1].paired),
        label("target", lambda row: row[0].target),
        label("pairs", lambda row: row[1].reading),
        (Column("solutions"), lambda row: f"{row[0].samples[-1].solved:,}"),
        ours("both free", "", lambda row: f"{row[1].both_free:,}"),
        ours("only the improved says free", "", lambda row: f"{row[1].only_improved_free:,}"),
        ours("only the typical says free", "", lambda row: f"{row[1].only_typical_free:,}"),
        ours("both reject", "", lambda row: f"{row[1].both_reject:,}"),
        caption="Both detectors on the same solutions",
    )


def _make_gain(data: Rejection) -> Table:
    lists = data.settings["lists"]
    return make_table(
        ((target, order) for target in data.targets for order in target.samples[-1].gain.orders),
        label("target", lambda row: row[0].target),
        published("in all", "points", lambda row: _gain(row[0].printed_gain), "printed gain"),
        ours("in all", "points", lambda row: _gain(row[0].samples[-1].gain.total), "our gain"),
        label("changed first", lambda row: row[1].first),
        ours("by spheres", "points", lambda row: _step(row[1], "spheres"), "our gain, split"),
        ours("by pairs", "points", lambda row: _step(row[1], "pairs"), "our gain, split"),
        caption="What the improved detector's gain is made of, with unequal pairs",
        note="From the typical spheres over all non-adjacent pairs to the improved ones over Formula 22 as printed, "
        f"which drops {name_pairs(lists['dropped'])} and adds {name_pairs(lists['added'])}. Spheres and pairs "
        "interact, so what each brings depends on which is changed first. With 95 % intervals: paired for ours; the "
        "print's two rates are taken as independent samples.",
    )


def _step(order: GainOrder, what: str) -> str:
    return _gain(order.steps[0 if order.first == what else 1])


def _gain(gain: Gain) -> str:
    return format_range(partial(fixed, digits=1), gain.points, *gain.interval_points)


def _make_times(data: Rejection) -> Table:
    return make_table(
        (
            (target, detection, (detection.verdict_us.median, *detection.verdict_us.quartiles))
            for target in data.measured
            for detection in target.detection
        ),
        label("target", lambda row: row[0].target),
        label("detector", lambda row: row[1].spheres),
        published("printed AT", "s", lambda row: fixed(row[1].printed_AT_s, 4)),
        ours("search: median / p95 / max", "ms", lambda row: format_spread(row[0].search_ms)),
        ours("mean verdict: median (quartiles)", "µs", lambda row: format_range(significant, *row[2])),
        ours("detection in a solve", "%", lambda row: significant(100 * 1e-3 * row[2][0] / row[0].search_ms.median, 2)),
        caption="AT split: search, and one verdict on its solution",
        note="AT is printed as the time of self-collision detection in a solve. Ours is one verdict by centres a "
        "solve: its mean over all solutions, median and quartiles over rounds. The search's spread is over the solves, "
        "each timed while all cores are busy.",
    )
