"""`ikde bench`; and `ikde bench paper`: the papers' tables and figures, published beside ours, as one page."""

import gc
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from ikde.cli.bench_scenes import bench_scenes
from ikde.cli.bench_track import bench_track
from ikde.cli.exit_codes import ExitCode
from ikde.cli.options import Command, Group, JsonOption, read_choices
from ikde.cli.output import print_json, print_line, print_written
from ikde.cli.progress import show_benchmark

TAKES = "about a minute"  # compiling all kernels

bench = typer.Typer(cls=Group, help="Benchmarks that compare with published results.", no_args_is_help=True)


@bench.callback()
def default() -> None:
    """Benchmarks that compare with published results."""


bench.command("track", cls=Command)(bench_track)
bench.command("scenes", cls=Command)(bench_scenes)


@bench.command("paper", cls=Command)
def paper(
    out: Annotated[
        Path, typer.Option(metavar="FOLDER", help="Where report.html, report.md and results.json go.")
    ] = Path("report"),
    quick: Annotated[bool, typer.Option("--quick", help="Small samples: seconds instead of minutes.")] = False,
    only: Annotated[str | None, typer.Option(metavar="SECTION,...", help="Compute these sections alone.")] = None,
    check: Annotated[
        bool, typer.Option("--check", help="Compute what is exact again, compare it with results.json; write nothing.")
    ] = False,
    as_json: JsonOption = False,
) -> None:
    """Compute the tables and figures of Qiao et al. 2021, and of Dong and Zhao, and show them beside the print.

    Exits with 1 if --check finds a difference.

    Example: ikde bench paper --out report/
    """
    from ikde.io.report_folder import prepare_folder
    from ikde.paper.results import TOPICS

    gc.enable()
    if check and (quick or only):
        raise typer.BadParameter("results.json says what is in it; leave --quick and --only out", param_hint="--check")
    sections = read_choices(only, tuple(TOPICS), "--only")
    if check:
        raise typer.Exit(_check(out, as_json))
    prepare_folder(out)
    _make(out, quick, sections, as_json)


def _make(out: Path, quick: bool, sections: tuple[str, ...], as_json: bool) -> None:
    from ikde.io.report_folder import RESULTS, format_results, write_report
    from ikde.paper.inputs import FULL, QUICK, load_inputs
    from ikde.paper.page import make_paper_page
    from ikde.paper.results import compute_paper, count_solves
    from ikde.report.html import render_html
    from ikde.report.markdown import render_markdown
    from ikde.solver.compile_note import note_compile

    inputs = load_inputs(QUICK if quick else FULL)
    with show_benchmark(count_solves(inputs)) as progress:
        with note_compile(_name_work, TAKES):
            results = compute_paper(replace(inputs, progress=progress), sections)
        data = results.as_json()
        progress.begin("page")
        page = make_paper_page(results, inputs)
        texts = {"report.html": render_html(page), "report.md": render_markdown(page)}
        files = write_report(out, {RESULTS: format_results(data), **texts})
    if as_json:
        print_json(data)
    print_written(*files, as_json=as_json)


def _name_work() -> str:
    return "the paper's solver and ikde's, robot qiao2021"


def _check(out: Path, as_json: bool) -> ExitCode:
    from ikde.io.report_folder import RESULTS
    from ikde.paper.inputs import Budget, load_inputs
    from ikde.paper.results import check_paper, count_solves, read_results
    from ikde.solver.compile_note import note_compile

    recorded = read_results(out)
    inputs = load_inputs(Budget(**recorded["made"]["budget"]))
    with show_benchmark(count_solves(inputs)) as progress, note_compile(_name_work, TAKES):
        differences = check_paper(recorded, replace(inputs, progress=progress))
    if as_json:
        print_json({"agrees": not differences, "differences": differences})
    elif differences:
        for line in (f"{len(differences)} figures differ from {out / RESULTS}:", *differences):
            print_line(line)
    else:
        print_line(f"{out / RESULTS}: every exact figure comes out the same")
    return ExitCode.NOT_REACHED if differences else ExitCode.OK
