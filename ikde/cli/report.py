"""`ikde report`: a run of `ikde batch` as a page."""

import gc
from pathlib import Path
from typing import Annotated

import typer

from ikde.cli.options import JsonOption
from ikde.cli.output import print_json, print_written


def report(
    run: Annotated[Path, typer.Argument(metavar="RUN", help="The folder of a run of `ikde batch`, finished or not.")],
    out: Annotated[
        Path | None, typer.Option(metavar="FOLDER", help="Where report.html and report.md go (default: RUN/report).")
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Make a page of the answers of `ikde batch`, for the browser and as Markdown.

    Example: ikde report runs/first
    """
    from ikde.batch.manifest import REPORT, REPORT_FILES, refuse_links
    from ikde.io.report_folder import prepare_folder, write_report
    from ikde.report.batch_page.answers import gather_answers
    from ikde.report.batch_page.page import make_batch_page
    from ikde.report.html import render_html
    from ikde.report.markdown import render_markdown

    gc.enable()
    answers = gather_answers(run)
    if out is None:
        refuse_links(run, REPORT)
    folder = run / REPORT if out is None else out
    prepare_folder(folder)
    page = make_batch_page(answers)
    html, markdown = (folder / name for name in REPORT_FILES)
    write_report(folder, {html.name: render_html(page), markdown.name: render_markdown(page)})
    if as_json:
        print_json({"html": str(html), "markdown": str(markdown), "finished": answers.finished})
    print_written(html, markdown, as_json=as_json)
