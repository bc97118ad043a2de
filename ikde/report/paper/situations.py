"""Situations 1 to 3 of section 5.4, Figures 9 to 11."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from ikde.model.robot import Robot
from ikde.plot.charts import Event, Line, plot_lines
from ikde.plot.images import to_svg
from ikde.plot.style import Axis
from ikde.report.markup import verbatim
from ikde.report.numbers import fixed
from ikde.report.page import Block, Cell, Column, Figure, Gallery, Section, Table, Text
from ikde.report.paper.pictures import draw_robot

FIGURES = {"1": "Figure 9", "2": "Figure 10", "3": "Figure 11"}
Data = Mapping[str, Any]


def make_situations(data: Data, robot: Robot) -> Section:
    """Clearance over time for both detectors, their detections, and the simulator's contact after them."""
    situations = data["exact"]["situations"]
    return Section(
        "Situations 1 to 3 and Figures 9 to 11: motions",
        (
            _introduce(data),
            _make_table(situations),
            *(block for situation in situations for block in _show(situation, robot)),
        ),
        anchor="situations",
    )


def _introduce(data: Data) -> Text:
    detections = [d for situation in data["exact"]["situations"] for d in situation["detectors"]]
    agree = sum(detection["agrees"] for detection in detections)
    return Text(
        f"Uniform motions of ten seconds. A detector looks {data['settings']['grid']}; each situation looks at its own "
        f"pairs. {agree} of {len(detections)} printed angles are detected at exactly the printed grid point. The "
        "onset is where the spheres first touch, which the grid cannot show. The contact is that of the true shapes "
        "in the paper's simulator (V-REP): how early a detector speaks is what its spheres give away."
    )


def _make_table(situations: list[Data]) -> Table:
    return Table(
        columns=(
            Column("situation", align="left"),
            Column("detector", align="left"),
            Column("printed", "deg", group="detected", mark="published"),
            Column("ours", "deg", group="detected", mark="ours"),
            Column("onset", "deg", mark="ours"),
            Column("deciding pair", align="left", mark="ours"),
            Column("printed", "deg", group="contact in V-REP", mark="published"),
            Column("meant", "deg", group="contact in V-REP"),
            Column("at", "s", group="contact in V-REP", mark="published"),
            Column("by the print", "deg", group="early"),
            Column("by ours", "deg", group="early", mark="ours"),
        ),
        rows=tuple(_make_row(situation, detection) for situation in situations for detection in situation["detectors"]),
        caption="Section 5.4: detection against contact",
        note="A contact marked ≠ does not fit its own time on the uniform motion; “early by” takes the angle meant. "
        f"Ours is from the onset, the print's from its grid. {_explain(situations)}",
    )


def _explain(situations: list[Data]) -> str:
    """The places of the misprints, whose evidence stands in the section of misprints."""
    entries = [entry["misprint"] for s in situations for entry in (s, s["simulator"]) if entry["misprint"]]
    places = "; ".join(verbatim(entry["see"]) for entry in entries)
    return f"[Misprints](#misprints): {places}." if entries else ""


def _make_row(situation: Data, detection: Data) -> tuple[str | Cell, ...]:
    contact = situation["simulator"]["angle_deg"]
    printed_contact = fixed(contact["printed"], 1)
    if detection["detected_deg"] is None:
        ours = (Cell("never", "off"), "–", "–")
        early = ("–", "–")
    else:
        detected = fixed(detection["detected_deg"], 2)
        ours = (
            detected if detection["agrees"] else Cell(detected, "off"),
            fixed(detection["onset_deg"], 3),
            " – ".join(detection["pair"]),
        )
        early = (fixed(detection["early_deg"]["printed"], 2), fixed(detection["early_deg"]["ours"], 2))
    return (
        f"{situation['situation']}, {situation['varies']}",
        detection["detector"],
        fixed(detection["printed_deg"], 2),
        *ours,
        printed_contact if contact["printed"] == contact["meant"] else Cell(printed_contact, "off"),
        fixed(contact["meant"], 1),
        fixed(situation["simulator"]["t_s"], 2),
        *early,
    )


def _show(situation: Data, robot: Robot) -> tuple[Block, ...]:
    """One situation: what moves, the curve, and the robot at each detection."""
    number = situation["situation"]
    start = situation["start_deg"]
    printed = f" (printed: {_angles(start['printed'])})" if start["printed"] != start["meant"] else ""
    text = Text(
        f"**Situation {number}**: from {_angles(start['meant'])}{printed} to {_angles(situation['end_deg'])} deg, "
        f"{situation['pair_count']} pairs (`{situation['pairs']}`)."
    )
    return text, _chart(situation), _draw(situation, robot)


def _angles(values: list[float]) -> str:
    return f"({', '.join(f'{value:g}' for value in values)})"


def _chart(situation: Data) -> Figure:
    curve = situation["curve"]
    found = [d for d in situation["detectors"] if d["detected_deg"] is not None]
    events = [
        Event(label=f"{d['detector']} detects, {d['detected_s']:.2f} s", x=d["detected_s"], line=d["detector"])
        for d in found
    ]
    contact, printed_deg = situation["simulator"], situation["simulator"]["angle_deg"]["printed"]
    events.append(Event(label=f"contact in V-REP, {contact['t_s']:.2f} s", x=contact["t_s"]))
    if contact["misprint"]:
        label = f"its printed angle, {printed_deg:g} deg, {contact['angle_at_s']:.2f} s"
        events.append(Event(label=label, x=contact["angle_at_s"]))
    figure = plot_lines(
        [Line(label=name, x=curve["t_s"], y=values) for name, values in curve["clearance_mm"].items()],
        x=Axis(label="time", unit="s"),
        y=Axis(label="clearance", unit="mm"),
        events=events,
        level=(0.0, "touching"),
    )
    name = f"{FIGURES[situation['situation']]}, Situation {situation['situation']}"
    return Figure(
        image=to_svg(figure),
        alt=f"{name}: clearance over time for both detectors, with detections and the simulator's contact",
        caption=f"{name}: clearance over time.",
    )


def _draw(situation: Data, robot: Robot) -> Gallery:
    pictures = []
    for detection in situation["detectors"]:
        if detection["detected_deg"] is None:
            continue
        name = detection["detector"]
        looks = replace(robot.detectors[name], pairs=situation["pairs"])
        caption = (
            f"Situation {situation['situation']} at the {name} detection, {situation['varies']} = "
            f"{fixed(detection['detected_deg'], 2)} deg: {' – '.join(detection['pair'])}, clearance "
            f"{fixed(detection['clearance_mm']['detected'], 1)} mm."
        )
        pictures.append(draw_robot(robot, detection["q_detected"], looks, caption=caption))
    return Gallery(tuple(pictures))
