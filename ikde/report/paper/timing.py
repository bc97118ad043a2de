"""Table 3: the time to place spheres."""

from collections.abc import Mapping, Sequence
from typing import Any

from ikde.report.numbers import fixed, significant
from ikde.report.page import Column, Section, Table, Text

POINTS = {"surface": "surface points", "centres": "centres"}
METHODS = {"transformation": "spatial transformation", "key_points": "key points"}


def make_timing(data: Mapping[str, Any]) -> Section:
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


def _introduce(data: Mapping[str, Any]) -> Text:
    settings = data["settings"]
    return Text(
        f"Along the published motion, at {settings['moments']} moments; ours are medians over {settings['rounds']} "
        f"rounds in which all columns take turns, on one thread, with the quartiles. The paper timed its own program "
        "on an "
        f"{settings['printed_on']}, ours are compiled loops: the ratios compare, the seconds hardly do. "
        f"A surface has {' × '.join(map(str, settings['surface_grid']))} points a sphere."
    )


def _make_times(data: Mapping[str, Any]) -> Table:
    exact, measured, scopes = data["exact"], data["measured"], data["settings"]["scopes"]
    return Table(
        columns=(
            Column("column", align="left"),
            Column("spheres", align="left"),
            Column("what", align="left"),
            Column("by", align="left"),
            Column("printed average", "ms", mark="published"),
            Column("median", "µs", group="placing alone", mark="ours"),
            Column("quartiles", "µs", group="placing alone", mark="ours"),
            Column("median", "µs", group="with kinematics", mark="ours"),
            Column("quartiles", "µs", group="with kinematics", mark="ours"),
        ),
        rows=tuple(
            (
                column["name"],
                column["approximation"],
                POINTS[column["points"]],
                METHODS[column["method"]],
                significant(1e3 * exact["printed_s"]["average"][column["name"]], 4),
                *_format_times(measured["placing"]["columns"][index]),
                *_format_times(measured["kinematics"]["columns"][index]),
            )
            for index, column in enumerate(exact["columns"])
        ),
        caption="Table 3: one placement of all spheres",
        note=f"Placing alone: {scopes['placing']}. With kinematics: {scopes['kinematics']}.",
    )


def _format_times(column: Mapping[str, Any]) -> tuple[str, str]:
    return significant(1e6 * column["median_s"]), " to ".join(significant(1e6 * t) for t in column["quartiles_s"])


def _make_ratios(data: Mapping[str, Any]) -> Table:
    """What the text says, what its table gives, and ours: time by key points over time by transformation."""
    measured = data["measured"]
    return Table(
        columns=(
            Column("what", align="left"),
            Column("spheres", align="left"),
            Column("columns", align="left"),
            Column("in the text", "%", group="printed", mark="published"),
            Column("from its averages", "%", group="printed", mark="published"),
            Column("from its rows' medians", "%", group="printed", mark="published"),
            Column("placing alone", "%", group="ours", mark="ours"),
            Column("with kinematics", "%", group="ours", mark="ours"),
        ),
        rows=tuple(
            (
                POINTS[row["points"]],
                row["approximation"],
                " / ".join(row["columns"]),
                fixed(100 * row["stated"], 0),
                fixed(100 * row["from_average"], 1),
                fixed(100 * row["from_median"], 1),
                _format_ratio(measured["placing"]["ratios"], index),
                _format_ratio(measured["kinematics"]["ratios"], index),
            )
            for index, row in enumerate(data["exact"]["printed_ratios"])
        ),
        caption="Time by key points as a share of the time by spatial transformation",
        note=_say_stated(data),
    )


def _format_ratio(ratios: Sequence[Mapping[str, Any]], index: int) -> str:
    low, high = ratios[index]["quartiles"]
    return f"{fixed(100 * ratios[index]['median'], 1)} ({fixed(100 * low, 1)} to {fixed(100 * high, 1)})"


def _conclude(data: Mapping[str, Any]) -> Text:
    """Who is faster here, told from the figures."""
    ratios = data["measured"]["kinematics"]["ratios"]
    said = []
    for points, name in POINTS.items():
        medians = [100 * ratio["median"] for ratio in ratios if ratio["points"] == points]
        gain = "less than" if max(medians) < 100 else "no less than" if min(medians) >= 100 else "about"
        span = " to ".join(fixed(value, 0) for value in sorted(medians))
        said.append(f"{name} by key points take {span} % of the time by transformation ({gain} it)")
    return Text(f"With kinematics included, {'; '.join(said)}.")


def _say_stated(data: Mapping[str, Any]) -> str:
    """The two sentences of section 5.3.2, which read differently."""
    stated = {row["points"]: fixed(100 * row["stated"], 0) for row in data["exact"]["printed_ratios"]}
    return (
        f"Section 5.3.2: about {stated['surface']} % of the time for surface points, and shorter by "
        f"{stated['centres']} % "
        "for centres; see [misprints](#misprints)."
    )


def _make_printed_rows(data: Mapping[str, Any]) -> Table:
    """The print's ten rows with its averages, and the means and medians that the rows have."""
    exact = data["exact"]
    names = [column["name"] for column in exact["columns"]]
    rows = [(f"T{k}", *(_milliseconds(value) for value in row)) for k, row in enumerate(exact["printed_rows_s"], 1)]
    kinds = (("average", "printed average"), ("mean", "mean of the rows"), ("median", "median of the rows"))
    rows += [(title, *(_milliseconds(exact["printed_s"][kind][name]) for name in names)) for kind, title in kinds]
    return Table(
        columns=(Column("row", align="left"), *(Column(name, "ms", mark="published") for name in names)),
        rows=tuple(rows),
        caption="Table 3 as printed",
    )


def _make_our_rows(data: Mapping[str, Any]) -> Table:
    columns = data["measured"]["kinematics"]["columns"]
    moments = zip(*(column["rows_s"] for column in columns), strict=True)
    return Table(
        columns=(Column("moment", align="left"), *(Column(column["name"], "µs", mark="ours") for column in columns)),
        rows=tuple((str(k), *(significant(1e6 * t) for t in times)) for k, times in enumerate(moments, 1)),
        caption="Ours at as many moments of the motion, with kinematics: medians",
    )


def _milliseconds(seconds: float) -> str:
    return significant(1e3 * seconds, 4)
