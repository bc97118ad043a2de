"""`ikde batch`: solve everything that a run file asks for, into a folder; stop and go on at will."""

import gc
from contextlib import AbstractContextManager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ikde.cli.exit_codes import ExitCode
from ikde.cli.options import JsonOption, note_unchecked
from ikde.cli.output import layout, print_json, print_note, print_result, working
from ikde.cli.progress import show_progress

if TYPE_CHECKING:
    from ikde.batch.plan import Batch
    from ikde.batch.summary import RunSummary

CLUSTER = "Cluster"


def batch(
    spec: Annotated[
        Path, typer.Argument(metavar="FILE", help="What to run: see configs/runs/ and `ikde schema batch`.")
    ],
    out: Annotated[
        Path | None, typer.Option(metavar="FOLDER", help="Where the answers go; an existing run there is resumed.")
    ] = None,
    threads: Annotated[int | None, typer.Option(help="Threads (default: all cores). Same answers.")] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace the run that is in the folder.")] = False,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Say what would run and how long, by solving a sample; write nothing.")
    ] = False,
    row: Annotated[
        str | None,
        typer.Option(
            metavar="ARM/TARGET/REPEAT", help="Solve this one row again, print it, and compare it with the run's."
        ),
    ] = None,
    attach: Annotated[
        str | None,
        typer.Option(
            metavar="OBJECT=FRAME,..",
            help="Obstacles of each world that the robot holds beside the file's `attached`, picked up at its `near`, "
            "else home. mug=tool:table+finger: what it may touch.",
        ),
    ] = None,
    dask: Annotated[
        str | None,
        typer.Option(metavar="ADDRESS|local", help="Let a Dask cluster do the work.", rich_help_panel=CLUSTER),
    ] = None,
    workers: Annotated[
        int | None, typer.Option(help="Processes of --dask local (default: one a core).", rich_help_panel=CLUSTER)
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Solve a batch. Kill it at any moment: the same command goes on, and the answers are the same bits.

    `ikde report FOLDER` then makes a page of its answers. Exits with 1 if some solve did not reach its target.

    Example: ikde batch configs/runs/first_run.yaml --out runs/first
    """
    from ikde.io.plan_file import load_batch
    from ikde.report.batch import format_run, run_json

    gc.enable()
    if out is None and not dry_run and row is None:
        raise typer.BadParameter("a run needs a folder; only --dry-run and --row need none", param_hint="--out")
    plan, solving = load_batch(spec, attach), {"threads": threads, "dask": dask, "workers": workers}
    if not all(arm.problem.collision.pairs for arm in plan.arms):
        note_unchecked(plan.robot)
    if row is not None:
        raise typer.Exit(_solve_again(plan, out, row, as_json))
    if out is None or dry_run:
        _preview(plan, out, as_json, overwrite=overwrite, **solving)
        return
    summary = _run(plan, out, overwrite=overwrite, **solving)
    if as_json:
        print_json(run_json(summary))
    else:
        print_result(format_run(summary, **layout(160)))
    raise typer.Exit(ExitCode.NOT_REACHED if summary.unreached else ExitCode.OK)


def _solve_again(plan: "Batch", out: Path | None, row: str, as_json: bool) -> ExitCode:
    """Print one row as `ikde solve` prints its answer, and say whether the run holds the same bits."""
    from ikde.batch.one_row import compare_row, parse_row, solve_row
    from ikde.report.numbers import Units
    from ikde.report.solve import format_solve, solve_json
    from ikde.solver.grade import confirm

    asked = parse_row(row)
    with working("solving ..."), _note_compile(plan):
        result, solution = solve_row(plan, asked)
    result = confirm(plan.robot, result)
    same = out is not None and compare_row(out, plan, asked, solution)
    if as_json:
        print_json({"row": str(asked), "same_as_run": same or None, **solve_json(plan.robot, result)})
    else:
        print_result(format_solve(plan.robot, result, Units(), **layout()))
        if same:
            print_note(f"the same bits as in {out}")
    return ExitCode.OK if result.reached else ExitCode.NOT_REACHED


def _preview(
    plan: "Batch", out: Path | None, as_json: bool, *, overwrite: bool, threads: int | None, **cluster: Any
) -> None:
    from ikde.batch.folder import check_folder
    from ikde.batch.options import check_options
    from ikde.batch.preview import preview_batch
    from ikde.report.batch import format_preview, preview_json

    check_options(threads, **cluster)
    if out is not None:
        check_folder(out, plan, overwrite=overwrite)
    if cluster["dask"] is not None:
        print_note("a dry run solves its sample on this machine: the cluster is not used")
    with working("solving a sample ..."), _note_compile(plan):
        preview = preview_batch(plan, threads=threads)
    if as_json:
        print_json(preview_json(preview))
    else:
        print_result(format_preview(preview, **layout(160)))


def _note_compile(plan: "Batch") -> AbstractContextManager[Any]:
    """Say what the arms compile, once for all of them."""
    from ikde.solver.compile_note import name_work, note_compile

    return note_compile(lambda: name_work("many targets", *(arm.problem.collision for arm in plan.arms)))


def _run(plan: "Batch", out: Path, **solving: Any) -> "RunSummary":
    """Run with a progress bar; Ctrl-C says how to resume."""
    from ikde.batch.parts import GO_ON
    from ikde.batch.run import run_batch

    try:
        with show_progress(f"{plan.name} → {out}") as tell, _note_compile(plan):
            return run_batch(plan, out, progress=tell, **solving)
    except KeyboardInterrupt:
        raise typer.Abort(f"ikde: interrupted; {GO_ON}") from None
