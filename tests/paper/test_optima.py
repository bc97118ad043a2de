"""Where w2 is largest: grids, climbing, evolution, mirror images and units."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import differential_evolution

from ikde.paper.inputs import load_dong_zhao
from ikde.paper.manipulability import read_surfaces, scale_arm
from ikde.paper.optima import (
    FREE,
    choose_half,
    climb,
    fall_short,
    find_pair_peak,
    find_peak_by_evolution,
    find_peak_by_grid,
    mirror_deg,
    newton_step_deg,
    spread_pair,
    wrap_deg,
)
from ikde.paper.tracked_arm import PRINTED, RIGID, TrackedArm, compute_slope, compute_w1, compute_w2

LENGTHS = {"links_m": (0.3, 0.25, 0.2), "arm_offset_m": 0.1, "track_m": 0.4}
ARMS = {chain.name: TrackedArm(**LENGTHS, chain=chain) for chain in (PRINTED, RIGID)}
SURFACES = {surface.figure: surface for surface in read_surfaces(load_dong_zhao())}
FIGURE_4 = TrackedArm(links_m=(2.1994, 0.9777, 0.9431), arm_offset_m=0.0054, track_m=0.1667)


@pytest.mark.parametrize(
    ("figure", "chain", "at_deg", "w2"),
    [
        (3, "as printed", [358.5, 138.0], 0.5857),
        (3, "rigid", [180.0, 348.0], 3.6200),
        (4, "as printed", [12.0, 333.0], 0.5402),
        (4, "rigid", [279.0, 63.0], 0.1990),
        (5, "as printed", [55.5, 100.5], 0.7410),
        (5, "rigid", [337.5, 358.5], 2.1179),
    ],
)
def test_the_best_of_a_figures_grid(figure, chain, at_deg, w2):
    surface = SURFACES[figure]
    peak = find_pair_peak(ARMS[chain], surface)
    assert [peak.theta_deg[k] for k in surface.pair] == at_deg
    assert peak.w2 == pytest.approx(w2, abs=5e-5)
    assert peak.theta_deg[0] == 0.0
    assert peak.theta_deg[surface.third] == pytest.approx(surface.at_deg[surface.third], abs=1e-6)


def test_the_first_angle_of_a_figure_grows_down_the_rows():
    plane = np.degrees(spread_pair(SURFACES[4], 90.0))
    assert plane.shape == (4, 4, 4)
    assert plane[:, 0, 1].tolist() == pytest.approx([0, 90, 180, 270])
    assert plane[0, :, 3].tolist() == pytest.approx([0, 90, 180, 270])
    assert plane[..., 2] == pytest.approx(198.0, abs=1e-5)
    assert not plane[..., 0].any()


@pytest.mark.parametrize(
    ("chain", "theta_deg", "w2"),
    [("as printed", [0.0, 0.760901, 77.620135, 101.422731], 0.847487), ("rigid", [0.0, 180.0, 0.0, 0.0], 3.861484)],
)
def test_grid_and_evolution_agree_on_the_best_of_three_angles(chain, theta_deg, w2):
    arm = ARMS[chain]
    grid, along = find_peak_by_grid(arm)
    for peak in map(choose_half, (grid, find_peak_by_evolution(arm))):
        np.testing.assert_allclose(peak.theta_deg, theta_deg, rtol=0, atol=2e-6)
        assert peak.w2 == pytest.approx(w2, abs=5e-7)
    assert compute_w2(arm, np.radians(mirror_deg(theta_deg))) == pytest.approx(w2, abs=5e-7)
    assert np.abs(compute_slope(arm, np.radians(theta_deg))[1:]).max() < 1e-6
    assert all(curve.max() <= grid.w2 for curve in along.values())


def test_scipys_evolution_finds_it_too():
    arm = ARMS["as printed"]
    bounds = [(0.0, 2.0 * np.pi)] * 3
    found = differential_evolution(
        lambda x: -compute_w2(arm, np.insert(x.T, 0, 0.0, axis=1)), bounds,
        seed=1, vectorized=True, updating="deferred", maxiter=200, tol=0.0,
    )  # fmt: skip
    assert -found.fun == pytest.approx(0.847487, abs=1e-5)


def test_no_optimum_of_the_calibrated_arms_is_a_printed_one():
    for arm in ARMS.values():
        assert all(fall_short(arm, surface) > 0.5 for surface in SURFACES.values())


def test_the_mirror_image_is_as_large_for_any_offset_and_half_a_turn_without_one(rng):
    theta = rng.uniform(-np.pi, np.pi, (500, 4)) * [0, 1, 1, 1]
    for offset in (0.0, 0.1):
        arm = replace(ARMS["as printed"], arm_offset_m=offset)
        values = compute_w2(arm, theta)
        np.testing.assert_allclose(compute_w2(arm, -theta), values, rtol=1e-11)
        half = np.isclose(compute_w2(arm, theta + np.array([0, np.pi, 0, 0])), values, rtol=1e-9)
        assert half.all() == (offset == 0.0)


def test_the_unit_moves_the_optimum_of_w2_and_not_that_of_w1(rng):
    expected = {
        "as printed": ([358.5, 138], [3, 115.5], [12, 205.5]),
        "rigid": ([180, 348], [139.5, 52.5], [139.5, 55.5]),
    }
    for chain, places in expected.items():
        for factor, at_deg in zip((1.0, 10.0, 1000.0), places, strict=True):
            peak = find_pair_peak(scale_arm(ARMS[chain], factor), SURFACES[3])
            assert peak.theta_deg[1:3] == at_deg
    theta = rng.uniform(-np.pi, np.pi, (50, 4))
    arm = ARMS["as printed"]
    np.testing.assert_allclose(compute_w1(scale_arm(arm, 1000.0), theta), compute_w1(arm, theta), rtol=1e-9)


def test_only_the_last_two_links_together_count():
    """Nothing but l3 + l4 enters, so no optimum tells them apart: a `TrackedArm` has three links."""
    assert len(FIGURE_4.links_m) == 3


def test_lengths_that_show_figure_4_exist_and_a_newton_step_says_how_near_a_top_is():
    surface = SURFACES[4]
    assert fall_short(FIGURE_4, surface) < 1e-6
    assert find_pair_peak(FIGURE_4, surface).theta_deg[1::2] == [15.0, 40.5]
    assert newton_step_deg(FIGURE_4, surface) == pytest.approx(0.0017, abs=2e-4)
    top = climb(FIGURE_4, np.radians(surface.at_deg), surface.pair)
    moved = np.linalg.norm(np.degrees(top) - surface.at_deg)
    assert moved == pytest.approx(newton_step_deg(FIGURE_4, surface), rel=1e-2)
    assert newton_step_deg(FIGURE_4, SURFACES[5]) is None  # a saddle


def test_a_climb_ends_where_no_free_angle_helps(rng):
    arm = ARMS["as printed"]
    for start in rng.uniform(0, 2 * np.pi, (8, 4)) * [0, 1, 1, 1]:
        top = climb(arm, start, FREE)
        assert top[0] == 0.0
        assert np.abs(compute_slope(arm, top)[1:]).max() < 1e-5
        assert compute_w2(arm, top) >= compute_w2(arm, start)


def test_angles_are_written_within_a_turn():
    assert wrap_deg(np.radians([-1e-9, 360.0, -90.0, 725.0])) == [0.0, 0.0, 270.0, 5.0]
    assert mirror_deg([0.0, 10.0, 0.0, 350.0]) == [0.0, 350.0, 0.0, 10.0]
