"""Distances from surfaces, and what is inside."""

import numpy as np
import pytest

from ikde.spheres import solid as module
from ikde.spheres.solid import Solid, Triangles
from tests.mesh_bodies import box, make_l, on_surface, solid_of


def test_distances_from_a_box_are_those_of_its_formula() -> None:
    points = np.random.default_rng(1).uniform(-0.5, 1.5, (300, 3))
    away = np.abs(points - 0.5) - 0.5
    outside = np.linalg.norm(np.maximum(away, 0.0), axis=1)
    expected = np.where(outside > 0.0, outside, -away.max(axis=1))
    np.testing.assert_allclose(Triangles.of(box(1, 1, 1)).distances(points), expected, atol=1e-15)


def test_distances_from_an_l_are_those_to_the_nearest_of_many_points() -> None:
    body = make_l()
    samples = on_surface(body, 40_000)
    points = np.random.default_rng(2).uniform(-0.1, 0.3, (40, 3))
    nearest = np.linalg.norm(points[:, None] - samples, axis=2).min(axis=1)
    found = Triangles.of(body).distances(points)
    assert (found <= nearest + 1e-15).all()
    np.testing.assert_allclose(found, nearest, atol=3e-3)


def test_a_triangle_without_area_is_an_edge() -> None:
    line = np.array([[[0.0, 0, 0], [1, 0, 0], [0.5, 0, 0]]])
    assert Triangles.of(line).distances(np.array([[0.5, 2.0, 0.0]])) == pytest.approx([2.0])


@pytest.mark.parametrize(("point", "depth"), [((0.05, 0.05, 0.05), 0.05), ((0.15, 0.15, 0.05), -0.05)])
def test_the_notch_of_an_l_is_outside(point: tuple[float, ...], depth: float) -> None:
    assert solid_of(make_l()).depth(np.array(point)) == pytest.approx(depth)


def test_a_sheet_has_no_inside() -> None:
    sheet = Solid(Triangles.of(box(1, 1, 1)), Triangles.of(np.empty((0, 3, 3))))
    assert sheet.depth(np.array([0.5, 0.5, 0.5])) == pytest.approx(-0.5)


@pytest.mark.parametrize("size", [1.0, 1e-6, 1e4])
@pytest.mark.parametrize("corner", range(3))
def test_distances_from_one_triangle_are_those_of_its_face_edges_and_corners(corner: int, size: float) -> None:
    """A right triangle, from every side: what lies over its face, beside each edge, and at each corner."""
    triangle = Triangles.of(size * np.roll(np.array([[[0.0, 0, 0], [4, 0, 0], [0, 3, 0]]]), corner, axis=1))
    over = [([1, 1, 2], 2), ([1, 1, -2], 2), ([1, 0, 0.5], 0.5), ([0.01, 2.9, 1], 1)]
    beside = [([2, -1, 0], 1), ([-1, 1, 0], 1), ([3.2, 3.1, 0], 2), ([2, -3, 4], 5), ([3.2, 3.1, 1.5], 2.5)]
    at = [([-3, -4, 0], 5), ([7, -4, 0], 5), ([-3, 7, 0], 5), ([7, -4, 12], 13)]
    points, expected = zip(*over, *beside, *at, strict=True)
    np.testing.assert_allclose(triangle.distances(size * np.array(points)), size * np.array(expected), rtol=1e-13)


def test_how_often_a_surface_goes_round_a_point_by_its_solid_angle() -> None:
    """An eighth of the sphere for the triangle between three axes' far ends, and its sign for the side."""
    far = Triangles.of(np.eye(3)[None] * [[[1.0], [5.0], [0.2]]])
    assert far.winding(np.zeros(3)) == pytest.approx(0.125)
    assert Triangles.of(np.eye(3)[None, ::-1]).winding(np.zeros(3)) == pytest.approx(-0.125)
    whole = Triangles.of(np.concatenate([box(1, 1, 1), box(1, 1, 1)]))
    assert whole.windings(np.array([[0.3, 0.6, 0.7], [0.3, 0.6, 1.7]])) == pytest.approx([2.0, 0.0], abs=1e-12)
    assert whole.windings(np.empty((0, 3))).shape == (0,)


def test_windings_in_blocks_are_those_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    body, points = Triangles.of(make_l()), np.random.default_rng(3).uniform(-0.1, 0.3, (50, 3))
    whole = body.windings(points)
    for block in (1, 7 * len(body.corners)):
        monkeypatch.setattr(module, "BLOCK", block)
        np.testing.assert_array_equal(body.windings(points), whole)
    assert [body.winding(point) for point in points] == pytest.approx(whole, abs=1e-15)


@pytest.mark.parametrize(("height", "times", "depth"), [(0.9, 0.59, 0.1), (1.1, 0.41, -0.1)])
def test_inside_is_where_parts_go_round_more_than_half(height: float, times: float, depth: float) -> None:
    """Below and above the open side of a box."""
    half = Solid(Triangles.of(box(1, 1, 1)), Triangles.of(box(1, 1, 1)[:-2]))
    point = np.array([0.5, 0.4, height])
    assert half.parts.winding(point) == pytest.approx(times, abs=0.01)
    assert half.depth(point) == pytest.approx(depth)


def test_some_triangles_are_as_far_as_they_were() -> None:
    body, points = Triangles.of(make_l()), np.random.default_rng(4).uniform(-0.1, 0.3, (9, 3))
    rows = np.array([3, 0, 7])
    some = body.take(rows)
    np.testing.assert_array_equal(some.distances(points), Triangles.of(make_l()[rows]).distances(points))
    np.testing.assert_array_equal(some.areas, body.areas[rows])


def test_area_of_a_box() -> None:
    assert Triangles.of(box(1, 2, 3)).areas.sum() == pytest.approx(22.0)
