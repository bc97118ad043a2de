"""Table 3's section: eight columns, the ratios of the text, of its table and ours, and who is faster here."""

from dataclasses import replace

from ikde.paper.timing_page import show_timing
from ikde.report.page import Table, Text


def test_eight_columns_and_four_ratios(results, inputs):
    section = show_timing(results.sections["timing"], inputs)
    times, ratios, printed, ours = [block for block in section.blocks if isinstance(block, Table)]
    assert len(printed.rows) == 13
    assert printed.rows[0][1] == "682.0"
    assert printed.rows[10][:2] == ("printed average", "631.1")
    assert (len(ours.rows), len(ours.columns)) == (10, 9)
    assert [row[0] for row in times.rows] == ["Ta1", "Tb1", "Tc1", "Td1", "Ta2", "Tb2", "Tc2", "Td2"]
    assert times.rows[0][4] == "631.1"
    assert [row[3:5] for row in ratios.rows] == [("47", "40.4"), ("47", "37.7"), ("61", "66.6"), ("61", "67.9")]


def test_the_conclusion_follows_the_figures(results, inputs):
    data = results.sections["timing"]
    kinematics = data.measured["kinematics"]
    pairs = zip(kinematics.ratios, (0.5, 0.5, 1.2, 1.3), strict=True)
    ratios = [replace(ratio, median=median) for ratio, median in pairs]
    data = replace(data, measured={**data.measured, "kinematics": replace(kinematics, ratios=ratios)})
    last = [block for block in show_timing(data, inputs).blocks if isinstance(block, Text)][-1]
    assert "surface points by key points take 50 to 50 % of the time by transformation (less than it)" in last.markup
    assert "120 to 130 % of the time by transformation (no less than it)" in last.markup
