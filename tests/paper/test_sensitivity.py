"""One setting changed at a time: every change is one, and the distance to the print is the largest of four."""

from dataclasses import asdict, replace

import pytest

from ikde.paper import sensitivity as module
from ikde.paper.sensitivity import compute_sensitivity, list_variations, show_sensitivity
from ikde.report.page import Gallery, Table

GROUPS = {
    "as stated",
    "base range",
    "start population",
    "joint limits",
    "out of range",
    "mutation",
    "update",
    "tolerance",
}


def flatten(data):
    inner = [flatten(value) if isinstance(value, dict) else {name: value} for name, value in data.items()]
    return {name: value for part in inner for name, value in part.items()}


def differences(setup, other):
    own, theirs = flatten(asdict(setup)), flatten(asdict(other))
    return {name for name in own if own[name] != theirs[name]}


def test_each_variation_changes_one_thing():
    stated, *others = list_variations()
    assert {variation.group for variation in [stated, *others]} == GROUPS
    assert all(len(differences(stated.setup, other.setup)) == 1 for other in others)


@pytest.fixture(scope="module")
def table(inputs):
    few = [v for v in list_variations() if v.group in {"as stated", "update"}]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "list_variations", lambda: few)
        return compute_sensitivity(replace(inputs, budget=replace(inputs.budget, variation_solves=8)))


def test_rows_of_both_readings_and_of_other_judgements(table):
    rows = table.rows
    assert [(row.group, row.reading) for row in rows] == [
        *[(group, reading) for group in ("as stated", "update") for reading in ("equal", "unequal")],
        *[("pairs of both", "equal")] * 2,
        *[("judgement", "equal")] * 4,
    ]
    assert all(cell.SN == 8 for row in rows for cell in row.cells)


def test_the_distance_is_that_of_the_worst_cell(table):
    printed = [73, 63, 86, 65]
    for row in table.rows:
        gaps = [abs(cell.rejected_pct - p) for cell, p in zip(row.cells, printed, strict=True)]
        assert row.distance_points == pytest.approx(max(gaps))


def test_the_closest_come_first(table):
    ranked = [row.distance_points for row in table.closest]
    assert ranked == sorted(row.distance_points for row in table.rows)[:5]


def test_eq_18_misses_nearly_everything_and_eq_20_calls_too_much(table):
    rates = {row.value: [c.CN for c in row.cells] for row in table.rows if row.reading == "equal"}
    centres = rates["the setting of Table 4 above"]
    for grid in ("36 × 18", "360 × 180"):
        fewer, more = (rates[f"surface points, {rule}, {grid} a sphere"] for rule in ("eq. 18", "eq. 20"))
        assert all(a <= b <= c for a, b, c in zip(fewer, centres, more, strict=True))


def test_rows_and_forests(results, inputs):
    data = results.sections["sensitivity"]
    section = show_sensitivity(data, inputs)
    closest, *readings = [block for block in section.blocks if isinstance(block, Table)]
    assert sum(len(table.rows) for table in readings) == len(data.rows)
    assert len(closest.rows) == 5
    assert [column.title for column in readings[0].columns[2:6]] == [
        *("typical, print 73", "improved, print 63", "typical, print 86", "improved, print 65"),
    ]
    gallery = next(block for block in section.blocks if isinstance(block, Gallery))
    assert len(gallery.figures) == 4
    assert all("base range" in figure.image for figure in gallery.figures)
