"""Dong and Zhao's section as data: lengths, degrees, claims' place, optima, and what found lengths show."""

import json
from dataclasses import replace

import numpy as np
import pytest

import ikde
from ikde.paper.inputs import load_dong_zhao
from ikde.paper.manipulability import LENGTHS, PROVENANCE, read_angles, read_arm, read_surfaces, scale_arm
from ikde.paper.tracked_arm import PRINTED, RIGID
from tests.paper.conftest import is_plain

TRUE_DEG = [114.1275, 40.5, 27.0, 15.0, 198.0, 40.5, 22.5, 198.0, 199.5]


@pytest.fixture(scope="module")
def data(results):
    return results.sections["manipulability"]


def test_it_is_plain_and_every_part_has_its_provenance(data):
    assert is_plain(data)
    exact = data.as_json()["exact"]
    assert set(exact) | {"else"} >= {path.split(".")[0] for path in PROVENANCE}
    for path in PROVENANCE:
        part, _, key = path.partition(".")
        assert not key or all(key in row for row in exact[part]), path
    assert data.settings["provenance"] == PROVENANCE
    assert {row.kind for row in data.lengths} == {"calibrated"}


def test_the_lengths_are_those_of_the_robot_that_ships(data):
    assert [row.name for row in data.lengths] == list(LENGTHS)
    assert [row.value_m for row in data.lengths] == [0.3, 0.25, 0.2, 0.1, 0.4]
    assert all(row.why.startswith(("no length", "l_m is not", "b is not")) for row in data.lengths)
    robot = ikde.load_robot("leobot")
    assert read_arm(robot).chain == RIGID
    assert read_arm(robot, PRINTED).links_m == (0.3, 0.25, 0.2)
    with pytest.raises(ValueError, match="leobot has no wheels"):
        read_arm(replace(robot, wheels=None))


def test_degrees_of_the_optima_are_whole_steps_once_3_14_is_undone(data):
    """Eight of nine to four digits of the radians; as printed none; the ninth is 0.13 deg off."""
    angles = data.angles
    assert [angle.undone_deg for angle in angles] == pytest.approx(TRUE_DEG, abs=5e-3)
    assert [angle.is_whole for angle in angles] == [False] + [True] * 8
    assert [angle.steps for angle in angles] == [76, 27, 18, 10, 132, 27, 15, 132, 133]
    for angle in angles:
        assert angle.radians == pytest.approx(angle.printed_deg * 3.14 / 180, rel=1e-12)
        assert angle.undone_deg == pytest.approx(np.degrees(angle.radians), rel=1e-12)
        assert (abs(angle.radians - angle.steps * np.pi / 120) <= 5e-5) == angle.is_whole
        assert abs(np.radians(angle.off_steps_as_printed_deg)) > 1e-4
    assert angles[0].off_steps_deg == pytest.approx(0.1275, abs=1e-4)
    assert angles[0].radians == pytest.approx(1.9919, abs=5e-8)


def test_a_figures_plane_is_its_pair_and_the_third_angle_stays():
    surfaces = read_surfaces(load_dong_zhao())
    assert [(s.figure, s.pair, s.third) for s in surfaces] == [(3, (1, 2), 3), (4, (1, 3), 2), (5, (2, 3), 1)]
    assert [s.at_deg[0] for s in surfaces] == [0.0, 0.0, 0.0]
    assert surfaces[2].at_deg == pytest.approx((0.0, 22.5, 198.0, 199.5), abs=3e-3)
    assert [angle.figure for angle in read_angles(load_dong_zhao())] == [3, 3, 3, 4, 4, 4, 5, 5, 5]


def test_printed_optima_stand_beside_ours_in_both_readings(data):
    assert [(row.figure, row.chain) for row in data.optima] == [
        (f, c) for f in (3, 4, 5) for c in ("as printed", "rigid")
    ]
    first = data.optima[0]
    assert (first.pair, first.third) == (["theta2", "theta3"], "theta4")
    assert first.printed_deg == [114.18535, 40.52064]
    assert first.undone_deg == pytest.approx([114.1275, 40.5], abs=1e-3)
    assert first.grid_deg == [358.5, 138.0]
    assert np.abs(np.subtract(first.top_deg, first.grid_deg)).max() < 1.5
    assert all(0.5 < row.printed_below < 1.0 for row in data.optima)


def test_no_third_angle_peaks_where_the_text_has_it(data):
    printed = {"theta4": 27.0, "theta3": 198.0, "theta2": 22.5}
    assert {row.third: pytest.approx(row.third_deg, abs=1e-4) for row in data.optima} == printed
    for space in data.space:
        for name, at_deg in printed.items():
            assert all(min(abs(place - at_deg), 360 - abs(place - at_deg)) > 9 for place in space.largest_at_deg[name])
            assert max(space.along[name]) <= space.grid.w2
            assert len(space.along[name]) == 80


def test_both_searches_agree_and_the_mirror_image_is_as_good(data):
    for space in data.space:
        np.testing.assert_allclose(space.grid.theta_deg, space.evolution.theta_deg, rtol=0, atol=2e-6)
        assert space.mirror_w2 == pytest.approx(space.grid.w2, rel=1e-9)


def test_units_are_those_of_the_same_arm(data):
    assert [(row.chain, row.unit) for row in data.units] == [
        (chain, unit) for chain in ("as printed", "rigid") for unit in ("m", "dm", "mm")
    ]
    assert data.units[2].grid_deg == [12.0, 205.5]
    scaled = scale_arm(read_arm(ikde.load_robot("leobot")), 10.0)
    assert (*scaled.links_m, scaled.arm_offset_m, scaled.track_m) == (3.0, 2.5, 2.0, 1.0, 4.0)


def test_found_lengths_lie_in_their_range_and_show_what_they_were_sought_for(data):
    ranges = data.settings["ranges_m"]
    cases = [(row.chain, row.range, sum(figure.is_sought for figure in row.figures)) for row in data.found]
    for chain in ("as printed", "rigid"):
        for name in ranges:
            assert cases.count((chain, name, 1)) == 3
            assert cases.count((chain, name, 3)) == 1
    for row in data.found:
        low, high = (np.array(ranges[row.range][end]) for end in ("low", "high"))
        assert (row.lengths_m >= low).all()
        assert (row.lengths_m <= high).all()


def test_single_optima_can_be_had_and_all_three_were_not_found(data):
    """A search's findings: what is recorded is computed again here, what was not found is no proof."""

    def worst(chain, name, figures):
        return {
            tuple(f.figure for f in row.figures if f.is_sought): max(f.below for f in row.figures if f.is_sought)
            for row in data.found
            if (row.chain, row.range) == (chain, name)
        }[figures]

    assert worst("as printed", "wide", (4,)) < 1e-6
    assert worst("as printed", "believable", (4,)) < 1e-6
    for figure in (3, 4, 5):
        assert worst("as printed", "wide", (figure,)) < 0.005
        assert worst("rigid", "wide", (figure,)) < 0.005
        assert worst("rigid", "believable", (figure,)) > 0.05
    assert 0.15 < worst("as printed", "wide", (3, 4, 5)) < 0.20
    for case in (("as printed", "believable"), ("rigid", "wide"), ("rigid", "believable")):
        assert worst(*case, (3, 4, 5)) > 0.35


def test_the_record_is_small(data):
    assert len(json.dumps(data.as_json())) < 50_000
