"""Table 3: seconds to place surface points and centres, by spatial transformation and by key points.

Another machine and another program than the paper's, so the seconds say little beside one another; the ratios may.
"""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.kernels.paper import place_by_key_points, place_by_transformation
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot
from ikde.model.robot import Robot
from ikde.paper.columns import label, make_table, ours, published
from ikde.paper.inputs import APPROXIMATIONS, Inputs
from ikde.paper.section import Computed, format_range
from ikde.paper.surface import M_STEPS, N_STEPS, surface_directions
from ikde.report.numbers import fixed, significant
from ikde.report.page import Column, Section, Table, Text

POINTS = {"surface": "surface points", "centres": "centres"}
METHODS = {"transformation": "spatial transformation", "key_points": "key points"}
SCOPES = {
    "placing": "the spheres alone, all poses known",
    "kinematics": "from joint values: poses of the bodies, origins of the key points, then the spheres",
}
LOOP = {"surface": 2, "centres": 300}  # placements in a timed loop: some 50 us, fifty times what its call costs
PLACED = tuple(product(POINTS, APPROXIMATIONS))
TableColumn = Mapping[str, str]  # a column of Table 3: its name, approximation, points, method


@dataclass(frozen=True, slots=True, kw_only=True)
class PrintedRatio:
    """Time by key points over time by transformation: as the text says it, and as the table gives it."""

    points: str
    approximation: str
    columns: list[str]
    stated: float
    from_average: float
    from_mean: float
    from_median: float
    see: str  # the place in the list of misprints


@dataclass(frozen=True, slots=True, kw_only=True)
class ColumnTimes:
    """One column's times."""

    name: str
    median_s: float
    quartiles_s: list[float]
    rows_s: list[float]  # medians, a moment each


@dataclass(frozen=True, slots=True, kw_only=True)
class Ratio:
    """Time by key points over time by transformation, each pair measured in the same round at the same moment."""

    points: str
    approximation: str
    median: float
    quartiles: list[float]


@dataclass(frozen=True, slots=True, kw_only=True)
class ScopeTimes:
    """What is timed in one of `SCOPES`."""

    columns: list[ColumnTimes]
    ratios: list[Ratio]


@dataclass(frozen=True, slots=True, kw_only=True)
class Timing(Computed):
    """Table 3 as printed, and the motion."""

    columns: list[TableColumn]
    printed_rows_s: list[list[float]]
    printed_s: dict[str, dict[str, float]]  # average (printed), mean and median (of the rows), by column
    printed_ratios: list[PrintedRatio]
    placed: dict[str, dict[str, int]]
    q: list[list[float]]
    measured: dict[str, ScopeTimes]


def compute_timing(inputs: Inputs) -> Timing:
    """Table 3's columns as printed and ours, at ten moments of the published motion, and what they say of ratios."""
    robot, table, rounds = inputs.robot, inputs.published["table_3"], inputs.budget.timing_rounds
    placements = [Placement(robot, column) for column in table["columns"]]
    moments = read_motion(table["motion"], len(table["rows_s"]))
    printed = summarise_printed(table)
    return Timing(
        columns=table["columns"],
        printed_rows_s=table["rows_s"],
        printed_s=printed,
        printed_ratios=[_compare_printed(table, printed, *key) for key in PLACED],
        placed={name: _count_points(robot, name) for name in APPROXIMATIONS},
        q=moments.tolist(),
        measured={scope: _measure(placements, moments, scope, rounds) for scope in SCOPES},
        settings={
            "source": "[Qiao2021, Table 3 and section 5.3.2]",
            "printed_on": inputs.published["computer"],
            "scopes": SCOPES,
            "rounds": rounds,
            "moments": len(moments),
            "placements_in_a_loop": LOOP,
            "surface_grid": [M_STEPS, N_STEPS],
            "threads": 1,
        },
    )


def read_motion(motion: Mapping[str, Any], moments: int) -> Floats:
    """Configurations [moments, 9] of the published motion in m and rad, its start and end among them."""
    arm = np.linspace(motion["start_deg"], motion["end_deg"], moments)
    return np.radians(np.hstack([np.tile(np.asarray(motion["base"], dtype=float), (moments, 1)), arm]))


def summarise_printed(table: Mapping[str, Any]) -> dict[str, dict[str, float]]:
    """The printed average of each column, and the mean and the median of its ten printed rows."""
    names, rows = [column["name"] for column in table["columns"]], np.array(table["rows_s"])
    summaries = {"average": table["average_s"], "mean": rows.mean(axis=0), "median": np.median(rows, axis=0)}
    return {kind: dict(zip(names, map(float, values), strict=True)) for kind, values in summaries.items()}


def _compare_printed(
    table: Mapping[str, Any], printed: Mapping[str, Mapping[str, float]], points: str, approximation: str
) -> PrintedRatio:
    slow, fast = (table["columns"][index]["name"] for index in _find_columns(table["columns"], points, approximation))
    return PrintedRatio(
        points=points,
        approximation=approximation,
        columns=[fast, slow],
        stated=table["stated_ratio"][points],
        **{f"from_{kind}": values[fast] / values[slow] for kind, values in printed.items()},
        see=table["see"][points],
    )


def _find_columns(columns: Sequence[TableColumn], points: str, approximation: str) -> tuple[int, int]:
    """Indices of the columns of Table 3 that place something by transformation and by key points."""
    asked = {"points": points, "approximation": approximation}
    found = {column["method"]: k for k, column in enumerate(columns) if asked.items() <= column.items()}
    return found["transformation"], found["key_points"]


def _count_points(robot: Robot, approximation: str) -> dict[str, int]:
    spheres = sum(row.count for row in robot.approximations[approximation])
    return {"centres": spheres, "surface": spheres * M_STEPS * N_STEPS}


def clock(run: Callable[[], object]) -> float:
    """Seconds that a call takes."""
    begin = time.perf_counter_ns()
    run()
    return 1e-9 * (time.perf_counter_ns() - begin)


class Placement:
    """One column of Table 3, ready to run; every component takes part, since the detectors' pairs name them all."""

    def __init__(self, robot: Robot, column: TableColumn) -> None:
        self.column = column
        self.robot = pack_robot(robot)
        self.collision = CollisionModel.of(robot, column["approximation"]).arrays
        self.directions = surface_directions() if column["points"] == "surface" else np.empty((0, 3))
        self.T_world_body = np.empty((self.robot.bodies.shape[0], 3, 4))
        self.T_world_frame = np.zeros((self.robot.frame_body.size, 3, 4))
        self.centres = np.empty((3, self.collision.radius.size))
        self.points = np.empty((self.collision.radius.size, len(self.directions), 3))

    def run(self, q: Floats, moves: bool, times: int) -> None:
        """Place everything `times` times, at the poses of `q` [N] if it `moves`, else where the last run left them."""
        shared = (self.robot, self.collision, self.directions, q, moves, times, self.T_world_body)
        if self.column["method"] == "transformation":
            place_by_transformation(*shared, self.centres, self.points)
        else:
            place_by_key_points(*shared, self.T_world_frame, self.centres, self.points)

    def measure(self, q: Floats, moves: bool) -> float:
        """Seconds of one placement."""
        self.run(q, True, 1)
        times = LOOP[self.column["points"]]
        return clock(lambda: self.run(q, moves, times)) / times


def _measure(placements: Sequence[Placement], moments: Floats, scope: str, rounds: int) -> ScopeTimes:
    """Every column at every moment, all of them in turn in every round."""
    moves = scope == "kinematics"
    for placement in placements:
        placement.measure(moments[0], moves)
    times = np.array([[[p.measure(q, moves) for p in placements] for q in moments] for _ in range(rounds)])
    columns = [placement.column for placement in placements]
    return ScopeTimes(
        columns=[_summarise(column, times[:, :, index]) for index, column in enumerate(columns)],
        ratios=[_compare(columns, times, *key) for key in PLACED],
    )


def quartiles(values: Floats) -> tuple[float, list[float]]:
    """The median, and the quartiles."""
    low, median, high = np.percentile(values, (25, 50, 75)).tolist()
    return median, [low, high]


def _summarise(column: TableColumn, times: Floats) -> ColumnTimes:
    """Over all rounds and moments [rounds, moments]."""
    median, spread = quartiles(times)
    rows = np.median(times, axis=0).tolist()
    return ColumnTimes(name=column["name"], median_s=median, quartiles_s=spread, rows_s=rows)


def _compare(columns: Sequence[TableColumn], times: Floats, points: str, approximation: str) -> Ratio:
    slow, fast = _find_columns(columns, points, approximation)
    median, spread = quartiles(times[:, :, fast] / times[:, :, slow])
    return Ratio(points=points, approximation=approximation, median=median, quartiles=spread)


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
        label("column", lambda row: row[0]["name"]),
        label("spheres", lambda row: row[0]["approximation"]),
        label("what", lambda row: POINTS[row[0]["points"]]),
        label("by", lambda row: METHODS[row[0]["method"]]),
        published("printed average", "ms", lambda row: _milliseconds(averages[row[0]["name"]])),
        ours("median", "µs", lambda row: significant(1e6 * row[1].median_s), "placing alone"),
        ours("quartiles", "µs", lambda row: _quartiles(row[1]), "placing alone"),
        ours("median", "µs", lambda row: significant(1e6 * row[2].median_s), "with kinematics"),
        ours("quartiles", "µs", lambda row: _quartiles(row[2]), "with kinematics"),
        caption="Table 3: one placement of all spheres",
        note=f"Placing alone: {scopes['placing']}. With kinematics: {scopes['kinematics']}.",
    )


def _quartiles(column: ColumnTimes) -> str:
    return " to ".join(significant(1e6 * t) for t in column.quartiles_s)


def _make_ratios(data: Timing) -> Table:
    """What the text says, what its table gives, and ours: time by key points over time by transformation."""
    placing, kinematics = (data.measured[scope].ratios for scope in ("placing", "kinematics"))
    stated = {row.points: fixed(100 * row.stated, 0) for row in data.printed_ratios}  # sentences that read differently
    return make_table(
        zip(data.printed_ratios, placing, kinematics, strict=True),
        label("what", lambda row: POINTS[row[0].points]),
        label("spheres", lambda row: row[0].approximation),
        label("columns", lambda row: " / ".join(row[0].columns)),
        published("in the text", "%", lambda row: fixed(100 * row[0].stated, 0), "printed"),
        published("from its averages", "%", lambda row: fixed(100 * row[0].from_average, 1), "printed"),
        published("from its rows' medians", "%", lambda row: fixed(100 * row[0].from_median, 1), "printed"),
        ours("placing alone", "%", lambda row: _format_ratio(row[1]), "ours"),
        ours("with kinematics", "%", lambda row: _format_ratio(row[2]), "ours"),
        caption="Time by key points as a share of the time by spatial transformation",
        note=f"Section 5.3.2: about {stated['surface']} % of the time for surface points, and shorter by "
        f"{stated['centres']} % for centres; see [misprints](#misprints).",
    )


def _format_ratio(ratio: Ratio) -> str:
    return format_range(lambda share: fixed(100 * share, 1), ratio.median, *ratio.quartiles)


def _conclude(data: Timing) -> Text:
    """Which way is faster here, from the figures."""
    said = []
    for points, name in POINTS.items():
        medians = [100 * ratio.median for ratio in data.measured["kinematics"].ratios if ratio.points == points]
        gain = "less than" if max(medians) < 100 else "no less than" if min(medians) >= 100 else "about"
        span = " to ".join(fixed(value, 0) for value in sorted(medians))
        said.append(f"{name} by key points take {span} % of the time by transformation ({gain} it)")
    return Text(f"With kinematics included, {'; '.join(said)}.")


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
