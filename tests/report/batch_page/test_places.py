"""Where the targets are, on the page."""

from dataclasses import replace

import numpy as np

from ikde.report.batch_page import places
from ikde.report.batch_page.places import make_places


def draw(run, monkeypatch):
    """What is drawn: label -> points."""
    drawn = {}

    def keep(groups):
        drawn.update({group.label: group.points_m for group in groups})
        return plot(groups)

    plot = places.plot_places
    monkeypatch.setattr(places, "plot_places", keep)
    section = make_places(run)
    return section, drawn


def test_targets_are_drawn_where_they_are_by_how_often_they_were_reached(answers, rows, monkeypatch):
    section, drawn = draw(answers, monkeypatch)
    (figure,) = section.blocks
    assert drawn["not reached"].tolist() == [[9.0, 9.0, 9.0]]
    count = {target: sum(row["reached"] for row in rows if row["target"] == target) for target in range(4)}
    always = [points for label, points in drawn.items() if "mm" in label or label == "reached"]
    assert sum(map(len, always)) == sum(reached == 16 for reached in count.values())
    assert len(drawn.get("reached at times", ())) == sum(0 < reached < 16 for reached in count.values())
    assert "coloured by the least clearance" in figure.caption


def test_classes_of_clearance_hold_each_target_once():
    clearance_m = np.array([0.001, 0.002, 0.003, 0.004, np.nan, 0.002])
    groups = places._classify(clearance_m, np.array([True] * 5 + [False]))
    members = np.array([chosen for _, chosen, _ in groups])
    assert members.sum(axis=0).tolist() == [1, 1, 1, 1, 1, 0]
    assert groups[0][1].tolist() == [False] * 4 + [True, False]
    assert next(label for label, *_ in groups[1:]).startswith("1.00 to 1.75 mm")


def test_classes_that_read_the_same_are_one():
    clearance_m = np.array([0.001, 0.0139001, 0.0139002, 0.0139003, 0.0139004, 0.0139005])
    groups = places._classify(clearance_m, np.full(6, True))
    labels = [label for label, chosen, _ in groups if chosen.any()]
    assert labels == ["1.00 to 13.9 mm", "13.9 mm"]
    assert np.sum([chosen for _, chosen, _ in groups], axis=0).tolist() == [1] * 6


def test_a_run_that_does_not_keep_places_has_no_such_section(bare):
    assert make_places(replace(bare, places_m={})) is None
