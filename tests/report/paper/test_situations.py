"""The situations' section: six detections beside the print, three curves, six pictures."""

import json

import pytest

from ikde.report.page import Cell, Figure, Gallery, Table, Text
from ikde.report.paper.situations import make_situations


@pytest.fixture(scope="module")
def section(results, robots):
    return make_situations(results["sections"]["situations"], robots["key_point"])


def blocks(section, kind):
    return [block for block in section.blocks if isinstance(block, kind)]


def test_every_detection_stands_beside_the_print(section):
    (table,) = blocks(section, Table)
    assert [(row[2], row[3]) for row in table.rows] == [
        (angle, angle) for angle in ("142.20", "147.60", "40.05", "38.25", "77.40", "99.00")
    ]


def test_contacts_that_do_not_fit_their_time_are_marked(section):
    (table,) = blocks(section, Table)
    assert [row[6] for row in table.rows[::2]] == ["155.7", Cell("26.0", "off"), Cell("110.7", "off")]
    assert [row[7] for row in table.rows[::2]] == ["155.7", "20.7", "111.6"]


def test_every_misprint_is_named_and_leads_to_its_evidence(section, results):
    (table,) = blocks(section, Table)
    assert "(#misprints)" in table.note
    for situation in results["sections"]["situations"]["exact"]["situations"]:
        for entry in (situation, situation["simulator"]):
            assert entry["misprint"] is None or entry["misprint"]["see"] in table.note


def test_a_printed_start_that_was_not_meant_is_told(section):
    markups = [block.markup for block in blocks(section, Text)]
    assert "from (90, 0, 0, 0, 0, 0) (printed: (90, 0, 18, 18, 0, 0)) to (90, 0, 180, 180, 0, 0) deg" in markups[1]
    assert "printed" not in markups[2]


def test_each_situation_has_its_curve_and_its_pictures(section):
    curves = blocks(section, Figure)
    assert [curve.caption.split(",")[0] for curve in curves] == ["Figure 9", "Figure 10", "Figure 11"]
    assert all("contact in V-REP" in curve.image for curve in curves)
    assert [len(gallery.figures) for gallery in blocks(section, Gallery)] == [2, 2, 2]


def test_a_detector_that_sees_nothing_is_no_crash(results, robots):
    data = json.loads(json.dumps(results["sections"]["situations"]))
    printed = data["exact"]["situations"][0]["detectors"][0]["printed_deg"]
    blind = {"detector": "typical", "printed_deg": printed, "agrees": False, "detected_deg": None}
    data["exact"]["situations"][0]["detectors"][0] = blind
    section = make_situations(data, robots["key_point"])
    (table,) = blocks(section, Table)
    assert table.rows[0][3] == Cell("never", "off")
    assert len(blocks(section, Gallery)[0].figures) == 1
