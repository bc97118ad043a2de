"""Table 4's section: printed cells beside ours in both readings, and what agrees said as it is."""

from dataclasses import replace

from ikde.paper.rejection_page import show_rejection
from ikde.report.page import Cell, Figure, Text
from tests.report.batch_page.blocks import tables


def test_two_readings_with_every_printed_cell(results, inputs):
    section = show_rejection(results.sections["rejection"], inputs)
    for table in tables(section)[:2]:
        assert [row[2] for row in table.rows] == ["73 of 100", "63 of 100", "86 of 100", "65 of 100"]
        assert [row[3].split()[0] for row in table.rows] == ["73.0", "63.0", "86.0", "65.0"]
    assert [row[2] for row in tables(section)[-1].rows] == ["1.9053", "1.6700", "1.9353", "1.7081"]
    assert any(isinstance(block, Figure) for block in section.blocks)


def test_a_print_outside_our_interval_is_said(results, inputs):
    data = results.sections["rejection"]
    half = {"CN": 5000, "SN": 10000, "rejected_pct": 50.0, "interval_pct": [49.0, 51.0]}
    targets = []
    for target in data.targets:
        few, many = target.samples[0], target.samples[-1]
        many = replace(many, rates=[replace(rate, **half) for rate in many.rates])
        targets.append(replace(target, samples=[few, many]))
    section = show_rejection(replace(data, targets=targets), inputs)
    assert all(row[-2:] == (Cell("no", "off"), Cell("no", "off")) for row in tables(section)[0].rows)
    judged = [block.markup for block in section.blocks if isinstance(block, Text)][1]
    assert "0 of 4 of our rates lie within the sampling error of the print" in judged
    assert "the largest distance 36.0 points" in judged
