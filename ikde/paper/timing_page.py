"""Table 3 as a section of the page."""

from ikde.paper.inputs import Inputs
from ikde.paper.section import make_table
from ikde.paper.timing import ColumnTimes, Ratio, Timing
from ikde.report.numbers import fixed, significant
from ikde.report.page import Column, Section, Table, Text

POINTS = {"surface": "surface points", "centres": "centres"}
METHODS = {"transformation": "spatial transformation", "key_points": "key points"}


def show_timing(data: Timing, _: Inputs) -> Section:
    """The four timings of both approximations, and what they say of ratios."""
    return Section(
        "Table 3: time to place the spheres",
        (
            _introduce(data),
            _make_times(data),
            _make_ratios(data),
            _conclude(data),
            _make_printed_rows(data),
            _make_our_rows(data),
        ),
        anchor="table-3",
    )


def _introduce(data: Timing) -> Text:
    settings = data.settings
    return Text(
        f"Along the published motion, at {settings['moments']} moments; ours are medians over {settings['rounds']} "
        "rounds in which all columns take turns, on one thread, with the quartiles. The paper timed its own program on "
        f"an {settings['printed_on']}, ours are compiled loops: the ratios compare, the seconds hardly do. "
        f"A surface has {' × '.join(map(str, settings['surface_grid']))} points a sphere."
    )


def _make_times(data: Timing) -> Table:
    measured, scopes, averages = data.measured, data.settings["scopes"], data.printed_s["average"]
    placing, kinematics = (measured[scope].columns for scope in ("placing", "kinematics"))
    return make_table(
        zip(data.columns, placing, kinematics, strict=True),
        (Column("column", align="left"), lambda row: row[0]["name"]),
        (Column("spheres", align="left"), lambda row: row[0]["approximation"]),
        (Column("what", align="left"), lambda row: POINTS[row[0]["points"]]),
        (Column("by", align="left"), lambda row: METHODS[row[0]["method"]]),
        (Column("printed average", "ms", mark="published"), lambda row: _milliseconds(averages[row[0]["name"]])),
        (Column("median", "µs", group="placing alone", mark="ours"), lambda row: significant(1e6 * row[1].median_s)),
        (Column("quartiles", "µs", group="placing alone", mark="ours"), lambda row: _quartiles(row[1])),
        (Column("median", "µs", group="with kinematics", mark="ours"), lambda row: significant(1e6 * row[2].median_s)),
        (Column("quartiles", "µs", group="with kinematics", mark="ours"), lambda row: _quartiles(row[2])),
        caption="Table 3: one placement of all spheres",
        note=f"Placing alone: {scopes['placing']}. With kinematics: {scopes['kinematics']}.",
    )


def _quartiles(column: ColumnTimes) -> str:
    return " to ".join(significant(1e6 * t) for t in column.quartiles_s)


def _make_ratios(data: Timing) -> Table:
    """What the text says, what its table gives, and ours: time by key points over time by transformation."""
    placing, kinematics = (data.measured[scope].ratios for scope in ("placing", "kinematics"))
    return make_table(
        zip(data.printed_ratios, placing, kinematics, strict=True),
        (Column("what", align="left"), lambda row: POINTS[row[0].points]),
        (Column("spheres", align="left"), lambda row: row[0].approximation),
        (Column("columns", align="left"), lambda row: " / ".join(row[0].columns)),
        (Column("in the text", "%", group="printed", mark="published"), lambda row: fixed(100 * row[0].stated, 0)),
        (
            Column("from its averages", "%", group="printed", mark="published"),
            lambda row: fixed(100 * row[0].from_average, 1),
        ),
        (
            Column("from its rows' medians", "%", group="printed", mark="published"),
            lambda row: fixed(100 * row[0].from_median, 1),
        ),
        (Column("placing alone", "%", group="ours", mark="ours"), lambda row: _format_ratio(row[1])),
        (Column("with kinematics", "%", group="ours", mark="ours"), lambda row: _format_ratio(row[2])),
        caption="Time by key points as a share of the time by spatial transformation",
        note=_say_stated(data),
    )


def _format_ratio(ratio: Ratio) -> str:
    low, high = ratio.quartiles
    return f"{fixed(100 * ratio.median, 1)} ({fixed(100 * low, 1)} to {fixed(100 * high, 1)})"


def _conclude(data: Timing) -> Text:
    """Which way is faster here, from the figures."""
    said = []
    for points, name in POINTS.items():
        medians = [100 * ratio.median for ratio in data.measured["kinematics"].ratios if ratio.points == points]
        gain = "less than" if max(medians) < 100 else "no less than" if min(medians) >= 100 else "about"
        span = " to ".join(fixed(value, 0) for value in sorted(medians))
        said.append(f"{name} by key points take {span} % of the time by transformation ({gain} it)")
    return Text(f"With kinematics included, {'; '.join(said)}.")


def _say_stated(data: Timing) -> str:
    """The two sentences of section 5.3.2, which read differently."""
    stated = {row.points: fixed(100 * row.stated, 0) for row in data.printed_ratios}
    return (
        f"Section 5.3.2: about {stated['surface']} % of the time for surface points, and shorter by "
        f"{stated['centres']} % for centres; see [misprints](#misprints)."
    )


def _make_printed_rows(data: Timing) -> Table:
    """The print's ten rows with its averages, and the means and medians that the rows have."""
    names = [column["name"] for column in data.columns]
    rows = [(f"T{k}", *(_milliseconds(value) for value in row)) for k, row in enumerate(data.printed_rows_s, 1)]
    kinds = (("average", "printed average"), ("mean", "mean of the rows"), ("median", "median of the rows"))
    rows += [(title, *(_milliseconds(data.printed_s[kind][name]) for name in names)) for kind, title in kinds]
    return Table(
        columns=(Column("row", align="left"), *(Column(name, "ms", mark="published") for name in names)),
        rows=tuple(rows),
        caption="Table 3 as printed",
    )


def _make_our_rows(data: Timing) -> Table:
    columns = data.measured["kinematics"].columns
    moments = zip(*(column.rows_s for column in columns), strict=True)
    return Table(
        columns=(Column("moment", align="left"), *(Column(column.name, "µs", mark="ours") for column in columns)),
        rows=tuple((str(k), *(significant(1e6 * t) for t in times)) for k, times in enumerate(moments, 1)),
        caption="Ours at as many moments of the motion, with kinematics: medians",
    )


def _milliseconds(seconds: float) -> str:
    return significant(1e3 * seconds, 4)
