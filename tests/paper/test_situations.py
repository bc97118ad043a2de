"""Situations 1 to 3: printed angles, curves, and how early a detector speaks."""

from dataclasses import replace

import numpy as np
import pytest

import ikde
from ikde.paper.situations import Detection, compute_situations, show_situations
from ikde.report.page import Cell, Figure, Gallery, Table, Text
from tests.paper.conftest import is_plain
from tests.tiny_paper import TINY


@pytest.fixture(scope="module")
def section(results):
    return results.sections["situations"]


@pytest.fixture(scope="module")
def situations(section):
    return section.situations


def test_every_printed_angle_is_detected(section, situations):
    assert is_plain(section)
    found = [(d.printed_deg, d.agrees) for s in situations for d in s.detectors]
    assert found == [(angle, True) for angle in (142.2, 147.6, 40.05, 38.25, 77.4, 99.0)]


def test_the_spheres_are_apart_a_step_before_and_cross_at_the_detected_angle(situations):
    for detector in (d for s in situations for d in s.detectors):
        clearance = detector.clearance_mm
        assert clearance["step_before"] > 0.0 >= clearance["detected"] > clearance["contact"]
        assert detector.detected_s - 0.05 <= detector.onset_s <= detector.detected_s


def test_both_detectors_speak_before_the_simulator_and_the_improved_one_later(situations):
    for situation in situations:
        typical, improved = (d.early_deg for d in situation.detectors)
        assert typical.printed > improved.printed > 0.0
        assert typical.ours > improved.ours > 0.0
    assert situations[0].detectors[0].early_deg.printed == pytest.approx(155.7 - 142.2)
    assert situations[1].detectors[0].early_deg.printed == pytest.approx(40.05 - 20.7)


def test_curves_show_the_clearance_that_check_sees(qiao, situations):
    situation, moment = situations[2], 4
    curve = situation.curve
    q = [0, 0, 0, *np.radians([90, curve.angle_deg[moment], 0, 0, 0, 0])]
    for name, values in curve.clearance_mm.items():
        assert len(values) == TINY.curve_points
        look = ikde.Detector(name="look", spheres=name, pairs=situation.pairs)
        assert 1e3 * ikde.check(qiao, q, look).clearance_m == pytest.approx(values[moment], abs=1e-9)


def test_the_configuration_to_draw_is_that_of_the_detected_angle(situations):
    for situation in situations:
        joint = int(situation.varies[1]) + 2
        for detector in situation.detectors:
            assert np.degrees(detector.q_detected[joint]) == pytest.approx(detector.detected_deg)


@pytest.fixture(scope="module")
def shown(section, inputs):
    return show_situations(section, inputs)


def blocks(section, kind):
    return [block for block in section.blocks if isinstance(block, kind)]


def test_every_detection_stands_beside_the_print(shown):
    (table,) = blocks(shown, Table)
    assert [(row[2], row[3]) for row in table.rows] == [
        (angle, angle) for angle in ("142.20", "147.60", "40.05", "38.25", "77.40", "99.00")
    ]


def test_contacts_that_do_not_fit_their_time_are_marked(shown):
    (table,) = blocks(shown, Table)
    assert [row[6] for row in table.rows[::2]] == ["155.7", Cell("26.0", "off"), Cell("110.7", "off")]
    assert [row[7] for row in table.rows[::2]] == ["155.7", "20.7", "111.6"]


def test_every_misprint_is_named_and_leads_to_its_evidence(situations, shown):
    (table,) = blocks(shown, Table)
    assert "(#misprints)" in table.note
    for situation in situations:
        for entry in (situation, situation.simulator):
            assert entry.misprint is None or entry.misprint["see"] in table.note


def test_a_printed_start_that_was_not_meant_is_told(shown):
    markups = [block.markup for block in blocks(shown, Text)]
    assert "from (90, 0, 0, 0, 0, 0) (printed: (90, 0, 18, 18, 0, 0)) to (90, 0, 180, 180, 0, 0) deg" in markups[1]
    assert "printed" not in markups[2]


def test_each_situation_has_its_curve_and_its_pictures(shown):
    curves = blocks(shown, Figure)
    assert [curve.caption.split(",")[0] for curve in curves] == ["Figure 9", "Figure 10", "Figure 11"]
    assert all("contact in V-REP" in curve.image for curve in curves)
    assert [len(gallery.figures) for gallery in blocks(shown, Gallery)] == [2, 2, 2]


def test_a_detector_that_never_touches_has_dashes_and_no_picture(section, inputs):
    first, *others = section.situations
    blind = Detection(detector="typical", printed_deg=142.2, agrees=False, detected_deg=None)
    first = replace(first, detectors=[blind, first.detectors[1]])
    shown = show_situations(replace(section, situations=[first, *others]), inputs)
    (table,) = blocks(shown, Table)
    assert table.rows[0][2:6] == ("142.20", Cell("never", "off"), "–", "–")
    assert len(blocks(shown, Gallery)[0].figures) == 1


def test_a_motion_that_starts_in_collision_is_not_detected(inputs):
    entry = {**inputs.published["situations"]["2"], "pairs": "formula_22"}
    alone = replace(inputs, published={"situations": {"2": entry}})
    assert compute_situations(alone).detections[0].detected_deg is None
