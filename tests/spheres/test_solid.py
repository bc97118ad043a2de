"""Distances from surfaces, and what is inside."""

import numpy as np
import pytest

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


def test_area_of_a_box() -> None:
    assert Triangles.of(box(1, 2, 3)).areas.sum() == pytest.approx(22.0)
