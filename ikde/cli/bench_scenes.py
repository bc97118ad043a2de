"""`ikde bench scenes`: planning problems asked as inverse kinematics among their obstacles, as one page."""

import gc
import time
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ikde.cli import options
from ikde.cli.exit_codes import ExitCode
from ikde.cli.output import print_json, print_note, print_written
from ikde.cli.progress import show_benchmark
from ikde.cli.robot_choice import ToolOption, read_whole
from ikde.cli.world_options import MarginOption

if TYPE_CHECKING:
    from ikde.batch.scenes import Row
    from ikde.io.scene_pairs import ScenePair
    from ikde.report.scenes_page import ScenesRun

WRITE_SECONDS = 5.0  # between two states of the data on the disk


def bench_scenes(
    folder: Annotated[
        Path, typer.Argument(metavar="FOLDER", help="Where scene*.yaml and request*.yaml lie, at any depth.")
    ],
    robot: Annotated[str, typer.Option(metavar="NAME|FILE", help="The robot that the requests are for.")],
    out: Annotated[
        Path, typer.Option(metavar="FOLDER", help="Where report.html and results.json go; what is there is kept.")
    ] = Path("report"),
    tool: ToolOption = None,
    detector: options.DetectorOption = None,
    margin: MarginOption = None,
    unit: options.UnitOption = options.LengthUnit.m,
    first: Annotated[int | None, typer.Option(metavar="N", min=1, help="The first N of each family alone.")] = None,
    as_json: options.JsonOption = False,
) -> None:
    """Ask for the tool's pose at the goal of each planning problem, in its scene, with default settings.

    Of a robot with several tools for that which the goal moves, unless --tool says.

    Stop it, and the same command goes on. Exits with 1 if some problem was not solved.

    Example: ikde bench scenes problems/ --robot ur5.yaml --margin 0.002 --out report/scenes
    """
    from ikde.batch.scenes import Margins
    from ikde.formats.margins import read_margins
    from ikde.formats.units import LENGTHS_M
    from ikde.io.report_folder import prepare_folder
    from ikde.io.scene_pairs import find_pairs
    from ikde.model.collision_model import CollisionModel
    from ikde.model.world import NOTHING
    from ikde.report.scenes_page import ScenesRun, scenes_json

    gc.enable()
    own = CollisionModel.of(read_whole(robot, tool), detector)
    margins = Margins(*read_margins(margin, LENGTHS_M[unit]))
    own.in_world(NOTHING, margins.all_m, margins.of_m)  # what is wrong is found before anything runs
    pairs = {pair.name: pair for some in find_pairs(folder).values() for pair in some[:first]}
    given = {"robot": robot, "tool": tool, "detector": detector, "margin": margin, "first": first}
    given |= {} if margin is None else {"unit": str(unit)}
    command = options.repeat_command(["bench", "scenes", str(folder)], given)
    scenes = {name: (pair.family, pair.scene) for name, pair in pairs.items()}
    known = {"own": own, "has_tool": tool is not None, "margins": margins}
    run = ScenesRun(folder=folder, robot=robot, scenes=scenes, command=command, **known)
    prepare_folder(out)
    rows = _answer(run, pairs, out)
    files = _write(run, rows, out)
    if as_json:
        print_json(scenes_json(run, rows))
    print_written(*files, as_json=as_json)
    raise typer.Exit(ExitCode.OK if all(row["reached"] for row in rows.values()) else ExitCode.NOT_REACHED)


def _answer(run: "ScenesRun", pairs: "Mapping[str, ScenePair]", out: Path) -> "dict[str, Row]":
    """Rows by name, those that are in the folder already and the others; Ctrl-C keeps what there is."""
    from ikde.batch.scenes import run_scenes
    from ikde.solver.background import WAIT, compile_way
    from ikde.solver.compile_note import name_work, note_compile

    known = _read_known(run, out)
    digests = [(name, pair.digest) for name, pair in pairs.items()]
    left = [name for name, digest in digests if known.get(name, {}).get("digest") != digest]
    if len(left) < len(pairs):
        print_note(f"ikde: {len(pairs) - len(left)} of {len(pairs)} problems are answered in {out} already")
    keeping = _Keeping(run, out)
    try:
        note = note_compile(lambda: name_work("poses", run.own))
        with show_benchmark(len(left)) as bar, compile_way(WAIT), note:
            for name in left[:1]:  # compiles and loads before anything is timed
                _ask(run, pairs[name])
            return run_scenes(digests, known, partial(_ask_next, run, pairs, bar, set[str]()), keeping)
    except KeyboardInterrupt:
        keeping.write()
        raise typer.Abort(f"ikde: interrupted; what is answered stands in {out}; the same command goes on") from None


def _read_known(run: "ScenesRun", out: Path) -> "dict[str, Row]":
    """Rows of an earlier run of the same question in the folder."""
    from ikde.batch.scenes import read_known
    from ikde.errors import FileError
    from ikde.formats.reading import read_json
    from ikde.io.report_folder import RESULTS

    try:
        return read_known(read_json(out / RESULTS), run.asked)
    except FileError:
        return {}


def _write(run: "ScenesRun", rows: "Mapping[str, Row]", out: Path) -> tuple[Path, ...]:
    from ikde.io.report_folder import RESULTS, format_results, write_report
    from ikde.report.html import render_html
    from ikde.report.scenes_page import make_scenes_page, scenes_json

    page = render_html(make_scenes_page(run, rows))
    return write_report(out, {RESULTS: format_results(scenes_json(run, rows)), "report.html": page})


def _ask_next(run: "ScenesRun", pairs: "Mapping[str, ScenePair]", bar: Any, begun: set[str], name: str) -> "Row":
    family = pairs[name].family
    if family not in begun:
        begun.add(family)
        bar.begin(family)
    row = _ask(run, pairs[name])
    bar.advance(1)
    return row


def _ask(run: "ScenesRun", pair: "ScenePair") -> "Row":
    """One problem; a row that says so where it cannot be asked."""
    from ikde.batch.scenes import ask, make_pose_question, make_question, refuse
    from ikde.errors import InputError
    from ikde.io.scene_pairs import read_request, read_scene_state
    from ikde.io.world_file import read_world

    robot = run.own.robot
    try:
        request = read_request(pair.request)
        start = dict(request.start)
        if not start.keys() | request.goal.keys() >= set(robot.joint_names):  # of others the scene may tell
            start = {**read_scene_state(pair.scene), **start}
        if request.pose is not None:
            question = make_pose_question(robot, start, request.pose)
        else:
            question = make_question(robot, start, request.goal, has_tool=run.has_tool)
        found = read_world(pair.scene)
        with found.errors():
            world = replace(found.world, attached=(*found.world.attached, *request.attached))
            return ask(question, run.own, world, run.margins)
    except InputError as error:
        return refuse(error)


class _Keeping:
    """Writes what is answered so far, now and then; whole files or none."""

    def __init__(self, run: "ScenesRun", out: Path) -> None:
        self._run, self._out, self._rows, self._last = run, out, {}, time.monotonic()

    def __call__(self, rows: "Mapping[str, Row]") -> None:
        self._rows = rows
        if time.monotonic() - self._last > WRITE_SECONDS:
            self.write()

    def write(self) -> None:
        """What there is, if there is any."""
        from ikde.io.report_folder import RESULTS, format_results, write_report
        from ikde.report.scenes_page import scenes_json

        if self._rows:
            write_report(self._out, {RESULTS: format_results(scenes_json(self._run, self._rows))})
        self._last = time.monotonic()
