"""`ikde bench`; and `ikde bench paper`: the paper's tables and figures, published beside ours, as one page."""

import gc
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ikde.cli.bench_track import bench_track
from ikde.cli.exit_codes import ExitCode
from ikde.cli.options import Command, JsonOption
from ikde.cli.output import note_compile, print_json, print_line
from ikde.cli.progress import show_benchmark

if TYPE_CHECKING:
    from ikde.bench.paper import Sources

TAKES = "about a minute"  # compiling all kernels

bench = typer.Typer(help="Benchmarks that compare with published results.", no_args_is_help=True)


@bench.callback()
def default() -> None:
    """Benchmarks that compare with published results."""


bench.command("track", cls=Command)(bench_track)


@bench.command("paper", cls=Command)
def paper(
    out: Annotated[
        Path, typer.Option(metavar="FOLDER", help="Where report.html, report.md and results.json go.")
    ] = Path("report"),
    quick: Annotated[bool, typer.Option("--quick", help="Small samples: seconds instead of minutes.")] = False,
    only: Annotated[
        str | None,
        typer.Option(metavar="SECTION,...", help="Compute these sections alone."),
    ] = None,
    check: Annotated[
        bool, typer.Option("--check", help="Compute what is exact again, compare it with results.json; write nothing.")
    ] = False,
    as_json: JsonOption = False,
) -> None:
    """Compute the tables and figures of Qiao et al. 2021 and show them beside the print.

    Exits with 1 if --check finds a difference.

    Example: ikde bench paper --out report/
    """
    from ikde.io.report_folder import prepare_folder, read_results

    gc.enable()
    if check and (quick or only):
        raise typer.BadParameter("results.json says what is in it; leave --quick and --only out", param_hint="--check")
    sections = _read_sections(only)
    if check:
        raise typer.Exit(_check(read_results(out), out, as_json))
    prepare_folder(out)
    _make(out, quick, sections, as_json)


def _read_sections(only: str | None) -> tuple[str, ...]:
    from ikde.bench.paper import SECTIONS

    if only is None:
        return SECTIONS
    chosen = tuple(filter(None, only.split(",")))
    wrong = [name for name in chosen if name not in SECTIONS]
    if wrong or not chosen:
        raise typer.BadParameter(f"expected some of {', '.join(SECTIONS)}, got {only!r}", param_hint="--only")
    return chosen


def _make(out: Path, quick: bool, sections: tuple[str, ...], as_json: bool) -> None:
    from ikde.bench.budget import FULL, QUICK
    from ikde.bench.paper import compute_paper, count_solves
    from ikde.io.report_folder import RESULTS, format_results, write_report

    sources, budget = _load_sources(), QUICK if quick else FULL
    with show_benchmark(count_solves(sources, budget)) as progress:
        with note_compile(TAKES):
            results = compute_paper(sources, budget, only=sections, progress=progress)
        progress.begin("page")
        write_report(out, {RESULTS: format_results(results), **_render(results, sources)})
    if as_json:
        print_json(results)
    else:
        print_line(f"{out / 'report.html'}  (report.md and {RESULTS} beside it)")


def _render(results: Mapping[str, Any], sources: "Sources") -> dict[str, str]:
    from ikde.report.html import render_html
    from ikde.report.markdown import render_markdown
    from ikde.report.paper.page import make_paper_page

    page = make_paper_page(results, {"key_point": sources.key_point, "classical": sources.classical})
    return {"report.html": render_html(page), "report.md": render_markdown(page)}


def _check(recorded: Mapping[str, Any], out: Path, as_json: bool) -> ExitCode:
    from ikde.bench.budget import Budget
    from ikde.bench.paper import check_paper, count_solves
    from ikde.io.report_folder import RESULTS

    sources = _load_sources()
    solves = count_solves(sources, Budget(**recorded["made"]["budget"]))
    with show_benchmark(solves) as progress, note_compile(TAKES):
        differences = check_paper(recorded, sources, progress=progress)
    if as_json:
        print_json({"agrees": not differences, "differences": differences})
    elif differences:
        for line in (f"{len(differences)} figures differ from {out / RESULTS}:", *differences):
            print_line(line)
    else:
        print_line(f"{out / RESULTS}: every exact figure comes out the same")
    return ExitCode.NOT_REACHED if differences else ExitCode.OK


def _load_sources() -> "Sources":
    from ikde.bench.paper import Sources
    from ikde.io.published import load_misprints, load_published
    from ikde.io.robots import load_robot

    return Sources(
        key_point=load_robot("qiao2021"),
        classical=load_robot("qiao2021_dh"),
        published=load_published(),
        misprints=load_misprints(),
    )
