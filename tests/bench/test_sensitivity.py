"""One setting changed at a time: every change is one, and the distance to the print is the largest of four."""

from dataclasses import asdict, replace

import pytest

from ikde.bench import sensitivity as module
from ikde.bench.budget import QUICK
from ikde.bench.sensitivity import compute_sensitivity, list_variations
from ikde.io.published import load_published

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
def table(qiao):
    few = [v for v in list_variations() if v.group in {"as stated", "update"}]
    patch = pytest.MonkeyPatch()
    patch.setattr(module, "list_variations", lambda: few)
    yield compute_sensitivity(qiao, load_published(), replace(QUICK, variation_solves=8))
    patch.undo()


def test_rows_of_both_readings_and_of_other_judgements(table):
    rows = table["exact"]["rows"]
    assert [(row["group"], row["reading"]) for row in rows] == [
        *[(group, reading) for group in ("as stated", "update") for reading in ("equal", "unequal")],
        *[("pairs of both", "equal")] * 2,
        *[("judgement", "equal")] * 4,
    ]
    assert all(cell["SN"] == 8 for row in rows for cell in row["cells"])


def test_the_distance_is_that_of_the_worst_cell(table):
    printed = [73, 63, 86, 65]
    for row in table["exact"]["rows"]:
        gaps = [abs(cell["rejected_pct"] - p) for cell, p in zip(row["cells"], printed, strict=True)]
        assert row["farthest_points"] == pytest.approx(max(gaps))


def test_the_closest_come_first(table):
    ranked = [row["farthest_points"] for row in table["exact"]["closest"]]
    assert ranked == sorted(row["farthest_points"] for row in table["exact"]["rows"])[:5]


def test_eq_18_misses_nearly_everything_and_eq_20_calls_too_much(table):
    rates = {
        row["value"]: [c["CN"] for c in row["cells"]] for row in table["exact"]["rows"] if row["reading"] == "equal"
    }
    centres = rates["the setting of Table 4 above"]
    for grid in ("36 × 18", "360 × 180"):
        fewer, more = (rates[f"surface points, {rule}, {grid} a sphere"] for rule in ("eq. 18", "eq. 20"))
        assert all(a <= b <= c for a, b, c in zip(fewer, centres, more, strict=True))
