"""Convex hulls: closed, convex, outwards, the same once more, whichever way points lie in planes."""

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from ikde.errors import InputError
from ikde.model.hull import make_hull, measure_normals

GRID = np.stack(np.meshgrid(*[np.arange(4.0)] * 3), axis=-1).reshape(-1, 3)


def volume(corners, triangles):
    a, b, c = (corners[triangles[:, k]] for k in range(3))
    return np.einsum("fi,fi->", a, np.cross(b, c)) / 6.0


def check(points):
    corners, triangles = make_hull(points)
    heights = ((points[:, None] - corners[triangles[:, 0]]) * measure_normals(corners, triangles)).sum(axis=-1)
    assert heights.max() < 1e-15 * max(np.abs(points).max(), 1.0) * 10, "a point is outside"
    assert len(triangles) == 2 * len(corners) - 4, "not closed"
    assert volume(corners, triangles) == pytest.approx(ConvexHull(points).volume, rel=1e-9)
    again = make_hull(corners)
    assert np.array_equal(again[0], corners)
    assert np.array_equal(again[1], triangles)
    return corners, triangles


def test_a_box_has_its_eight_corners():
    corners, triangles = check(GRID)
    assert len(corners) == 8
    assert set(map(tuple, corners)) == {(x, y, z) for x in (0, 3) for y in (0, 3) for z in (0, 3)}
    assert len(triangles) == 12


@pytest.mark.parametrize("seed", range(30))
def test_hulls_of_few_points_on_a_grid(seed):
    rng = np.random.default_rng(seed)
    points = 0.1 * rng.integers(0, 4, (rng.integers(5, 30), 3))
    try:
        check(points)
    except InputError:
        assert np.linalg.matrix_rank(points - points[0], tol=1e-9) < 3


def test_hulls_of_points_that_are_nearly_in_planes():
    R = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    check(GRID @ R)
    check((GRID @ R).astype(np.float32).astype(float))
    check(np.concatenate([GRID, GRID + 1e-9]))
    check(np.random.default_rng(2).normal(size=(3000, 3)))


def test_corners_keep_their_order():
    corners, _ = make_hull(np.array([[0, 0, 0], [0.2, 0.2, 0.2], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]]))
    assert np.array_equal(corners, [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])


@pytest.mark.parametrize("points", [GRID[:1], GRID[:4], GRID * [1, 1, 0], GRID[:, [0, 1, 0]]])
def test_points_in_a_plane_have_none(points):
    with pytest.raises(InputError, match="enclose a volume"):
        make_hull(points)


def test_a_round_hull_has_too_many_triangles():
    points = np.random.default_rng(3).normal(size=(1500, 3))
    with pytest.raises(InputError, match=r"at most 2,000 triangles, got more"):
        make_hull(points / np.linalg.norm(points, axis=1, keepdims=True))
