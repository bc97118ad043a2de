"""The motions of section 5.4 and the search for a detector's onset."""

from dataclasses import replace

import numpy as np
import pytest

import ikde
from ikde.model.collision_model import CollisionModel
from ikde.paper.section import make_collision
from ikde.paper.sweeps import bisect, compute_clearance, find_onset, read_sweeps, shows_sweep


@pytest.fixture(scope="module")
def sweeps(published):
    return {sweep.name: sweep for sweep in read_sweeps(published)}


def test_a_motion_goes_from_start_to_end_at_constant_speed(sweeps):
    Q = sweeps["1"].configurations(np.array([0.0, 5.0, 10.0]))
    np.testing.assert_allclose(np.degrees(Q[:, 3:]), [[90, 0, a, a, 0, 0] for a in (0, 90, 180)], atol=1e-12)
    assert sweeps["2"].angle(5.0) == 45.0
    assert sweeps["2"].time(45.0) == 5.0


def test_clearance_is_that_of_check(qiao, rng):
    Q = rng.uniform(qiao.lower, qiao.upper, (10, 9))
    for name in qiao.detectors:
        expected = [ikde.check(qiao, q, name).clearance_m for q in Q]
        np.testing.assert_allclose(compute_clearance(CollisionModel.of(qiao, name), Q), expected, atol=1e-14)


def test_bisection_finds_the_end():
    assert bisect(lambda x: x < 0.3, 0.0, 1.0) == pytest.approx(0.3, abs=1e-11)


@pytest.mark.parametrize("name", ["1", "2", "3"])
@pytest.mark.parametrize("detector", ["typical", "improved"])
def test_the_onset_lies_where_the_clearance_is_0(qiao, sweeps, name, detector):
    sweep = sweeps[name]
    found = find_onset(qiao, sweep, detector)
    assert found.detected_s - 0.05 <= found.onset_s <= found.detected_s
    gap = compute_clearance(
        make_collision(qiao, detector, sweep.pairs), sweep.configurations(np.array([found.onset_s]))
    )
    assert gap == pytest.approx(0.0, abs=1e-9)
    assert shows_sweep(qiao, sweep, detector)


def test_a_motion_that_starts_in_collision_has_no_onset(qiao, sweeps):
    assert find_onset(qiao, replace(sweeps["2"], pairs="formula_22"), "typical") is None


def test_an_angle_that_is_not_detected_is_not_shown(qiao, sweeps):
    for angle in (141.3, 143.1):
        wrong = replace(sweeps["1"], detected_deg={"typical": angle})
        assert not shows_sweep(qiao, wrong, "typical")
