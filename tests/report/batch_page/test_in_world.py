"""A worst row among the obstacles of its run."""

from dataclasses import replace

from ikde.report.batch_page.page import make_batch_page
from ikde.report.batch_page.worst import make_worst
from ikde.report.html import render_html
from ikde.report.page import Code, Details, Figure, Text


def blocks(run, kind):
    return [
        part
        for block in make_worst(run).blocks
        if isinstance(block, Details)
        for part in block.blocks
        if isinstance(part, kind)
    ]


def test_a_worst_row_is_repeated_in_its_world(placed):
    (command, *_) = [block.text for block in blocks(placed, Code) if "ikde check" in block.text]
    assert command.startswith("ikde check --robot qiao2021 --detector improved --world kitchen.yaml --margin 0.0 --q ")
    assert any("in its world" in figure.caption for figure in blocks(placed, Figure))
    html = render_html(make_batch_page(placed))
    assert "By world" in html


def test_a_world_that_is_another_one_now_is_not_drawn(placed, in_worlds):
    here = replace(placed, manifest=replace(placed.manifest, file=str(in_worlds / "elsewhere" / "run.yaml")))
    assert not [block for block in blocks(here, Figure) if "in its world" in block.caption]
    assert any("its world is no file any more" in text.markup for text in blocks(here, Text))
