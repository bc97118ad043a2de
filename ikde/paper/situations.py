"""Situations 1 to 3 and Figures 9 to 11: clearance over time, the detected angle, and the real contact after it."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ikde.model.robot import Robot
from ikde.paper.columns import label, make_table, mark_off, ours, published
from ikde.paper.inputs import APPROXIMATIONS, Inputs, meant
from ikde.paper.section import Computed, Misprint, PrintedMeant, PrintedOurs, draw_robot, make_collision
from ikde.paper.sweeps import FINE_STEPS, SECONDS, Sweep, find_onset, read_sweeps
from ikde.plot.charts import Event, Line, plot_lines
from ikde.plot.images import to_svg
from ikde.plot.style import Axis
from ikde.report.markup import verbatim
from ikde.report.numbers import fixed
from ikde.report.page import Block, Cell, Column, Figure, Gallery, Section, Table, Text
from ikde.solver.metrics import compute_clearances

FIGURES = {"1": "Figure 9", "2": "Figure 10", "3": "Figure 11"}


@dataclass(frozen=True, slots=True, kw_only=True)
class Contact:
    """Of the true shapes, in the paper's simulator."""

    t_s: float
    angle_at_s: float  # when the motion passes the printed angle
    angle_deg: PrintedMeant[float]
    misprint: Misprint


@dataclass(frozen=True, slots=True, kw_only=True)
class Detection:
    """One detector, which never touches."""

    detector: str
    printed_deg: float
    agrees: bool
    detected_deg: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Detected(Detection):
    """The angle on the paper's grid, the true onset, and how early both are against the simulator."""

    detected_deg: float
    detected_s: float
    onset_deg: float
    onset_s: float
    pair: list[str]
    clearance_mm: dict[str, float]  # a fine step before, at the detected moment, and at the simulator's contact
    early_s: float
    early_deg: PrintedOurs[float]  # motion given away; positive if the detector speaks before the simulator's contact
    q_detected: list[float]
    q_contact: list[float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Curve:
    """The motion over time, and its clearance by detector."""

    t_s: list[float]
    angle_deg: list[float]
    clearance_mm: dict[str, list[float]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Situation:
    """One motion as both detectors see it, over its own pairs."""

    situation: str
    pairs: str
    pair_count: int
    varies: str
    start_deg: PrintedMeant[list[float]]
    end_deg: list[float]
    misprint: Misprint
    simulator: Contact
    detectors: list[Detection]
    curve: Curve

    @property
    def detected(self) -> list[Detected]:
        """By the detectors that touch."""
        return [detection for detection in self.detectors if isinstance(detection, Detected)]


@dataclass(frozen=True, slots=True, kw_only=True)
class Situations(Computed):
    """All three."""

    situations: list[Situation]

    @property
    def detections(self) -> list[Detection]:
        """Of all situations and detectors."""
        return [detection for situation in self.situations for detection in situation.detectors]


def compute_situations(inputs: Inputs) -> Situations:
    """Each situation's motion as both detectors see it, over its own pairs."""
    entries, points = inputs.published["situations"], inputs.budget.curve_points
    sweeps = read_sweeps(inputs.published)
    return Situations(
        situations=[_compute_situation(inputs.robot, sweep, entries[sweep.name], points) for sweep in sweeps],
        settings={
            "source": "[Qiao2021, section 5.4]",
            "grid": f"every second, then {FINE_STEPS} fine steps in the second that ends in collision",
            "curve_points": points,
        },
    )


def _compute_situation(robot: Robot, sweep: Sweep, entry: Mapping[str, Any], points: int) -> Situation:
    simulator = entry["simulator"]
    return Situation(
        situation=sweep.name,
        pairs=sweep.pairs,
        pair_count=len(robot.pair_lists[sweep.pairs]),
        varies=entry["varies"],
        start_deg=PrintedMeant(printed=entry["start_deg"], meant=sweep.start_deg.tolist()),
        end_deg=entry["end_deg"],
        misprint=entry.get("misprint"),
        simulator=Contact(
            t_s=simulator["t_s"],
            angle_at_s=sweep.time(simulator["angle_deg"]),
            angle_deg=PrintedMeant(printed=simulator["angle_deg"], meant=meant(simulator)["angle_deg"]),
            misprint=simulator.get("misprint"),
        ),
        detectors=[_compute_detection(robot, sweep, simulator, name) for name in APPROXIMATIONS],
        curve=_compute_curve(robot, sweep, np.linspace(0.0, SECONDS, points)),
    )


def _compute_curve(robot: Robot, sweep: Sweep, t_s: np.ndarray) -> Curve:
    Q = sweep.configurations(t_s)
    models = {name: make_collision(robot, name, sweep.pairs) for name in APPROXIMATIONS}
    return Curve(
        t_s=t_s.tolist(),
        angle_deg=[sweep.angle(t) for t in t_s],
        clearance_mm={name: (1e3 * compute_clearances(m, Q).clearance_m).tolist() for name, m in models.items()},
    )


def _compute_detection(robot: Robot, sweep: Sweep, simulator: Mapping[str, Any], detector: str) -> Detection:
    found, printed = find_onset(robot, sweep, detector), sweep.detected_deg[detector]
    if found is None:
        return Detection(detector=detector, printed_deg=printed, agrees=False, detected_deg=None)
    contact_s, contact_deg = simulator["t_s"], meant(simulator)["angle_deg"]
    early_s = contact_s - found.onset_s
    Q = sweep.configurations(np.array([found.detected_s - 1.0 / FINE_STEPS, found.detected_s, contact_s]))
    collision = make_collision(robot, detector, sweep.pairs)
    clearances = compute_clearances(collision, Q)
    speed, detected = sweep.angle(1.0) - sweep.angle(0.0), sweep.angle(found.detected_s)
    before, at, contact = (1e3 * clearances.clearance_m).tolist()
    return Detected(
        detector=detector,
        printed_deg=printed,
        detected_deg=detected,
        agrees=abs(detected - printed) < 1e-6,
        detected_s=found.detected_s,
        onset_deg=sweep.angle(found.onset_s),
        onset_s=found.onset_s,
        pair=list(collision.pairs[clearances.closest_pair[1]]),
        clearance_mm={"step_before": before, "detected": at, "contact": contact},
        early_s=early_s,
        early_deg=PrintedOurs(printed=float(np.sign(speed)) * (contact_deg - printed), ours=abs(speed) * early_s),
        q_detected=Q[1].tolist(),
        q_contact=Q[2].tolist(),
    )


def show_situations(data: Situations, inputs: Inputs) -> Section:
    """Clearance over time for both detectors, their detections, and the simulator's contact after them."""
    situations = data.situations
    return Section(
        "Situations 1 to 3 and Figures 9 to 11: motions",
        (
            _introduce(data),
            _make_table(situations),
            *(block for situation in situations for block in _show(situation, inputs.robot)),
        ),
        anchor="situations",
    )


def _introduce(data: Situations) -> Text:
    detections = data.detections
    agree = sum(detection.agrees for detection in detections)
    return Text(
        f"Uniform motions of ten seconds. A detector checks {data.settings['grid']}; each situation compares its own "
        f"pairs. {agree} of {len(detections)} printed angles are detected at exactly the printed grid point. The "
        "onset is where the spheres first touch, which the grid cannot show. The contact is that of the true shapes "
        "in the paper's simulator (V-REP): how early a detector speaks is what its spheres give away."
    )


def _make_table(situations: list[Situation]) -> Table:
    return make_table(
        ((situation, detection) for situation in situations for detection in situation.detectors),
        label("situation", lambda row: f"{row[0].situation}, {row[0].varies}"),
        label("detector", lambda row: row[1].detector),
        published("printed", "deg", lambda row: fixed(row[1].printed_deg, 2), "detected"),
        ours("ours", "deg", lambda row: _format_angle(row[1]), "detected"),
        ours("onset", "deg", _if_detected(lambda found: fixed(found.onset_deg, 3))),
        label("deciding pair", _if_detected(lambda found: " – ".join(found.pair)), mark="ours"),
        published("printed", "deg", lambda row: _format_contact(row[0].simulator.angle_deg), "contact in V-REP"),
        (Column("meant", "deg", group="contact in V-REP"), lambda row: fixed(row[0].simulator.angle_deg.meant, 1)),
        published("at", "s", lambda row: fixed(row[0].simulator.t_s, 2), "contact in V-REP"),
        (Column("by the print", "deg", group="early"), _if_detected(lambda found: fixed(found.early_deg.printed, 2))),
        ours("by ours", "deg", _if_detected(lambda found: fixed(found.early_deg.ours, 2)), "early"),
        caption="Section 5.4: detection against contact",
        note="A contact marked ≠ does not fit its own time on the uniform motion; “early by” takes the angle meant. "
        f"Ours is from the onset, the print's from its grid. {_explain(situations)}",
    )


def _if_detected(show: Callable[[Detected], str]) -> Callable[[tuple[Situation, Detection]], str]:
    """A cell of what a detector that touches gives; a dash for one that never does."""
    return lambda row: show(row[1]) if isinstance(row[1], Detected) else "–"


def _format_angle(detection: Detection) -> str | Cell:
    if detection.detected_deg is None:
        return Cell("never", "off")
    return mark_off(fixed(detection.detected_deg, 2), detection.agrees)


def _format_contact(angle_deg: PrintedMeant[float]) -> str | Cell:
    return mark_off(fixed(angle_deg.printed, 1), angle_deg.printed == angle_deg.meant)


def _explain(situations: list[Situation]) -> str:
    """The places of the misprints, whose evidence stands in the section of misprints."""
    misprints = [misprint for s in situations for misprint in (s.misprint, s.simulator.misprint) if misprint]
    places = "; ".join(verbatim(misprint["see"]) for misprint in misprints)
    return f"[Misprints](#misprints): {places}." if misprints else ""


def _show(situation: Situation, robot: Robot) -> tuple[Block, ...]:
    """One situation: what moves, the curve, and the robot at each detection."""
    start = situation.start_deg
    printed = f" (printed: {_angles(start.printed)})" if start.printed != start.meant else ""
    text = Text(
        f"**Situation {situation.situation}**: from {_angles(start.meant)}{printed} to {_angles(situation.end_deg)} "
        f"deg, {situation.pair_count} pairs (`{situation.pairs}`)."
    )
    return text, _chart(situation), _draw(situation, robot)


def _angles(values: list[float]) -> str:
    return f"({', '.join(f'{value:g}' for value in values)})"


def _chart(situation: Situation) -> Figure:
    curve, contact = situation.curve, situation.simulator
    events = [
        Event(label=f"{d.detector} detects, {d.detected_s:.2f} s", x=d.detected_s, line=d.detector)
        for d in situation.detected
    ]
    events.append(Event(label=f"contact in V-REP, {contact.t_s:.2f} s", x=contact.t_s))
    if contact.misprint:
        label = f"its printed angle, {contact.angle_deg.printed:g} deg, {contact.angle_at_s:.2f} s"
        events.append(Event(label=label, x=contact.angle_at_s))
    figure = plot_lines(
        [Line(label=name, x=curve.t_s, y=values) for name, values in curve.clearance_mm.items()],
        x=Axis(label="time", unit="s"),
        y=Axis(label="clearance", unit="mm"),
        events=events,
        level=(0.0, "touching"),
    )
    name = f"{FIGURES[situation.situation]}, Situation {situation.situation}"
    return Figure(
        image=to_svg(figure),
        alt=f"{name}: clearance over time for both detectors, with detections and the simulator's contact",
        caption=f"{name}: clearance over time.",
    )


def _draw(situation: Situation, robot: Robot) -> Gallery:
    pictures = []
    for found in situation.detected:
        caption = (
            f"Situation {situation.situation} at the {found.detector} detection, {situation.varies} = "
            f"{fixed(found.detected_deg, 2)} deg: {' – '.join(found.pair)}, clearance "
            f"{fixed(found.clearance_mm['detected'], 1)} mm."
        )
        collision = make_collision(robot, found.detector, situation.pairs)
        pictures.append(draw_robot(collision, found.q_detected, caption=caption))
    return Gallery(tuple(pictures))
