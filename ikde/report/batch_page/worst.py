"""The rows that are worth a look: the least clear, the farthest off, those that took most, and one for each reason."""

import json
import shlex
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from ikde.batch.one_row import Row, read_row
from ikde.batch.recipe import as_plain, robot_digest
from ikde.io.robots import load_robot, robot_names
from ikde.model.collision_model import CollisionModel
from ikde.model.robot import Robot
from ikde.plot.animation import make_animation
from ikde.report.batch_page.answers import PLACE, ArmAnswers, RunAnswers
from ikde.report.batch_page.in_world import check_command, draw_in_world, find_file, place_arm
from ikde.report.batch_page.recipe import run_command
from ikde.report.markup import code, verbatim
from ikde.report.numbers import angle, length
from ikde.report.page import Animation, Block, Code, Details, Facts, Section, Text
from ikde.scene.drawn_motion import draw_still

MAX_REASONS = 4
MAX_DRAWN = 1e3  # m or rad: what is beyond is no configuration of a robot that ships with ikde


@dataclass(frozen=True, slots=True)
class Worst:
    """A row, and what is worst about it."""

    row: Row
    what: str


def make_worst(run: RunAnswers) -> Section | None:
    """Each of these rows with its numbers, its picture if the robot is known, and the command that repeats it."""
    shown = list(_choose(run))
    if not shown:
        return None
    lead = "Each can be opened: its numbers, and the command that solves it again, alone, and finds the same bits."
    robot = _find_robot(run)
    return Section("Worst rows", (Text(lead), *(_make_details(run, worst, robot) for worst in shown)), anchor="worst")


def _choose(run: RunAnswers) -> Iterator[Worst]:
    """No row twice."""
    seen: set[Row] = set()
    for worst in (*_list_extremes(run), *_list_missed(run)):
        if worst.row not in seen:
            seen.add(worst.row)
            yield worst


def _list_extremes(run: RunAnswers) -> Iterator[Worst]:
    for column, sign, what, write in (
        ("clearance_m", -1.0, "least clearance", length),
        ("position_error_m", 1.0, "largest position error", length),
        ("orientation_error_rad", 1.0, "largest orientation error", angle),
        ("evaluations", 1.0, "most evaluations", lambda value: f"{value:,.0f}"),
    ):
        ends = [(end, arm) for arm in run.arms if (end := _find_end(arm, column, sign)) is not None]
        if not ends:
            continue
        (value, index), arm = max(ends, key=lambda end: sign * end[0][0])
        if value != 0.0 or column == "clearance_m":  # a free orientation has no error
            yield Worst(_row(arm, index), f"{what}, {write(value)}")


def _find_end(arm: ArmAnswers, column: str, sign: float) -> tuple[float, int] | None:
    """The extreme value of a column where the target was reached, and its place."""
    if column not in arm.numbers:
        return None
    values = np.where(arm.reached, sign * arm.numbers[column].astype(float), -np.inf)
    values[np.isnan(values)] = -np.inf
    if not len(values) or not np.isfinite(values.max()):
        return None
    index = int(np.argmax(values))
    return float(arm.numbers[column][index]), index


def _row(arm: ArmAnswers, index: int) -> Row:
    return Row(arm.name, int(arm.numbers["target"][index]), int(arm.numbers["repeat"][index]))


def _list_missed(run: RunAnswers) -> Iterator[Worst]:
    """The first row that was missed for each reason."""
    found: dict[str, Worst] = {}
    for arm in run.arms:
        for row in arm.missed.values():
            why = row["stop_reason"].replace("_", " ")
            found.setdefault(why, Worst(Row(arm.name, row["target"], row["repeat"]), f"not reached: {why}"))
    yield from list(found.values())[:MAX_REASONS]


def _make_details(run: RunAnswers, worst: Worst, robot: Robot | None) -> Details:
    row = worst.row
    data = read_row(run.folder, run.manifest, row) or {}
    name = f" ({run.names[row.target]})" if run.names.get(row.target) else ""
    repeat = f", repeat {row.repeat}" if run.manifest.repeats > 1 else ""
    arm = f", arm {row.arm}" if len(run.arms) > 1 else ""
    blocks: list[Block] = [Facts(tuple(_list_facts(data)))]
    if run.manifest.file:
        blocks.append(Code(repeat_command(run, row), caption="This row alone, and whether the run holds the same bits"))
    blocks += [] if robot is None else _show(run, row, data, robot)
    return Details(f"{worst.what}: target {row.target}{name}{repeat}{arm}", tuple(blocks))


def repeat_command(run: RunAnswers, row: Row) -> str:
    """What solves a row again and compares it with the run's."""
    return f"{run_command(run)} --row {shlex.quote(str(row))}"


def _list_facts(data: dict[str, Any]) -> Iterator[tuple[str, str]]:
    for column, name, write in (
        ("reason", "why", verbatim),
        ("hint", "what would help", verbatim),
        ("position_error_m", "position error", length),
        ("orientation_error_rad", "orientation error", angle),
        ("clearance_m", "clearance", length),
        ("attempts", "attempts", "{:,}".format),
        ("evaluations", "evaluations", "{:,}".format),
        ("poses", "poses of the goal tried", "{:,}".format),
        ("alternative", "alternative of the goal, from 0", str),
    ):
        if data.get(column) is not None:
            yield name, write(data[column])
    if data.get("world") is not None:
        yield "world", verbatim(data["world"])
    if data.get("pair_a") is not None:
        yield "closest pair", verbatim(f"{data['pair_a']} – {data['pair_b']}")
    place = [data[f"target_{axis}_m"] for axis in "xyz"] if "target_x_m" in data else []
    if place:
        yield "target [m]", code(", ".join(f"{value:.6g}" for value in place))
    values = {name.removeprefix("q_"): value for name, value in data.items() if name.startswith("q_")}
    if values:
        yield "joint values [m, rad]", code(" ".join(f"{name}={value!r}" for name, value in values.items()))


def _find_robot(run: RunAnswers) -> Robot | None:
    """The run's robot, if it is one that ships with ikde and has not changed since."""
    known = run.manifest.recipe.get("robot")
    if not isinstance(known, dict) or run.manifest.robot not in robot_names():
        return None
    robot = load_robot(run.manifest.robot)
    return robot if known.get("digest") == robot_digest(robot) else None


def _show(run: RunAnswers, row: Row, data: dict[str, Any], robot: Robot) -> list[Block]:
    """The robot in the row's configuration; nothing if the run does not keep it, or has spheres of its own."""
    collision = _find_collision(run, row.arm, robot)
    q = np.array([data.get(f"q_{name}", np.nan) for name in robot.joint_names], dtype=float)
    if collision is None or not (np.abs(q) < MAX_DRAWN).all():
        return []
    target = [data[name] for name in PLACE] if all(name in data for name in PLACE) else []
    placed, alt = place_arm(run, row.arm, collision), f"the robot in row {row}"
    if placed is None:
        return [Text("There is no picture of it: its world is no file any more, or another one than the run's.")]
    if placed.obstacles:
        file = find_file(run, row.arm)
        command = [] if file is None else [check_command(placed, file, robot.name, q)]
        again = [Code(text, caption="What is near this configuration, and a picture of it") for text in command]
        return [*again, draw_in_world(placed, q, target, alt)]
    still = json.dumps(make_animation(draw_still(collision, q, target)), separators=(",", ":"), allow_nan=False)
    caption = "Its configuration, and the target as a ring." if target else "Its configuration."
    caption += " What collides is black, white on a dark page." if collision.pairs else ""
    return [Animation(data=still, alt=alt, caption=caption)]


def _find_collision(run: RunAnswers, arm: str, robot: Robot) -> CollisionModel | None:
    """What an arm compared, if it is what the robot's file says."""
    facts = run.manifest.recipe.get("arms", {}).get(arm, {})
    detector = next((known for known in robot.detectors.values() if as_plain(known) == facts.get("detector")), None)
    known = detector is not None or facts.get("detector", "") is None
    return CollisionModel(robot=robot, detector=detector) if known else None
