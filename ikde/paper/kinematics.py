"""Formula 23 and Figure 6: where both models put the arm's key points."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.convention import from_convention
from ikde.model.robot import Robot
from ikde.paper.columns import label, make_table, mark_off, ours, published
from ikde.paper.inputs import Inputs, meant
from ikde.paper.section import Computed, Misprint
from ikde.plot.images import to_png
from ikde.plot.pose import plot_frames
from ikde.report.numbers import fixed, length, vector
from ikde.report.page import Cell, Column, Figure, Gallery, Section, Table, Text
from ikde.scene.drawn_pose import draw_frames
from ikde.solver.forward import forward

MODELS = {"key_point": "Table 1(b), key points", "classical": "Table 1(a), Denavit-Hartenberg"}
SHOWN_MODELS = {"key_point": "key points, Table 1(b)", "classical": "Denavit-Hartenberg, Table 1(a)"}
Frames = Mapping[str, Mapping[str, Floats]]  # model -> frame -> T_world_frame


@dataclass(frozen=True, slots=True, kw_only=True)
class Point:
    """A point of Formula 23 as printed, meant, and by both models (by their names); mm in the world."""

    names: dict[str, str]
    printed_mm: list[float]
    meant_mm: list[float]
    misprint: Misprint
    ours_mm: dict[str, list[float]]
    difference_mm: dict[str, float]
    difference_to_meant_mm: dict[str, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Drawn:
    """What Figure 6 draws of one model: the configuration, and the frames along the arm."""

    model: str
    robot: str
    q: list[float]
    frames: list[str]


@dataclass(frozen=True, slots=True, kw_only=True)
class Kinematics(Computed):
    """Every point by both models, which should be one arm."""

    points: list[Point]
    figures: list[Drawn]
    models_differ_mm: float


def compute_kinematics(inputs: Inputs) -> Kinematics:
    """Every point of Formula 23 as printed and by both models."""
    formula, robots = inputs.published["formula_23"], _robots(inputs)
    q = np.radians(formula["q_classical_deg"])
    frames = {model: forward(robot, q, convention="classical") for model, robot in robots.items()}
    return Kinematics(
        points=[_compute_point(point, frames) for point in formula["points"]],
        figures=[
            Drawn(
                model=model,
                robot=robot.name,
                q=from_convention(robot, q, "classical").tolist(),
                frames=["Ob", *(point[model] for point in formula["points"]), robot.tool],
            )
            for model, robot in robots.items()
        ],
        models_differ_mm=_compare_models(formula, frames),
        settings={
            "source": "[Qiao2021, Formula 23]",
            "q_classical_deg": formula["q_classical_deg"],
            "rounding_mm": formula["rounding_mm"],
            "models": MODELS,
        },
    )


def _robots(inputs: Inputs) -> dict[str, Robot]:
    return {"key_point": inputs.robot, "classical": inputs.classical}


def _compute_point(point: Mapping[str, Any], frames: Frames) -> Point:
    right = meant(point)["xyz_mm"]
    ours = {model: 1e3 * frames[model][point[model]][:3, 3] for model in MODELS}
    return Point(
        names={model: point[model] for model in MODELS},
        printed_mm=point["xyz_mm"],
        meant_mm=right,
        misprint=point.get("misprint"),
        ours_mm={model: xyz.tolist() for model, xyz in ours.items()},
        difference_mm={model: float(np.abs(xyz - point["xyz_mm"]).max()) for model, xyz in ours.items()},
        difference_to_meant_mm={model: float(np.abs(xyz - right).max()) for model, xyz in ours.items()},
    )


def _compare_models(formula: Mapping[str, Any], frames: Frames) -> float:
    """Largest distance between the same point of both models."""
    a, b = ([frames[model][point[model]][:3, 3] for point in formula["points"]] for model in MODELS)
    return float(1e3 * np.linalg.norm(np.subtract(a, b), axis=1).max())


def show_kinematics(data: Kinematics, inputs: Inputs) -> Section:
    """Both models beside the print, and their frames drawn."""
    return Section(
        "Formula 23 and Figure 6: kinematics",
        (_introduce(data), _make_table(data.points), _draw(data.figures, _robots(inputs))),
        anchor="formula-23",
    )


def largest_error_mm(data: Kinematics) -> float:
    """Of all points by both models, with the misprints put right."""
    return max(max(point.difference_to_meant_mm.values()) for point in data.points)


def _introduce(data: Kinematics) -> Text:
    return Text(
        f"Where the arm's frames stand at the classical home, q = (90, 0, 0, 0, 180, 0) deg. Both models are the same "
        f"arm: their points differ by {_at_most(data.models_differ_mm)}. With the misprints put "
        f"right, the largest difference from the print is {fixed(largest_error_mm(data), 3)} mm; its rounding allows "
        f"{data.settings['rounding_mm']} mm."
    )


def _at_most(value_mm: float) -> str:
    """`less than 1 nm`, or `at most 7.9 µm`."""
    text = length(1e-3 * value_mm)
    return text.replace("<", "less than") if "<" in text else f"at most {text}"


def _make_table(points: list[Point]) -> Table:
    return make_table(
        points,
        label("point", lambda point: point.names["classical"]),
        label("frame", lambda point: point.names["key_point"]),
        published("printed x, y, z", "mm", lambda point: vector(point.printed_mm, 1)),
        ours(f"{SHOWN_MODELS['key_point']}: x, y, z", "mm", lambda point: vector(point.ours_mm["key_point"], 2)),
        ours(f"{SHOWN_MODELS['classical']}: x, y, z", "mm", lambda point: vector(point.ours_mm["classical"], 2)),
        (Column("largest difference", "mm"), _format_difference),
        caption="Formula 23: frames of the arm in the world",
        note="A point marked ≠ is a misprint: " + "; ".join(_explain(p) for p in points if p.misprint) + ".",
    )


def _format_difference(point: Point) -> str | Cell:
    return mark_off(fixed(max(point.difference_mm.values()), 3), not point.misprint)


def _explain(point: Point) -> str:
    printed, right = vector(point.printed_mm, 1), vector(point.meant_mm, 1)
    return f"point {point.names['classical']} is printed {printed}, meant {right}"


def _draw(drawn: list[Drawn], robots: Mapping[str, Robot]) -> Gallery:
    figures = []
    for entry in drawn:
        name = SHOWN_MODELS[entry.model]
        pose = draw_frames(robots[entry.model], np.array(entry.q), entry.frames, title=name)
        caption = f"Figure 6: {name}; x red dotted, y green solid, z blue dashed."
        figures.append(
            Figure(image=to_png(plot_frames(pose), dpi=90), alt=f"Frames of the arm: {name}", caption=caption)
        )
    return Gallery(tuple(figures))
