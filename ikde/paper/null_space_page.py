"""Sections 2.1, 2.2 and 3 of [Zhang2022] as a section of the page."""

from collections.abc import Iterable

from ikde.paper.columns import label, make_table, ours
from ikde.paper.inputs import Inputs
from ikde.paper.null_space import NullSpace, Singular, Switched
from ikde.plot.charts import Event, Line, plot_lines
from ikde.plot.images import to_svg
from ikde.plot.style import Axis
from ikde.report.numbers import fixed, significant
from ikde.report.page import Code, Figure, Notice, Section, Table, Text

NOISE = 1e-9  # below it a number is rounding
EQUATIONS = """\
(1)      wheel = 1/R [ 1 -1 -(W+L) ; 1  1 -(W+L) ; 1 -1  W+L ; 1  1  W+L ] (Vx, Vy, w)
         twist = R/4 [ 1  1  1  1 ; -1  1 -1  1 ; -k -k  k  k ] wheels,   k = 1/(W+L)
(2)      X += (vx cos h - vy sin h) dt,  Y += (vx sin h + vy cos h) dt,  heading += w dt
(3)      T_WM = Trans(X, Y) Rz(heading)
(4,5)    A = Rz(theta) Tz(d) Tx(a) Rx(alpha), since Table 2 is in the standard convention
(6,7)    T_WT = T_WM T_MR T_RT
(13-16)  qc' = Jc wheels;  s = (R wheel - V) / max(R wheel, V);  V = R wheel (1 - s), or / (1 + s)
(17,18)  x' = [J(phi) Jc, J_we] (wheels, q'),  ten actuators
(19-23)  R = (R1, R2) = (tool x, y, z; platform X, Y, phi);  q' = J# R' + (I - J# J) v
(24)     q1' = J1# R1' + (I - J1# J1) J2# R2'       as printed, tool first
(25)     q2' = J2# R2' + (I - J2# J2) J1# R1'       as printed, platform first
exact    q'  = J1# R1' + (J2 N1)# (R2' - J2 J1# R1'),   N1 = I - J1# J1
(26)     q'  = psi q1' + (1 - psi) q2',   psi a number
(27)     D = |P_i - P_M|
(28)     mu = sqrt(largest / smallest eigenvalue of J J^T)"""


def show_null_space(data: NullSpace, _: Inputs) -> Section:
    """Equations, what follows from them, and runs that are ours."""
    dt_ms = 1e3 * data.settings["dt_s"]
    return Section(
        "Zhang et al. 2022: null space and priority",
        (
            _introduce(data),
            Notice(
                "No figure and no experiment of the paper is about the null space: Figures 7 to 15 are torques, "
                "speeds and tracking "
                "errors of its dynamic control, without a number in the text. So no run below can be compared with a "
                "published one; its targets, gains, mount and the wheels' places are calibrated."
            ),
            Code(EQUATIONS, caption="Equations (1) to (28) with their signs, which our copy of the paper lost."),
            _make_claims(data),
            Text(_explain_laws(data)),
            _make_together(data),
            _chart_held(data),
            Text(_explain_conflict()),
            _make_switched(data.conflict, _caption_conflict(data), _note_conflict(data, dt_ms)),
            _chart_conflict(data),
            _make_switched(
                data.switching,
                "Switching by distance (27): the platform first beyond 1.0 m, the tool first within 0.8 m",
                f"Both tasks can be met. Jumps are the largest of the whole run, in a sample of {dt_ms:g} ms.",
            ),
            _make_singular(data.singular, data),
            _chart_singular(data),
            _make_slipping(data),
            _chart_slip(data),
        ),
        anchor="null-space",
    )


def _introduce(data: NullSpace) -> Text:
    claim = {entry.what: entry.value for entry in data.claims}
    held = {(row.law, row.first): row.tool_mm for row in data.together if row.run.startswith("tool held")}
    return Text(
        "A UR5e on a platform with mecanum wheels, with two tasks: the tool's position and the platform's place. "
        "**Verdict**: the printed laws (24) and (25) meet the first task and disregard what they do to the second: "
        "with the platform "
        f"first, a tool that should stay is dragged {significant(held['printed', 'platform'])} mm away, under exact "
        f"priority {significant(held['exact', 'platform'], 2)} mm. Where both tasks can be met, exact priority "
        "gives the "
        "same speeds in either order (difference below 1e-12), so there is nothing to switch: (26) to (28) matter "
        "for tasks in conflict, near "
        f"singularities and at limits. Read with (5), Table 2 puts the tool "
        f"{fixed(claim['Table 2 read row by row with (5): the tool is off by, median'], 2)} m off: it is in the "
        "standard "
        "convention."
    )


def _make_claims(data: NullSpace) -> Table:
    return make_table(
        data.claims,
        label("equation", lambda claim: claim.equation),
        label("what", lambda claim: claim.what + (" (calibrated)" if claim.kind == "calibrated" else "")),
        ours("value", "", lambda claim: _show(claim.value, claim.unit)),
        caption="What follows from the equations",
        note=f"Derived, but for those marked calibrated, which depend on the mount and on the wheels' places. Of "
        f"random platforms and {data.settings['random_arms']['count']} arms within "
        f"{data.settings['random_arms']['spread_rad']} rad of the start, which is regular; (28) and Table 2 of all "
        "arms. "
        "Shares are of the speed that is wanted. The turn of (2) is 3.2 m long.",
    )


def _show(value: float, unit: str = "") -> str:
    text = "< 1e-9" if abs(value) < NOISE else significant(value)
    return f"{text} {unit}".strip()


def _explain_laws(data: NullSpace) -> str:
    in_metres = next(
        row
        for row in data.together
        if row.law.endswith("m/s") and row.first == "platform" and row.run.startswith("tool held")
    )
    return (
        "**Two tasks at once.** With J1 = [Jb Ja] and J2 = [I 0] by the platform's speeds, (25) moves the tool by "
        "Jb R2' + "
        "Ja Ja^T G R1', G = (Jb Jb^T + Ja Ja^T)^-1: nothing takes Jb R2' away. (24) and (25) would be exact only "
        "for J1 J2# = 0. They depend on the unit of the wheels, too: a pseudo-inverse weighs rad/s of a wheel like "
        "rad/s of a joint. With the platform's speeds in m/s in their place the tool is dragged "
        f"{significant(in_metres.tool_mm)} mm."
    )


def _make_together(data: NullSpace) -> Table:
    return make_table(
        data.together,
        label("run", lambda row: row.run),
        label("law", lambda row: row.law),
        label("first", lambda row: row.first),
        ours("tool, largest", "mm", lambda row: significant(row.tool_mm), "error"),
        ours(
            "platform, largest",
            "mm",
            lambda row: "–" if row.run.startswith("tool") else significant(row.platform_mm),
            "error",
        ),
        ours("platform, end", "mm", lambda row: significant(row.platform_end_mm, 2), "error"),
        caption="Both tasks can be met: printed laws beside exact priority",
        note="The platform's error is that of X, Y and heading, a rad as 1000 mm; where it moves to a place it "
        "begins with all of it. What is left under exact priority is "
        "that of the step.",
    )


def _chart_held(data: NullSpace) -> Figure:
    return _chart(
        data,
        "held",
        Axis(label="error of the tool", unit="mm", log=True),
        "The tool is to stay while the platform moves 0.29 m and turns by 0.3 rad. Both exact laws are one curve.",
        skip_start=True,
    )


def _explain_conflict() -> str:
    return (
        "**Tasks in conflict.** From where the platform should be, the tool's target is out of reach. The platform "
        "comes first; from "
        "8 s on the tool does. To switch psi at once makes the platform jump; smoothly, over 1 s, it does not, and an "
        "intermediate value of what is wanted (Lee, Mansard and Park 2012) does as well. Undamped, exact priority is "
        "useless here: the stretched arm is singular."
    )


def _caption_conflict(data: NullSpace) -> str:
    targets = data.settings["targets"]
    return (
        f"Tasks in conflict: tool to {tuple(targets['tool_m'])} m, platform to ({targets['far'][0]}, "
        f"{targets['far'][1]}) m "
        f"and {targets['far'][2]} rad"
    )


def _note_conflict(data: NullSpace, dt_ms: float) -> str:
    return (
        f"Jumps are the largest round the switch, in a sample of {dt_ms:g} ms. Undamped, rounding decides: here up to "
        f"{significant(data.measured.conflict)} rad/s. Limits of speed: 0.5 m/s, 1 rad/s. Inside limits of "
        "acceleration, too, 5 rad/s^2, the arm still swings about its stretched pose when the switch comes; with "
        "two weights in place of "
        "priority joints chatter between their limits."
    )


def _make_switched(rows: Iterable[Switched], caption: str, note: str) -> Table:
    return make_table(
        rows,
        label("law", lambda row: row.law),
        label("switch", lambda row: row.switch),
        ours("tool", "m", lambda row: _dash(row.tool_m, 3), "error at the end"),
        ours("platform", "m", lambda row: fixed(row.platform_m, 3), "error at the end"),
        ours("fastest joint", "rad/s", lambda row: _dash(row.fastest_joint, 2)),
        ours("joint", "rad/s", lambda row: _dash(row.jump_joint, 4), "jump"),
        ours("platform", "m/s, rad/s", lambda row: fixed(row.jump_platform, 4), "jump"),
        ours("wheel", "rad/s", lambda row: fixed(row.jump_wheel, 3), "jump"),
        caption=caption,
        note=note,
    )


def _dash(value: float | None, digits: int) -> str:
    return "–" if value is None else fixed(value, digits)


def _chart_conflict(data: NullSpace) -> Figure:
    return _chart(
        data,
        "conflict",
        Axis(label="speed of the platform along X", unit="m/s"),
        "Tasks in conflict: the platform's speed round the switch from platform first to tool first.",
        events=(Event(label="switch begins", x=8.0),),
    )


def _make_singular(rows: Iterable[Singular], data: NullSpace) -> Table:
    return make_table(
        rows,
        label("inverse", lambda row: row.law),
        ours("fastest joint", "rad/s", lambda row: _dash(row.fastest_joint, 2)),
        ours("error after 3 s", "mm", lambda row: significant(row.error_mm, 2)),
        caption="An arm drawn straight out of reach at 0.1 m/s, the platform at rest",
        note=f"Undamped, rounding decides: here up to {significant(data.measured.stretched)} rad/s, of which each "
        "step moves a joint by 50 at "
        "most. After 3 s the arm is still regular: to damp everywhere costs accuracy there.",
    )


def _chart_singular(data: NullSpace) -> Figure:
    return _chart(
        data,
        "singular",
        Axis(label="fastest joint", unit="rad/s"),
        "An arm drawn out of reach: the fastest joint, damped everywhere and near the singularity alone.",
    )


def _make_slipping(data: NullSpace) -> Table:
    slip = data.published["slip"]
    times = " and ".join(f"{first} to {last} s" for first, last in slip["seconds"])
    return make_table(
        data.slipping,
        label("what the floor sees", lambda row: row.reading),
        label("feedback", lambda row: "yes" if row.feedback else "no"),
        ours("tool", "mm", lambda row: significant(row.tool_mm), "largest error"),
        ours("platform", "mm", lambda row: _show(row.platform_mm), "largest error"),
        ours("50 s after the first slip", "mm", lambda row: significant(row.after_50_s_mm, 2), "tool"),
        ours("at 300 s", "mm", lambda row: significant(row.end_mm, 2), "tool"),
        caption=f"A stand-in of ours for the paper's slip: ratio {slip['ratio']} of all wheels from {times}",
        note="The ratio and its times are published, all else is ours: the platform on a circle of 1 m radius in "
        "300 s, the tool on one of 0.1 m. "
        "By (14) a ratio of 0.8 leaves 0.2 of the way; (15) makes 1.8 of it. Feedback sees the true place: with dead "
        "reckoning alone an error stays. Equal slip of all wheels scales the twist and keeps its direction.",
    )


def _chart_slip(data: NullSpace) -> Figure:
    return _chart(
        data,
        "slip",
        Axis(label="error of the tool", unit="mm", log=True),
        "Slip with feedback: the error of the tool, by what a slip ratio of 0.8 means.",
        skip_start=True,
    )


def _chart(
    data: NullSpace, name: str, y: Axis, caption: str, *, events: tuple[Event, ...] = (), skip_start: bool = False
) -> Figure:
    curves = [curve for curve in data.curves if curve.figure == name]
    first = 1 if skip_start else 0  # the error is 0 there
    lines = [Line(label=curve.name, x=curve.t_s[first:], y=curve.values[first:]) for curve in curves]
    figure = plot_lines(lines, x=Axis(label="time", unit="s"), y=y, events=events)
    return Figure(image=to_svg(figure), alt=caption, caption=f"{caption} Ours; calibrated.")
