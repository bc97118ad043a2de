"""Table 5 and Figure 8: the published solutions graded again, and solutions of our own."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from itertools import count
from typing import Any

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.collision_model import CollisionModel
from ikde.model.convention import to_convention
from ikde.model.robot import Robot
from ikde.model.target import Target
from ikde.paper.columns import Shown, label, make_table, mark_off, ours, published
from ikde.paper.inputs import APPROXIMATIONS, Inputs, meant
from ikde.paper.plain_search import limit_base
from ikde.paper.section import Computed, Misprint, PrintedMeantOurs, PrintedOurs, Verdict, draw_robot, judge
from ikde.report.numbers import fixed
from ikde.report.page import Column, Figure, Gallery, Mark, Section, Table, Text
from ikde.solver.check import check
from ikde.solver.distinct import solve_distinct
from ikde.solver.forward import forward
from ikde.solver.joints import joints_outside, read_joints
from ikde.solver.result import SolveResult
from ikde.solver.settings import SolveSettings
from ikde.solver.solve import solve

SETTINGS = SolveSettings.for_method("de")
SEED, SOLUTIONS, BASE_M = 1, 3, 0.1
JOINTS = ("d_x", "d_y", "q_z", "q1", "q2", "q3", "q4", "q5", "q6")
DIGITS = 5e-5  # mm: half a unit of the printed errors' last digit


@dataclass(frozen=True, slots=True, kw_only=True)
class NamedVerdict(Verdict):
    """What a detector says of a solution."""

    colliding_components: list[str]


@dataclass(frozen=True, slots=True, kw_only=True)
class Solution:
    """A solution of a target, its errors and what both detectors say."""

    q: list[float]  # in the robot's own convention, m and rad
    error_mm: list[float]  # along each axis
    largest_error_mm: float
    detectors: dict[str, NamedVerdict]
    target: str
    row: str
    printed_q: list[float]  # as Table 5 prints its joints


@dataclass(frozen=True, slots=True, kw_only=True)
class Label(PrintedOurs[str]):
    """Which detectors a solution is free with."""

    agrees: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class PublishedSolution(Solution):
    """A row of Table 5, graded again."""

    ME_mm: PrintedMeantOurs[float]
    label: Label
    misprint: Misprint
    outside_limits: list[str]

    @property
    def shows_printed_error(self) -> bool:
        """To four digits."""
        return abs(self.ME_mm.printed - self.ME_mm.ours) < DIGITS


@dataclass(frozen=True, slots=True, kw_only=True)
class OwnSolution(Solution):
    """One of ours."""

    reached: bool
    detector: str
    stream: int
    attempts: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Solutions(Computed):
    """Published solutions and ours."""

    published: list[PublishedSolution]
    ours: list[OwnSolution]


def compute_solutions(inputs: Inputs) -> Solutions:
    """Table 5's rows, graded, and for each target free solutions and a colliding one of ours."""
    robot, targets = inputs.robot, inputs.published["targets_mm"]
    near = limit_base(robot, BASE_M)
    return Solutions(
        published=[_grade_row(robot, row, targets[row["target"]]) for row in inputs.published["table_5"]],
        ours=[row for name, target_mm in targets.items() for row in _solve_target(near, name, target_mm)],
        settings={
            "source": "[Qiao2021, Table 5]",
            "targets_mm": targets,
            "convention": "classical",
            "units": "d_x, d_y in mm, the rest in rad",
            "method": "de",
            "position_tolerance_mm": 1e3 * SETTINGS.position_tolerance_m,
            "base_range_mm": 1e3 * BASE_M,
            "seed": SEED,
            "free": "free with the typical detector (and so graded by the improved one as well)",
            "colliding": "searched with no detector: the first stream whose solution the typical detector rejects",
        },
    )


def read_row(robot: Robot, q: Sequence[float]) -> Floats:
    """Joints as Table 5 prints them [9], as q [9] in the robot's own convention, m and rad."""
    return read_joints(robot, [*np.array(q[:2]) / 1e3, *q[2:]], "classical")


def _grade_row(robot: Robot, row: Mapping[str, Any], target_mm: list[float]) -> PublishedSolution:
    q = read_row(robot, row["q"])
    graded = _grade(robot, q, target_mm)
    printed = "free with both" if row["row"].startswith("s") else "typical collides"
    typical, improved = (graded["detectors"][name].collides for name in APPROXIMATIONS)
    agrees = not (typical or improved) if printed == "free with both" else typical
    return PublishedSolution(
        target=row["target"],
        row=row["row"],
        printed_q=row["q"],
        ME_mm=PrintedMeantOurs(printed=row["ME_mm"], meant=meant(row)["ME_mm"], ours=graded["largest_error_mm"]),
        label=Label(printed=printed, ours=describe_verdict(typical, improved), agrees=agrees),
        misprint=row.get("misprint"),
        outside_limits=list(joints_outside(robot, q)),
        **graded,
    )


def _grade(robot: Robot, q: Floats, target_mm: list[float]) -> dict[str, Any]:
    """The first fields of a `Solution`."""
    errors = np.abs(1e3 * forward(robot, q)["tool"][:3, 3] - target_mm)
    return {
        "q": q.tolist(),
        "error_mm": errors.tolist(),
        "largest_error_mm": float(errors.max()),
        "detectors": {name: _judge(robot, q, name) for name in APPROXIMATIONS},
    }


def _judge(robot: Robot, q: Floats, detector: str) -> NamedVerdict:
    verdict = judge(robot, q, detector)
    components = sorted({name for pair in verdict.colliding_pairs for name in pair})
    return NamedVerdict(**asdict(verdict), colliding_components=components)


def describe_verdict(typical: bool, improved: bool) -> str:
    """What two verdicts say, in the words of Table 5's labels."""
    if typical == improved:
        return "both collide" if typical else "free with both"
    return "typical collides" if typical else "improved collides"


def _solve_target(robot: Robot, name: str, target_mm: list[float]) -> list[OwnSolution]:
    target = Target(np.array(target_mm) / 1e3)
    free = solve_distinct(robot, target, SOLUTIONS, SETTINGS, rank="found", seed=SEED, collision="typical")
    rows = {f"s{k}": result for k, result in enumerate(free, 1)} | {"f1": _find_colliding(robot, target)}
    return [_describe(robot, (name, row), target_mm, result) for row, result in rows.items()]


def _find_colliding(robot: Robot, target: Target) -> SolveResult:
    """The first stream of the plain search, blind to collisions, whose solution the typical detector rejects."""
    blind = (solve(robot, target, SETTINGS, seed=SEED, stream=stream, collision="none") for stream in count())
    return next(found for found in blind if found.reached and check(robot, found.q, "typical").collision)


def _describe(robot: Robot, place: tuple[str, str], target_mm: list[float], result: SolveResult) -> OwnSolution:
    """A result in its place: target and row."""
    q = to_convention(robot, result.q, "classical")
    return OwnSolution(
        target=place[0],
        row=place[1],
        printed_q=[*(1e3 * q[:2]).tolist(), *q[2:].tolist()],
        reached=result.reached,
        detector=result.detector,
        stream=result.stream,
        attempts=result.attempts,
        **_grade(robot, result.q, target_mm),
    )


def show_solutions(data: Solutions, inputs: Inputs) -> Section:
    """Every printed row with its error and verdicts, rows of our own, and free beside colliding ones drawn."""
    return Section(
        "Table 5 and Figure 8: solutions",
        (
            _introduce(data.published),
            _make_published(data.published),
            _make_ours(data),
            _make_joints(data.published, "Table 5: joint values as printed", "published"),
            _make_joints(data.ours, "Joint values of ours", "ours"),
            _draw(data, inputs.robot),
        ),
        anchor="table-5",
    )


def _introduce(rows: list[PublishedSolution]) -> Text:
    met, labels = sum(row.shows_printed_error for row in rows), sum(row.label.agrees for row in rows)
    return Text(
        f"ME is the largest error per axis. Of {len(rows)} printed rows, {met} show their ME to four digits, and "
        f"{labels} their label: s rows are free with both detectors, f rows collide with the typical one. What does "
        "not is marked ≠; the [misprints](#misprints) have the evidence."
    )


def _make_published(rows: list[PublishedSolution]) -> Table:
    return make_table(
        rows,
        label("target", lambda row: row.target),
        label("row", lambda row: row.row),
        published("printed", "mm", lambda row: mark_off(fixed(row.ME_mm.printed, 4), row.shows_printed_error), "ME"),
        ours("ours", "mm", lambda row: fixed(row.ME_mm.ours, 4), "ME"),
        ours("error in x, y, z", "mm", _errors),
        label("printed", lambda row: mark_off(row.label.printed, row.label.agrees), "label", "published"),
        label("ours", lambda row: row.label.ours, "label", "ours"),
        *map(_show_clearance, APPROXIMATIONS),
        caption="Table 5: the printed solutions, graded again",
        note=" ".join(_explain(row, row.misprint) for row in rows if row.misprint),
    )


def _explain(row: Solution, misprint: Mapping[str, Any]) -> str:
    """A misprint, and what was meant where that is known."""
    right = f": {fixed(misprint['ME_mm'], 4)} mm is meant" if "ME_mm" in misprint else ""
    return f"Target {row.target}, {row.row}: misprint “{misprint['see']}”{right}."


def _errors(row: Solution) -> str:
    return ", ".join(fixed(error, 4) for error in row.error_mm)


def _show_clearance(detector: str) -> Shown[Solution]:
    return ours(detector, "mm", lambda row: fixed(row.detectors[detector].clearance_mm, 2), "clearance")


def _make_ours(data: Solutions) -> Table:
    settings = data.settings
    return make_table(
        data.ours,
        label("target", lambda row: row.target),
        label("row", lambda row: row.row),
        ours("ME", "mm", lambda row: fixed(row.largest_error_mm, 4)),
        ours("error in x, y, z", "mm", _errors),
        *map(_show_clearance, APPROXIMATIONS),
        ours("attempts", "", lambda row: str(row.attempts)),
        ours("stream", "", lambda row: str(row.stream)),
        caption=f"Solutions of ours, method {settings['method']}, {settings['position_tolerance_mm']:g} mm, base "
        f"within ±{settings['base_range_mm']:g} mm, seed {settings['seed']}",
        note=f"s rows: {settings['free']}. f rows: {settings['colliding']}.",
    )


def _make_joints(rows: Sequence[Solution], caption: str, mark: Mark) -> Table:
    return make_table(
        rows,
        label("target", lambda row: row.target),
        label("row", lambda row: row.row),
        *(_show_joint(k, mark) for k in range(len(JOINTS))),
        caption=caption,
        note="Counted as in the classical model.",
    )


def _show_joint(k: int, mark: Mark) -> Shown[Solution]:
    column = Column(JOINTS[k], "mm" if k < 2 else "rad", mark=mark)
    return column, lambda row: fixed(row.printed_q[k], 4)


def _draw(data: Solutions, robot: Robot) -> Gallery:
    """Of each target one free and one colliding solution of ours, as both detectors see them."""
    shown = [row for row in data.ours if row.row in ("s1", "f1")]
    return Gallery(tuple(_draw_solution(data, robot, row, name) for row in shown for name in APPROXIMATIONS))


def _draw_solution(data: Solutions, robot: Robot, row: OwnSolution, detector: str) -> Figure:
    verdict = row.detectors[detector]
    state = f"collision of {', '.join(verdict.colliding_components)}" if verdict.collides else "free"
    caption = (
        f"Figure 8: target {row.target}, {row.row}, {detector}: {state}; clearance {fixed(verdict.clearance_mm, 1)} mm."
    )
    collision, target_mm = CollisionModel.of(robot, detector), data.settings["targets_mm"][row.target]
    return draw_robot(collision, row.q, caption=caption, target_mm=target_mm)
