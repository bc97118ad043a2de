"""Table 5 and Figure 8: the published solutions graded again, and ours."""

from collections.abc import Mapping
from typing import Any

from ikde.model.robot import Robot
from ikde.report.numbers import fixed
from ikde.report.page import Cell, Column, Gallery, Section, Table, Text
from ikde.report.paper.pictures import draw_robot

DETECTORS = ("typical", "improved")
JOINTS = ("d_x", "d_y", "q_z", "q1", "q2", "q3", "q4", "q5", "q6")
DIGITS = 5e-5  # mm: half a unit of the printed errors' last digit
Data = Mapping[str, Any]


def make_solutions(data: Data, robot: Robot) -> Section:
    """Every printed row with its error and verdicts, rows of our own, and free beside colliding ones drawn."""
    exact = data["exact"]
    return Section(
        "Table 5 and Figure 8: solutions",
        (
            _introduce(data),
            _make_published(exact["published"]),
            _make_ours(data),
            _make_joints(exact["published"], "Table 5: joint values as printed", "published"),
            _make_joints(exact["ours"], "Joint values of ours", "ours"),
            _draw(data, robot),
        ),
        anchor="table-5",
    )


def _introduce(data: Data) -> Text:
    rows = data["exact"]["published"]
    met = sum(_meets(row, "printed") for row in rows)
    labels = sum(row["label"]["agrees"] for row in rows)
    return Text(
        f"ME is the largest error per axis. Of {len(rows)} printed rows, {met} show their ME to four digits, and "
        f"{labels} their label: s rows are free with both detectors, f rows collide with the typical one. What does "
        "not is marked ≠; the [misprints](#misprints) have the evidence."
    )


def _meets(row: Data, which: str) -> bool:
    return abs(row["ME_mm"][which] - row["ME_mm"]["ours"]) < DIGITS


def _make_published(rows: list[Data]) -> Table:
    return Table(
        columns=(
            Column("target", align="left"),
            Column("row", align="left"),
            Column("printed", "mm", group="ME", mark="published"),
            Column("ours", "mm", group="ME", mark="ours"),
            Column("error in x, y, z", "mm", mark="ours"),
            Column("printed", align="left", group="label", mark="published"),
            Column("ours", align="left", group="label", mark="ours"),
            *(Column(name, "mm", group="clearance", mark="ours") for name in DETECTORS),
        ),
        rows=tuple(_published_row(row) for row in rows),
        caption="Table 5: the printed solutions, graded again",
        note=_explain([row for row in rows if row["misprint"]]),
    )


def _published_row(row: Data) -> tuple[str | Cell, ...]:
    printed = fixed(row["ME_mm"]["printed"], 4)
    return (
        row["target"],
        row["row"],
        printed if _meets(row, "printed") else Cell(printed, "off"),
        fixed(row["ME_mm"]["ours"], 4),
        _errors(row),
        row["label"]["printed"] if row["label"]["agrees"] else Cell(row["label"]["printed"], "off"),
        row["label"]["ours"],
        *_clearances(row),
    )


def _explain(rows: list[Data]) -> str:
    """Each misprint, and what was meant where that is known."""
    said = []
    for row in rows:
        meant = f": {fixed(row['misprint']['ME_mm'], 4)} mm is meant" if "ME_mm" in row["misprint"] else ""
        said.append(f"Target {row['target']}, {row['row']}: misprint “{row['misprint']['see']}”{meant}.")
    return " ".join(said)


def _errors(row: Data) -> str:
    return ", ".join(fixed(error, 4) for error in row["error_mm"])


def _clearances(row: Data) -> tuple[str, ...]:
    return tuple(fixed(row["detectors"][name]["clearance_mm"], 2) for name in DETECTORS)


def _make_ours(data: Data) -> Table:
    settings = data["settings"]
    return Table(
        columns=(
            Column("target", align="left"),
            Column("row", align="left"),
            Column("ME", "mm", mark="ours"),
            Column("error in x, y, z", "mm", mark="ours"),
            *(Column(name, "mm", group="clearance", mark="ours") for name in DETECTORS),
            Column("attempts", mark="ours"),
            Column("stream", mark="ours"),
        ),
        rows=tuple(
            (
                row["target"],
                row["row"],
                fixed(row["largest_error_mm"], 4),
                _errors(row),
                *_clearances(row),
                str(row["attempts"]),
                str(row["stream"]),
            )
            for row in data["exact"]["ours"]
        ),
        caption=f"Solutions of ours, method {settings['method']}, {settings['position_tolerance_mm']:g} mm, base "
        f"within ±{settings['base_range_mm']:g} mm, seed {settings['seed']}",
        note=f"s rows: {settings['free']}. f rows: {settings['colliding']}.",
    )


def _make_joints(rows: list[Data], caption: str, mark: Any) -> Table:
    return Table(
        columns=(
            Column("target", align="left"),
            Column("row", align="left"),
            *(Column(name, "mm" if name in ("d_x", "d_y") else "rad", mark=mark) for name in JOINTS),
        ),
        rows=tuple((row["target"], row["row"], *(fixed(value, 4) for value in row["printed_q"])) for row in rows),
        caption=caption,
        note="Counted as in the classical model.",
    )


def _draw(data: Data, robot: Robot) -> Gallery:
    """Of each target one free and one colliding solution of ours, as both detectors see them."""
    figures = []
    for target, position in data["settings"]["targets_mm"].items():
        rows = {row["row"]: row for row in data["exact"]["ours"] if row["target"] == target}
        for row in (rows["s1"], rows["f1"]):
            for name in DETECTORS:
                seen = row["detectors"][name]
                state = "free"
                if seen["collides"]:
                    state = f"collision of {', '.join(seen['colliding_components'])}"
                caption = (
                    f"Figure 8: target {target}, {row['row']}, {name}: {state}; clearance "
                    f"{fixed(seen['clearance_mm'], 1)} mm."
                )
                figures.append(draw_robot(robot, row["q"], name, caption=caption, target_mm=position))
    return Gallery(tuple(figures))
