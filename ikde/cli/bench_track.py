"""`ikde bench track`: ways to follow the same tool paths side by side, as one page."""

import gc
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ikde.cli.options import JsonOption, LengthUnit, note_unchecked, read_choices, repeat_command
from ikde.cli.output import print_json, print_written
from ikde.cli.progress import show_benchmark
from ikde.cli.world_options import MarginOption, WorldOption, place_in_world

if TYPE_CHECKING:
    from ikde.track.plan import TrackPlan
    from ikde.track.spec import TrackMethod


def bench_track(
    tracks: Annotated[
        list[Path], typer.Argument(metavar="FILE...", help="Track files, such as configs/tracks/*.yaml.")
    ],
    out: Annotated[Path, typer.Option(metavar="FOLDER", help="Where report.html and results.json go.")] = Path(
        "report"
    ),
    methods: Annotated[
        str | None, typer.Option(metavar="METHOD,...", help="Compare these alone (default: all three).")
    ] = None,
    drive: Annotated[
        str | None, typer.Option(help="differential, omnidirectional or mecanum, instead of what the files say.")
    ] = None,
    world: WorldOption = None,
    margin: MarginOption = None,
    unit: Annotated[LengthUnit, typer.Option("--unit", help="Unit of lengths in --margin.")] = LengthUnit.m,
    quick: Annotated[bool, typer.Option("--quick", help="2 seeds and 5 starts instead of 10 and 100.")] = False,
    as_json: JsonOption = False,
) -> None:
    """Follow tool paths by the paper's methods and ikde's, and show them beside one another, perhaps in a world.

    `typical` goes on whatever it hits, `optimized` is free at samples: what each breaks is counted.

    Example: ikde bench track configs/tracks/qiao2022_task?.yaml --out report/tracks
    """
    from ikde.io.plan_file import in_track_file, load_track
    from ikde.io.report_folder import RESULTS, format_results, open_folder, write_report
    from ikde.report.html import render_html
    from ikde.report.track_comparison import compare_json, make_comparison_page
    from ikde.solver.compile_note import name_work, note_compile
    from ikde.track.comparison import FULL, METHODS, QUICK, compare_methods, count_runs

    gc.enable()
    wanted, budget = read_choices(methods, METHODS, "--methods"), QUICK if quick else FULL
    chosen: list[TrackMethod] = [method for method in METHODS if method in wanted]
    in_metres = unit if unit != LengthUnit.m else None
    given = {"methods": methods, "drive": drive, "world": world, "margin": margin, "unit": in_metres}
    plans = [load_track(path).with_changes(drive=drive) for path in tracks]  # type: ignore[arg-type]
    for place, plan in enumerate(plans):
        placed = place_in_world(plan.collision, world, margin, unit)
        with in_track_file(plan):
            named = plan.world_file if world is None else str(world)
            plans[place] = replace(plan, collision=placed, world_file=named)
    _check_moving(plans, chosen)
    for robot in {plan.robot.name: plan.robot for plan in plans if not plan.collision.pairs}.values():
        note_unchecked(robot)
    with open_folder(out), show_benchmark(count_runs(len(plans), chosen, budget)) as progress:
        with note_compile(lambda: name_work("tracks", *(plan.collision for plan in plans)), "a minute or two"):
            compared = [compare_methods(plan, chosen, budget, progress) for plan in plans]
        progress.begin("page")
        page = make_comparison_page(
            compared, budget, repeat_command(["bench", "track", *map(str, tracks)], {**given, "quick": quick or None})
        )
        data = compare_json(compared, budget)
        files = write_report(out, {RESULTS: format_results(data), "report.html": render_html(page)})
    if as_json:
        print_json(data)
    print_written(*files, as_json=as_json)


def _check_moving(plans: "list[TrackPlan]", methods: "list[TrackMethod]") -> None:
    """Raise `InputError`, before anything is computed, for obstacles that move and a method that does not know them."""
    from ikde.errors import InputError

    for plan in plans:
        if plan.moving and methods != ["continuation"]:
            message = f"obstacles move in {plan.name}, which continuation alone knows: --methods continuation"
            raise InputError(message, ("--methods",))
