"""`ikde track`: follow a path of the tool with the whole robot, into a folder that a robot could run from."""

import gc
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ikde.cli.exit_codes import ExitCode
from ikde.cli.options import AngleUnit, JsonOption, LengthUnit, note_unchecked, read_q, repeat_command
from ikde.cli.output import Working, layout, print_json, print_result, print_written, working
from ikde.cli.world_options import AttachOption, MarginOption, Pick, WorldOption, note_held, place_in_world

if TYPE_CHECKING:
    from ikde.track.plan import TrackPlan
    from ikde.track.summary import TrackSummary

instead = partial(typer.Option, rich_help_panel="Instead of what the file says")


def track(
    spec: Annotated[
        Path, typer.Argument(metavar="FILE", help="What to follow: see configs/tracks/ and `ikde schema track`.")
    ],
    out: Annotated[
        Path | None, typer.Option(metavar="FOLDER", help="Where the motion, its figures and its page go.")
    ] = None,
    method: Annotated[
        str | None, instead(help="continuation (ikde's own), optimized or typical (the paper's).")
    ] = None,
    drive: Annotated[str | None, instead(help="differential, omnidirectional or mecanum.")] = None,
    seed: Annotated[int | None, instead(help="Same seed, same motion.")] = None,
    start: Annotated[
        str | None, instead(metavar="Q", help="Configuration at the first pose (as --q of check).")
    ] = None,
    world: WorldOption = None,
    margin: MarginOption = None,
    attach: AttachOption = None,
    unit: Annotated[LengthUnit, instead("--unit", help="Unit of lengths in --start and --margin.")] = LengthUnit.m,
    angles: Annotated[AngleUnit, instead("--angles", help="Unit of angles in --start.")] = AngleUnit.rad,
    convention: Annotated[
        str | None, instead(help="Convention of joint values in --start (default: the robot's own).")
    ] = None,
    plot: Annotated[bool, typer.Option("--plot/--no-plot", help="Make the page with figures: report.html.")] = True,
    as_json: JsonOption = False,
) -> None:
    """Follow a tool path inside all limits, free of self-collision and of a world at the samples and between them.

    If it cannot be followed it says at which sample and what is in the way, writes what was followed, and exits with 1.
    Lengths are printed in mm and ranges in deg; files and --json are in m, rad and s.

    Example: ikde track configs/tracks/qiao2022_task1.yaml --out runs/task1
    """
    from ikde.io.plan_file import in_track_file, load_track
    from ikde.io.report_folder import open_folder
    from ikde.io.trajectory_files import write_track
    from ikde.report.track import format_track, track_json

    gc.enable()
    plan = load_track(spec)
    begin = None if start is None else read_q(plan.robot, start, unit, angles, convention, "start")
    picked = Pick(attach, plan.start if begin is None else begin)
    placed = place_in_world(plan.collision, world, margin, unit, picked)
    if attach is None and world is None:
        note_held(placed, Pick(q=plan.start))
    with in_track_file(plan):
        plan = replace(plan, collision=placed, world_file=plan.world_file if world is None else str(world))
        plan = plan.with_changes(method=method, drive=drive, seed=seed, start=begin)  # type: ignore[arg-type]
    given = {
        "method": method,
        "drive": drive,
        "seed": seed,
        "start": start,
        "world": world,
        "margin": margin,
        "attach": attach,
    }
    units = {"unit": unit if unit != LengthUnit.m else None, "angles": angles if angles != AngleUnit.rad else None}
    command = repeat_command(["track", str(spec)], {**given, **units, "convention": convention})
    with open_folder(out) if out else nullcontext():
        if not plan.collision.pairs:
            note_unchecked(plan.robot)
        with _show_steps() as tell:
            tell(f"following {plan.name}")
            motion = _follow(plan)
            page = _draw(motion, plan.name, command, tell) if out and plot else None
        data = track_json(plan, motion)
        files = write_track(out, motion.trajectory, data, page) if out else ()
    if as_json:
        print_json({**data, "files": [str(file) for file in files]})
    else:
        print_result(format_track(plan, motion, **layout(120)))
    print_written(*files, as_json=as_json)
    raise typer.Exit(ExitCode.OK if data["reached"] else ExitCode.NOT_REACHED)


def _follow(plan: "TrackPlan") -> "TrackSummary":
    from ikde.track.run import run_track
    from ikde.track.summary import summarise_track

    return summarise_track(plan.collision, run_track(plan))


def _draw(motion: "TrackSummary", title: str, command: str, tell: Callable[[str], None]) -> str:
    from ikde.report.html import render_html
    from ikde.report.track_page import make_track_page

    tell("drawing")
    return render_html(make_track_page(motion, title, command))


@contextmanager
def _show_steps() -> Iterator[Callable[[str], None]]:
    """What is being done, on stderr, in a terminal."""
    with working("") as status:
        yield (lambda text: None) if status is None else lambda text: status.update(Working(f"{text} ..."))
