"""The figures of Dong and Zhao, drawn again."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ikde.paper.inputs import Inputs
from ikde.paper.manipulability import SHOWN, Manipulability, PairOptimum, read_arm, read_surfaces
from ikde.paper.optima import SPACE_STEP_DEG, TURN_DEG, spread_pair, turn_axis
from ikde.paper.tracked_arm import TrackedArm, compute_reach, compute_w1, compute_w2
from ikde.plot.charts import Event, Line, Panel, plot_lines, plot_panels
from ikde.plot.images import to_svg
from ikde.plot.style import Axis
from ikde.plot.surfaces import Mark, Zero, plot_surface
from ikde.report.numbers import significant
from ikde.report.page import Block, Details, Figure, Gallery, Text

THETA = {"theta1": "θ1", "theta2": "θ2", "theta3": "θ3", "theta4": "θ4"}
UNIFORM_DEG = (360.0, 240.0, 120.0)  # how far theta2 .. theta4 turn in figure 2: ours
DRAWN_STEP_DEG = 4.5
TURN: dict[str, Any] = {"unit": "deg", "limits": (0.0, TURN_DEG)}


def draw_manipulability(data: Manipulability, inputs: Inputs) -> tuple[Block, ...]:
    """The best over two angles along the third, Figures 3 to 5 for both chains, and Figure 2."""
    arms = {chain.name: read_arm(inputs.tracked, chain) for chain in SHOWN}
    arm = arms[SHOWN[0].name]
    return (
        Text(
            "**The figures, drawn again**, with the calibrated lengths and for both chains. There is nothing to "
            "compare them with."
        ),
        Gallery(tuple(_draw_singular(replace(arm, arm_offset_m=offset)) for offset in (0.0, arm.arm_offset_m))),
        Gallery(tuple(_draw_along(data, name) for name in ("theta4", "theta3", "theta2"))),
        Gallery(tuple(_draw_pair(row, arms[row.chain], inputs.dong_zhao) for row in data.optima)),
        Details("Figure 2: three angles that move uniformly", (_draw_uniform(arms),)),
    )


def _draw_singular(arm: TrackedArm) -> Figure:
    """w1 over theta2 and theta3 with the others 0, where six of the listed configurations are."""
    axis = np.radians([*turn_axis(DRAWN_STEP_DEG), TURN_DEG])
    theta = np.zeros((len(axis), len(axis), 4))
    theta[..., 1], theta[..., 2] = axis[:, None], axis
    values = compute_w1(arm, theta)
    offset = f"l_m = {arm.arm_offset_m:g} m"
    drawn = plot_surface(
        Axis(label="θ3", **TURN),
        Axis(label="θ2", **TURN),
        values / values.max(),
        bar=Axis(label="w1 / its largest"),
        marks=[Mark(label="listed as singular", places=[(0.0, 90.0), (180.0, 90.0), (360.0, 90.0)])],
        zero=Zero(label="w1 = 0", values=arm.arm_offset_m - compute_reach(arm, theta).outward),
    )
    caption = (
        f"w1 over θ2, θ3 at θ1 = θ4 = 0, as printed, {offset}: it is 0 on whole lines, not only where it is listed."
    )
    return Figure(image=to_svg(drawn), alt=caption, caption=caption)


def _draw_pair(row: PairOptimum, arm: TrackedArm, printed: Mapping[str, Any]) -> Figure:
    surface = next(surface for surface in read_surfaces(printed) if surface.figure == row.figure)
    values = compute_w2(arm, spread_pair(surface, DRAWN_STEP_DEG))
    values = np.pad(values / values.max(), ((0, 1), (0, 1)), mode="wrap")  # 360 deg is 0
    first, second = (Axis(label=THETA[name], **TURN) for name in row.pair)
    marks = [
        Mark(label="largest", places=[(row.top_deg[1], row.top_deg[0])]),
        Mark(label="printed optimum", places=[(row.undone_deg[1], row.undone_deg[0])]),
    ]
    drawn = plot_surface(second, first, values, marks=marks, bar=Axis(label="w2 / its largest"))
    at = f"{THETA[row.third]} = {row.third_deg:.4g} deg"
    top = f"largest {significant(row.w2)}"
    caption = f"Figure {row.figure}, {row.chain}: w2 over {name_angles(row.pair)} at {at}; {top} with lengths in m."
    return Figure(image=to_svg(drawn), alt=caption, caption=caption)


def _draw_along(data: Manipulability, name: str) -> Figure:
    axis = [*turn_axis(SPACE_STEP_DEG), TURN_DEG]
    curves = [np.array(row.along[name]) / max(row.along[name]) for row in data.space]
    lines = [Line(label=row.chain, x=axis, y=[*curve, curve[0]]) for row, curve in zip(data.space, curves, strict=True)]
    figure, at = next((row.figure, row.third_deg) for row in data.optima if row.third == name)
    drawn = plot_lines(
        lines,
        x=Axis(label=THETA[name], **TURN),
        y=Axis(label="largest w2, share", limits=(0.0, None)),
        events=[Event(label="peak by the text", x=at)],
    )
    caption = f"The largest w2 over the two other angles, of its own largest: by the text it peaks at {at:.4g} deg."
    return Figure(image=to_svg(drawn), alt=f"{caption} Figure {figure}", caption=caption)


def _draw_uniform(arms: Mapping[str, TrackedArm]) -> Figure:
    share = np.linspace(0.0, 1.0, 181)
    theta = np.zeros((len(share), 4))
    theta[:, 1:] = np.radians(np.multiply.outer(share, UNIFORM_DEG))
    angles = [Line(label=THETA[f"theta{number}"], x=share, y=np.degrees(theta[:, number - 1])) for number in (2, 3, 4)]
    values = [Line(label=name, x=share, y=compute_w2(arm, theta)) for name, arm in arms.items()]
    drawn = plot_panels(
        [Panel(y=Axis(label="angle", unit="deg"), lines=angles), Panel(y=Axis(label="w2, lengths in m"), lines=values)],
        x=Axis(label="share of the motion"),
    )
    caption = (
        "Figure 2: angles that move uniformly, here 360, 240 and 120 deg (no speed is printed), are straight lines; "
        "below, w2 on the way."
    )
    return Figure(image=to_svg(drawn), alt=caption, caption=caption)


def name_angles(names: Sequence[str]) -> str:
    """`θ2, θ3`."""
    return ", ".join(THETA[name] for name in names)
