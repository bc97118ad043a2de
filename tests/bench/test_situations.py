"""Situations 1 to 3: printed angles, curves, and how early a detector speaks."""

import numpy as np
import pytest

import ikde
from ikde.bench.budget import QUICK
from ikde.bench.situations import compute_situations
from tests.bench.conftest import is_plain


@pytest.fixture(scope="module")
def section(qiao, published):
    return compute_situations(qiao, published, QUICK)


@pytest.fixture(scope="module")
def situations(section):
    return section["exact"]["situations"]


def test_every_printed_angle_is_detected(section, situations):
    assert is_plain(section)
    found = [(d["printed_deg"], d["agrees"]) for s in situations for d in s["detectors"]]
    assert found == [(angle, True) for angle in (142.2, 147.6, 40.05, 38.25, 77.4, 99.0)]


def test_the_spheres_are_apart_a_step_before_and_cross_at_the_detected_angle(situations):
    for detector in (d for s in situations for d in s["detectors"]):
        clearance = detector["clearance_mm"]
        assert clearance["step_before"] > 0.0 >= clearance["detected"] > clearance["contact"]
        assert detector["detected_s"] - 0.05 <= detector["onset_s"] <= detector["detected_s"]


def test_both_detectors_speak_before_the_simulator_and_the_improved_one_later(situations):
    for situation in situations:
        typical, improved = (d["early_deg"] for d in situation["detectors"])
        for key in ("printed", "ours"):
            assert typical[key] > improved[key] > 0.0
    assert situations[0]["detectors"][0]["early_deg"]["printed"] == pytest.approx(155.7 - 142.2)
    assert situations[1]["detectors"][0]["early_deg"]["printed"] == pytest.approx(40.05 - 20.7)


def test_curves_show_the_clearance_that_check_sees(qiao, situations):
    situation, moment = situations[2], 40
    curve = situation["curve"]
    q = [0, 0, 0, *np.radians([90, curve["angle_deg"][moment], 0, 0, 0, 0])]
    for name, values in curve["clearance_mm"].items():
        assert len(values) == QUICK.curve_points
        look = ikde.Detector(name="look", spheres=name, pairs=situation["pairs"])
        assert 1e3 * ikde.check(qiao, q, look).clearance_m == pytest.approx(values[moment], abs=1e-9)


def test_the_configuration_to_draw_is_that_of_the_detected_angle(situations):
    for situation in situations:
        joint = int(situation["varies"][1]) + 2
        for detector in situation["detectors"]:
            assert np.degrees(detector["q_detected"][joint]) == pytest.approx(detector["detected_deg"])
