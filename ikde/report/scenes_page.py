"""Planning problems asked as inverse kinematics, as a page: solved, times, blockers, and the hardest drawn."""

import shlex
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from ikde.batch.machine import describe_machine, describe_versions
from ikde.batch.recipe import ikde_version, robot_digest
from ikde.batch.scenes import REFUSED, FamilySummary, Margins, Row, summarise_rows, use_tool
from ikde.errors import InputError
from ikde.io.world_file import load_world
from ikde.model.collision_model import CollisionModel
from ikde.model.rotation import quat_wxyz_from_rotation
from ikde.model.target import Target
from ikde.plot.charts import Sample, plot_cdf
from ikde.plot.images import to_png, to_svg
from ikde.plot.pose import plot_pose
from ikde.plot.style import Axis
from ikde.report.markup import code, verbatim
from ikde.report.numbers import count_of, fixed, length, seconds, significant
from ikde.report.page import Block, Code, Column, Details, Facts, Figure, Gallery, Number, Numbers, Page, Section, Table
from ikde.scene.drawn_pose import draw_pose

DRAWN, DRAWN_UNSOLVED = 6, 4  # pictures, and how many of them of problems without an answer
MAX_MISSED = 50  # problems that are listed with a reason
MAX_BLOCKERS = 20
DPI = 90


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ScenesRun:
    """What was asked."""

    folder: Path
    own: CollisionModel
    """The robot, in no world."""
    robot: str
    """As it was named."""
    has_tool: bool
    """Whether its tool was chosen, and not one of several by each goal."""
    margins: Margins
    scenes: Mapping[str, tuple[str, Path]]
    """Family and scene file by the problem's name."""
    command: str
    """What makes the page again."""

    @property
    def asked(self) -> dict[str, Any]:
        """All that answers depend on beside the problems' own files, as plain data."""
        robot, margins = self.own.robot, asdict(self.margins)
        return {
            "ikde": ikde_version(),
            "robot": {"name": robot.name, "tool": robot.tool, "digest": robot_digest(robot)},
            "has_tool": self.has_tool,
            "detector": self.own.name,
            **margins,
        }


def scenes_json(run: ScenesRun, rows: Mapping[str, Row]) -> dict[str, Any]:
    """The run as plain data, also one that is not finished; lengths in m, times in s but for summaries."""
    families = _group(run, rows)
    return {
        "asked": run.asked,
        "finished": len(rows) == len(run.scenes),
        "all": asdict(summarise_rows("all", list(rows.values()))),
        "families": [asdict(summarise_rows(name, some)) for name, some in families.items()],
        "problems": dict(rows),
        "machine": describe_machine(),
        "versions": describe_versions(),
    }


def _group(run: ScenesRun, rows: Mapping[str, Row]) -> dict[str, list[Row]]:
    families: dict[str, list[Row]] = {}
    for name, row in rows.items():
        families.setdefault(run.scenes[name][0], []).append(row)
    return families


def make_scenes_page(run: ScenesRun, rows: Mapping[str, Row]) -> Page:
    """The page of a finished run."""
    families = [summarise_rows(name, some) for name, some in _group(run, rows).items()]
    everything = summarise_rows("all", list(rows.values()))
    sections = [
        Section("By family", (_make_table(families, everything), *_draw_times(rows)), anchor="families"),
        _make_blockers(rows, everything),
        _make_hardest(run, rows),
        _make_missed(rows),
        _make_record(run, rows),
    ]
    return Page(
        title=f"Scenes of {run.folder.resolve().name}",
        subtitle=f"{count_of(len(rows), 'planning problem')} asked as inverse kinematics: robot {run.own.robot.name}, "
        f"the pose of {_list_tools(run, rows)} at each goal, {_tell_margins(run.margins)}, default settings.",
        lead=(Numbers(tuple(_list_numbers(everything))),),
        sections=tuple(section for section in sections if section),
        footer=f"Made by ikde {verbatim(ikde_version())} from the problems in {code(str(run.folder))}.",
    )


def _list_tools(run: ScenesRun, rows: Mapping[str, Row]) -> str:
    """The tools that were asked for."""
    return " or ".join(sorted({row["tool"] for row in rows.values() if "tool" in row})) or run.own.robot.tool


def _tell_margins(margins: Margins) -> str:
    own = "".join(f", {length(margin_m)} by {name}" for name, margin_m in margins.of_m.items())
    if not margins.all_m and not own:
        return "no margin to the world"
    return f"{length(margins.all_m)} kept from the world{own}"


def _list_numbers(everything: FamilySummary) -> list[Number]:
    missed = everything.problems - everything.reached
    proved = f", {everything.proved:,} proved to have no answer" if everything.proved else ""
    numbers = [Number(f"{everything.reached:,} of {everything.problems:,}", "solved", f"{missed:,} not{proved}")]
    if everything.again_ms and everything.new_ms:
        median, p99, most = (seconds(value * 1e-3) for value in everything.again_ms)
        numbers.append(Number(median, "a call, median", f"99 % within {p99}, at most {most}"))
        median, p99, most = (seconds(value * 1e-3) for value in everything.new_ms)
        numbers.append(Number(median, "first call in a scene", f"99 % within {p99}, at most {most}"))
    if everything.least_clearance_m is not None:
        numbers.append(Number(length(everything.least_clearance_m), "smallest clearance", "of all answers"))
    return numbers


def _make_table(families: Sequence[FamilySummary], everything: FamilySummary) -> Table:
    rows = [*families, *([everything] if len(families) > 1 else [])]
    any_missed = everything.reached < everything.problems
    return Table(
        columns=(
            *Column.of("family", ">problems", ">solved"),
            *(Column.of(">proved unsolvable") if any_missed else ()),
            *(Column(name, "ms", group="a call") for name in ("median", "p99", "max")),
            *(Column(name, "ms", group="first in a scene") for name in ("median", "p99", "max")),
            *Column.of(">least clearance [mm]"),
            *(Column.of("blocked most by") if any_missed else ()),
        ),
        rows=tuple(
            (
                row.name,
                f"{row.problems:,}",
                f"{row.reached:,}",
                *((f"{row.proved:,}",) if any_missed else ()),
                *map(_format_ms, row.again_ms or (None,) * 3),
                *map(_format_ms, row.new_ms or (None,) * 3),
                "" if row.least_clearance_m is None else fixed(1e3 * row.least_clearance_m, 2),
                *((next(iter(row.blockers), ""),) if any_missed else ()),
            )
            for row in rows
        ),
        caption="Solved, and the time that it took",
        note="Solved: the pose is met, inside the limits, free of the robot itself and of the scene, in the eyes of "
        "plain numpy, too. A call is one of `ikde.solve`; the first in a scene places the robot in it, too. Times are "
        "to the answer, or to the reason why there is none.",
    )


def _format_ms(value: float | None) -> str:
    return "" if value is None else significant(value)


def _draw_times(rows: Mapping[str, Row]) -> list[Block]:
    times = {
        "a call": [1e3 * row["again_s"] for row in rows.values() if "again_s" in row],
        "first in a scene": [1e3 * row["new_s"] for row in rows.values() if "new_s" in row],
    }
    if not times["a call"]:
        return []
    samples = [Sample(label=label, values=np.array(values)) for label, values in times.items()]
    picture = to_svg(plot_cdf(samples, x=Axis(label="time", unit="ms", log=True), y="problems"))
    return [Figure(image=picture, alt="How many problems were answered in a time", caption="Answered within a time.")]


def _make_blockers(rows: Mapping[str, Row], everything: FamilySummary) -> Section | None:
    """What stood in the way where there was no answer: most often, and at all."""
    missed = [row for row in rows.values() if not row["reached"]]
    if not everything.blockers:
        return None
    at_all = Counter(name for row in missed for name in row["blockers"])
    shown = sorted(at_all, key=lambda name: (-everything.blockers.get(name, 0), -at_all[name]))[:MAX_BLOCKERS]
    table = Table(
        columns=Column.of("blocked by", ">most often", ">at all"),
        rows=tuple((name, f"{everything.blockers.get(name, 0):,}", f"{at_all[name]:,}") for name in shown),
        caption=f"What stood in the way, of {count_of(len(missed), 'problem')} without an answer",
        note="An obstacle, or two components of the robot.",
    )
    return Section("What stood in the way", (table,), anchor="blockers")


def _make_hardest(run: ScenesRun, rows: Mapping[str, Row]) -> Section | None:
    asked = {name: row for name, row in rows.items() if row["stop_reason"] != REFUSED}
    missed = [name for name, row in asked.items() if not row["reached"]]
    slowest = sorted((name for name in asked if name not in missed), key=lambda name: -asked[name]["again_s"])
    chosen = _spread(run, missed, DRAWN_UNSOLVED)
    chosen += slowest[: DRAWN - len(chosen)]
    if not chosen:
        return None
    pictures = tuple(filter(None, (_draw(run, name, asked[name]) for name in chosen)))
    details = [_make_details(run, name, asked[name]) for name in chosen]
    return Section("The hardest", (*([Gallery(pictures)] if pictures else []), *details), anchor="hardest")


def _spread(run: ScenesRun, names: Sequence[str], count: int) -> list[str]:
    """So many of them, of as many families as there are."""
    first: dict[str, str] = {}
    for name in names:
        first.setdefault(run.scenes[name][0], name)
    others = [name for name in names if name not in first.values()]
    return [*first.values(), *others][:count]


def _say(row: Row) -> str:
    if row["reached"]:
        return f"took {seconds(row['again_s'])}"
    return f"not solved, {row['stop_reason'].replace('_', ' ')}{', proved' if row['proved'] else ''}"


def _make_details(run: ScenesRun, name: str, row: Row) -> Block:
    facts = [("why", row["reason"]), ("what would help", row["hint"])]
    if row["reached"] and row["clearance_m"] is not None:
        facts.append(("closest", f"{' – '.join(row['closest_pair'] or ())}: {length(row['clearance_m'])}"))
    facts.append(("time", f"{seconds(row['new_s'])} the first time, {seconds(row['again_s'])} again"))
    shown = Facts(tuple((key, verbatim(value)) for key, value in facts if value))
    command = Code(_solve_command(run, name, row), caption="This problem alone, with a picture")
    return Details(f"{name}: {_say(row)}", (shown, command))


def _draw(run: ScenesRun, name: str, row: Row) -> Figure | None:
    """The answer, or the best there is, in its scene; nothing if that cannot be read any more."""
    try:
        own = use_tool(run.own, row["tool"])
        model = own.in_world(load_world(run.scenes[name][1]), run.margins.all_m, run.margins.of_m)
    except InputError:
        return None
    T = np.array(row["T_world_tool"])
    pose = draw_pose(model, np.array(row["q"]), target=Target(T[:, 3], R_world_tool=T[:, :3]))
    picture = to_png(plot_pose(replace(pose, title="")), dpi=DPI)
    missed = ": the best that was found. What is too near is purple, what of the robot touches is black (white on a "
    missed += "dark page)."
    caption = f"{verbatim(name)}, {_say(row)}{'' if row['reached'] else missed}"
    return Figure(image=picture, alt=f"the robot in {name}", caption=caption)


def _solve_command(run: ScenesRun, name: str, row: Row) -> str:
    """`ikde solve` of one problem, alone."""
    T, robot = np.array(row["T_world_tool"]), run.own.robot
    words = ["ikde", "solve", "--robot", run.robot, "--world", str(run.scenes[name][1])]
    margins = [*([repr(run.margins.all_m)] if run.margins.all_m else [])]
    margins += [f"{component}={margin_m!r}" for component, margin_m in run.margins.of_m.items()]
    words += ["--margin", ",".join(margins)] if margins else []
    words += ["--tool", row["tool"]] if robot.tools or row["tool"] != robot.tool else []
    words += ["--position", *map(repr, T[:, 3].tolist())]
    words += ["--quat-wxyz", *map(repr, quat_wxyz_from_rotation(T[:, :3]).tolist())]
    held = ",".join(f"{joint}={value!r}" for joint, value in row["held"].items())
    return shlex.join([*words, *(["--freeze", held] if held else []), "--plot", "answer.png"])


def _make_missed(rows: Mapping[str, Row]) -> Section | None:
    missed = [(name, row) for name, row in rows.items() if not row["reached"]]
    if not missed:
        return None
    which = "Problems" if len(missed) <= MAX_MISSED else f"The first {MAX_MISSED} of {len(missed):,} problems"
    table = Table(
        columns=Column.of("problem", "why", "what would help"),
        rows=tuple((name, row["reason"] or "", row.get("hint") or "") for name, row in missed[:MAX_MISSED]),
        caption=f"{which} without an answer",
    )
    return Section("Not solved", (table,), anchor="not-solved")


def _make_record(run: ScenesRun, rows: Mapping[str, Row]) -> Section:
    machine, asked = describe_machine(), run.asked
    facts = (
        ("robot", f"{run.own.robot.name}, tool {_list_tools(run, rows)}, detector {run.own.name}"),
        ("robot's digest", asked["robot"]["digest"]),
        ("margins", _tell_margins(run.margins)),
        ("machine", f"{machine['processor']}, {machine['cores']} cores, {machine['system']}; one thread"),
        ("versions", ", ".join(f"{name} {version}" for name, version in describe_versions().items())),
    )
    again = Code(run.command, caption="To make this page again; answers that are in FOLDER already are kept")
    return Section("What ran", (Facts(tuple((k, verbatim(v)) for k, v in facts)), again), anchor="record")
