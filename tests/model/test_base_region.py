"""Base regions: polygons with holes, and what makes none."""

import pickle

import numpy as np
import pytest

from ikde.errors import InputError
from ikde.model.base_region import BaseRegion, is_inside, measure_edges, read_base_region

SQUARE = [(0, 0), (4, 0), (4, 4), (0, 4)]
ELL = [(0, 0), (4, 0), (4, 1), (1, 1), (1, 4), (0, 4)]
HOLE = [(1, 1), (2, 1), (2, 3), (1, 3)]


def test_a_base_region_is_a_value_in_a_line():
    region = BaseRegion(SQUARE, [HOLE])
    again = pickle.loads(pickle.dumps(region))
    assert again == region == BaseRegion(np.array(SQUARE, dtype=float), (HOLE,))
    assert hash(again) == hash(region)
    assert region != BaseRegion(SQUARE)
    assert repr(region) == "<BaseRegion: 4 corners, 1 hole, x 0 to 4 m, y 0 to 4 m>"
    assert read_base_region(SQUARE) == BaseRegion(SQUARE)
    assert read_base_region(region) is region
    with pytest.raises(ValueError, match="read-only"):
        region.corners[0, 0] = 1.0


@pytest.mark.parametrize("way", [1, -1], ids=["left", "right"])
def test_what_is_inside_is_in_no_hole(way):
    region = BaseRegion(SQUARE[::way], [HOLE[::way]])
    points = np.array([(0.5, 0.5), (1.5, 2.0), (3.0, 3.0), (5.0, 1.0), (-1.0, 2.0), (1.5, 3.5)])
    assert region.contains(points).tolist() == [True, False, True, False, False, True]


def test_an_ell_is_its_two_boxes(rng):
    points = rng.uniform(-1, 5, (2000, 2))
    x, y = points.T
    expected = ((x > 0) & (x < 4) & (y > 0) & (y < 1)) | ((x > 0) & (x < 1) & (y > 0) & (y < 4))
    assert np.array_equal(is_inside(np.array(ELL, dtype=float), points), expected)


def test_distances_are_from_the_nearest_edge():
    region = BaseRegion(SQUARE, [HOLE])
    points = np.array([(0.5, 0.6), (3.0, 2.0), (5.0, 5.0)])
    assert region.edge_distances_m(points) == pytest.approx([0.5, 1.0, np.sqrt(2)])
    assert measure_edges(np.array(SQUARE, dtype=float), points)[1] == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("corners", "holes", "said"),
    [
        (SQUARE[:2], (), "corners: expected at least 3 corners x, y, up to 1,000, got 2 of them"),
        ([], (), "corners: expected at least 3 corners"),
        (np.zeros((4, 3)), (), r"corners: expected at least 3 corners x, y, up to 1,000, got shape \(4, 3\)"),
        ([(0, 0), (1, 0), (np.nan, 1)], (), "corners: expected finite numbers"),
        ([(0, 0), (4, 4), (4, 0), (0, 4)], (), "corners: the polygon crosses or touches itself: .*edges 0 and 2"),
        ([(0, 0), (4, 0), (4, 4), (2, 0), (0, 4)], (), "corners: the polygon crosses or touches itself"),
        ([(0, 0), (1, 0), (2, 0)], (), "corners: the polygon crosses or touches itself|zero area"),
        ([(0, 0), (4, 0), (2, 0), (2, 3)], (), "corners: the polygon crosses or touches itself"),
        ([(0, 0), (1, 1e-13), (2, 0)], (), "corners: .*zero area"),
        ([(0, 0), (0, 0), (1, 1), (0, 1)], (), "corners: corner 0 stands where the next one does"),
        (SQUARE, [[(3, 3), (5, 3), (3, 5)]], r"holes\[0\]: expected a hole that is inside the polygon"),
        (SQUARE, [[(9, 9), (10, 9), (9, 10)]], r"holes\[0\]: expected a hole that is inside the polygon"),
        (SQUARE, [[(0, 1), (1, 1), (1, 2)]], r"holes\[0\]: expected a hole that is inside the polygon"),
        (SQUARE, [HOLE, [(1.5, 2), (3, 2), (3, 2.5)]], r"holes\[1\]: expected holes apart from each other"),
        (SQUARE, [HOLE, [(1.2, 1.2), (1.8, 1.2), (1.5, 1.5)]], r"holes\[1\]: expected holes apart"),
        (SQUARE, [HOLE[:2]], r"holes\[0\]: expected at least 3 corners"),
    ],
)
def test_what_makes_no_base_region_is_refused(corners, holes, said):
    with pytest.raises(InputError, match=said):
        BaseRegion(corners, holes)


def test_a_wrong_argument_is_named():
    with pytest.raises(InputError, match="base_region: expected at least 3 corners"):
        read_base_region(SQUARE[:2])
    with pytest.raises(InputError, match="base_region: expected numbers"):
        read_base_region("here")
