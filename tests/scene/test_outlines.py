"""Outlines: the convex hull of points in a plane."""

import numpy as np
import pytest

from ikde.scene.outlines import find_outline


def test_it_holds_all_points_and_its_corners_are_some_of_them(rng):
    for count in (3, 5, 40, 200):
        points = rng.normal(size=(count, 2))
        corners = find_outline(points)
        assert {tuple(corner) for corner in corners} <= {tuple(point) for point in points}
        edges = np.roll(corners, -1, axis=0) - corners
        across = edges[:, None, 0] * (points - corners[:, None])[..., 1]
        across -= edges[:, None, 1] * (points - corners[:, None])[..., 0]
        assert (across >= -1e-12).all()  # to the left of every edge, so it runs anticlockwise
        assert (across.max(axis=1) > 0.0).all()


def test_points_on_an_edge_and_twice_the_same_are_no_corners():
    square = [[0, 0], [2, 0], [2, 2], [0, 2]]
    assert find_outline(np.array([*square, [1, 0], [2, 1], [0, 0], [1, 1]])).tolist() == square


@pytest.mark.parametrize("points", [np.empty((0, 2)), [[1, 2]], [[1, 2], [1, 2]], [[0, 0], [1, 1], [2, 2]]])
def test_without_an_area_there_are_two_corners_at_most(points):
    assert len(find_outline(np.array(points, dtype=float))) < 3
