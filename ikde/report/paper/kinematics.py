"""Formula 23 and Figure 6."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ikde.model.robot import Robot
from ikde.plot.images import to_png
from ikde.plot.pose import plot_frames
from ikde.report.numbers import fixed, significant, vector
from ikde.report.page import Cell, Column, Figure, Gallery, Section, Table, Text
from ikde.scene.drawn_pose import draw_frames

MODEL_NAMES = {"key_point": "key points, Table 1(b)", "classical": "Denavit-Hartenberg, Table 1(a)"}


def make_kinematics(data: Mapping[str, Any], robots: Mapping[str, Robot]) -> Section:
    """Both models beside the print, and their frames drawn."""
    return Section(
        "Formula 23 and Figure 6: kinematics",
        (_introduce(data), _make_table(data), _draw(data, robots)),
        anchor="formula-23",
    )


def _introduce(data: Mapping[str, Any]) -> Text:
    exact, rounding = data["exact"], data["settings"]["rounding_mm"]
    farthest = max(max(point["difference_to_meant_mm"].values()) for point in exact["points"])
    return Text(
        f"Where the arm's frames stand at the classical home, q = (90, 0, 0, 0, 180, 0) deg. Both models are the same "
        f"arm: their points differ by at most {significant(exact['models_differ_mm'], 2)} mm. With the misprints put "
        f"right, the largest difference from the print is {fixed(farthest, 3)} mm; its rounding allows {rounding} mm."
    )


def _make_table(data: Mapping[str, Any]) -> Table:
    columns = (
        Column("point", align="left"),
        Column("frame", align="left"),
        Column("printed x, y, z", "mm", mark="published"),
        *(Column(f"{name}: x, y, z", "mm", mark="ours") for name in MODEL_NAMES.values()),
        Column("largest difference", "mm"),
    )
    return Table(
        columns=columns,
        rows=tuple(_make_row(point) for point in data["exact"]["points"]),
        caption="Formula 23: frames of the arm in the world",
        note="A point marked ≠ is a misprint: " + "; ".join(_misprints(data)) + ".",
    )


def _make_row(point: Mapping[str, Any]) -> tuple[str | Cell, ...]:
    difference = max(point["difference_mm"].values())
    shown = fixed(difference, 3)
    return (
        point["names"]["classical"],
        point["names"]["key_point"],
        vector(point["printed_mm"], 1),
        *(vector(point["ours_mm"][model], 2) for model in MODEL_NAMES),
        Cell(shown, "off") if point["misprint"] else shown,
    )


def _misprints(data: Mapping[str, Any]) -> list[str]:
    points = [point for point in data["exact"]["points"] if point["misprint"]]
    return [
        f"point {p['names']['classical']} is printed {vector(p['printed_mm'], 1)}, meant {vector(p['meant_mm'], 1)}"
        for p in points
    ]


def _draw(data: Mapping[str, Any], robots: Mapping[str, Robot]) -> Gallery:
    figures = []
    for entry in data["exact"]["figures"]:
        name = MODEL_NAMES[entry["model"]]
        pose = draw_frames(robots[entry["model"]], np.array(entry["q"]), entry["frames"], title=name)
        figures.append(
            Figure(
                image=to_png(plot_frames(pose), dpi=90),
                alt=f"Frames of the arm: {name}",
                caption=f"Figure 6: {name}; x red dotted, y green solid, z blue dashed.",
            )
        )
    return Gallery(tuple(figures))
