"""The page of several methods: one table over all, ours marked, and their figures side by side."""

from dataclasses import replace

import pytest

import ikde
from ikde.report import track_comparison
from ikde.report.html import render_html
from ikde.report.track_comparison import (
    compare_json,
    list_cells,
    make_comparison_page,
    make_ends_table,
    make_runs_table,
)
from ikde.report.track_page import BASE, MARGINS, PATH
from ikde.track.comparison import Compared, TrackBudget, measure
from tests.track.measured import make_measured, make_still

BUDGET = TrackBudget(seeds=2, starts=4)


@pytest.fixture(scope="module")
def compared(qiao):
    path = {"expressions": {"x": 1, "y": 0, "z": 1}}
    plan = ikde.load_track({"name": "wave", "robot": "qiao2021", "dt_s": 0.02, "samples": 20, "path": path})
    motions = {"typical": make_measured(qiao, amplitude=1.5), "continuation": make_measured(qiao)}
    runs = [
        {"method": name, "drive": motion.trajectory.drive, "seed": seed, **measure(motion)}
        for name, motion in motions.items()
        for seed in (0, 1)
    ]
    runs[0] = {**runs[0], "colliding_samples": 2, "certified_clearance_mm": -99.0}
    reached = {"greedy": [], "continuation": []}
    stops = {"continuation": {"speed_limit q3": 1}}
    ends = {"starts": 4, "greedy": 3, "continuation": 1, "stops": stops, "reached_points": reached}
    return [Compared(plan=plan, motions=motions, data={"name": "wave", "points": 20, "runs": runs, "dead_ends": ends})]


def test_a_row_is_the_worst_of_the_seeds(compared):
    table = make_runs_table(compared)
    typical, ours = (dict(zip([c.head for c in table.columns], row, strict=True)) for row in table.rows)
    assert typical["method"] == "typical"
    assert typical["points reached"] == "20 of 20"
    assert typical["broken: collisions"] == "0–2"
    assert typical["clearance [mm]"] == "-99.0"
    assert (ours["broken: limits"].text, ours["broken: limits"].mark) == ("0", "ours")
    assert ours["whole path [s]"].text == "0.25"


def test_what_was_not_checked_is_not_counted_as_kept(qiao):
    run = measure(make_measured(qiao, detector="none"))
    for name in ("colliding_samples", "smallest_clearance_mm", "certified_clearance_mm"):
        assert run[name] is None
    cells = list_cells([run, run])
    assert cells[4] == "not checked"
    assert cells[8] == "–"


def test_dead_ends_are_of_all_starts(compared):
    table = make_ends_table(compared)
    greedy, ours = table.rows
    assert greedy == ("wave", "greedy", "3 of 4", "")
    assert [cell.text for cell in ours] == ["wave", "continuation", "1 of 4", "1 speed limit q3"]


def test_the_page_shows_the_methods_side_by_side(compared, monkeypatch):
    monkeypatch.setattr(track_comparison, "DRAWINGS", (("Path and clearance", (PATH, MARGINS)),))
    text = render_html(make_comparison_page(compared, BUDGET, "ikde bench track wave.yaml --out FOLDER"))
    assert text.count("<canvas") == text.count("data:image/png") == 2
    assert text.count("<svg") == 4
    assert "ikde bench track wave.yaml" in text
    assert compare_json(compared, BUDGET)["made"]["budget"] == {"seeds": 2, "starts": 4}


def test_a_singular_value_of_nothing_but_rounding_is_0(compared):
    (one,) = compared
    runs = [{**run, "smallest_singular_value": 1.8e-18} for run in one.data["runs"]]
    table = make_runs_table([replace(one, data={**one.data, "runs": runs})])
    assert dict(zip([c.head for c in table.columns], table.rows[0], strict=True))["smallest σ"] == "0"


def test_a_robot_that_stands_still_has_nothing_about_its_base(compared, monkeypatch):
    monkeypatch.setattr(track_comparison, "DRAWINGS", (("Base", (BASE,)), ("Path", (PATH,))))
    still = make_still(ikde.load_robot("ur5"), detector="none")
    motions = dict.fromkeys(compared[0].motions, still)
    text = render_html(make_comparison_page([replace(compared[0], motions=motions)], BUDGET, "ikde bench track"))
    assert "Path</strong>" in text
    assert "Base</strong>" not in text


@pytest.mark.parametrize(
    ("names", "short"),
    [
        (["Qiao 2022, task 1", "Qiao 2022, task 2"], ["task 1", "task 2"]),
        (["Qiao 2022, task 1", "weld, seam"], ["Qiao 2022, task 1", "weld, seam"]),
        (["wave", "wave"], ["wave", "wave"]),
    ],
)
def test_names_lose_the_words_they_share(names, short):
    assert track_comparison.shorten_names(names) == short
