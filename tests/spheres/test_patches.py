"""Surfaces in small patches."""

import numpy as np
import pytest

from ikde.errors import InputError
from ikde.spheres import patches as module
from ikde.spheres.patches import COARSEST, FINEST, PATCHES, Patches, halve, make_patches, patch_size, split
from tests.mesh_bodies import box, make_l, on_surface


def area(triangles: np.ndarray) -> float:
    sides = triangles[:, 1:] - triangles[:, :1]
    return 0.5 * float(np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1).sum())


def test_every_point_of_a_surface_lies_in_a_patch_that_names_its_triangles() -> None:
    body = make_l()
    patches = make_patches(body, 0.02)
    points = on_surface(body, 2_000)
    beyond = (np.abs(points[:, None] - patches.centres) - patches.halves).max(axis=2)
    assert (beyond.min(axis=1) <= 1e-12).all()
    assert set(np.concatenate(patches.triangles)) == set(range(len(body)))
    assert (patches.halves <= 0.02).all()


def test_a_sphere_as_large_as_the_reach_holds_all_corners_of_the_box_and_no_smaller_one_does() -> None:
    patches = make_patches(box(0.1, 0.2, 0.3), 0.05)
    point = np.array([[0.4, -0.1, 0.1]])
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    corners = patches.centres[:, None] + signs * patches.halves[:, None]
    away = np.linalg.norm(corners - point[0], axis=2)
    np.testing.assert_allclose(patches.reach(point)[0], away.max(axis=1), rtol=1e-14)
    assert (patches.gap(point[0]) <= away.min(axis=1) + 1e-15).all()
    assert patches.gap(patches.centres[3])[3] == 0.0


def test_pieces_are_small_and_make_up_the_surface() -> None:
    pieces, source = split(box(0.1, 0.2, 0.3), 0.05)
    edges = np.linalg.norm(np.roll(pieces, -1, axis=1) - pieces, axis=2)
    assert edges.max() <= 0.05
    assert area(pieces) == pytest.approx(area(box(0.1, 0.2, 0.3)))
    assert area(pieces[source == 4]) == pytest.approx(area(box(0.1, 0.2, 0.3)[4:5]))


def test_a_triangle_is_cut_at_the_edge_asked_for() -> None:
    triangle = np.array([[[0.0, 0, 0], [2, 0, 0], [0, 2, 0]]])
    np.testing.assert_array_equal(
        halve(triangle, np.array([1])), [[[2, 0, 0], [1, 1, 0], [0, 0, 0]], [[1, 1, 0], [0, 2, 0], [0, 0, 0]]]
    )


@pytest.mark.parametrize("edge", range(3))
def test_the_halves_of_a_triangle_are_its_two_sides_of_a_middle(edge: int) -> None:
    """They share the cut, keep the turn of the triangle, and each has half of the area."""
    draw = np.random.default_rng(edge)
    triangles = draw.random((5, 3, 3))
    halves = halve(triangles, np.full(5, edge))
    middles = 0.5 * (triangles[:, edge] + triangles[:, (edge + 1) % 3])
    for triangle, middle, (one, other) in zip(triangles, middles, halves.reshape(5, 2, 3, 3), strict=True):
        a, b, c = np.roll(triangle, -edge, axis=0)
        np.testing.assert_array_equal(one, [a, middle, c])
        np.testing.assert_array_equal(other, [middle, b, c])
        for half in (one, other):
            normal, whole = (np.cross(own[1] - own[0], own[2] - own[0]) for own in (half, triangle))
            np.testing.assert_allclose(normal, 0.5 * whole, rtol=1e-12)


def test_a_patch_is_the_box_of_the_pieces_in_one_cell() -> None:
    corners = np.array([[[0.001, 0.002, 0.003], [0.009, 0.002, 0.003], [0.001, 0.007, 0.003]]])
    corners = np.concatenate([corners + shift for shift in np.array([[0, 0, 0], [0, 0, 0.004], [0.01, 0, 0]])])
    patches = make_patches(corners, 0.01)
    order = np.argsort(patches.centres[:, 0])
    np.testing.assert_allclose(patches.centres[order], [[0.005, 0.0045, 0.005], [0.015, 0.0045, 0.003]], atol=1e-15)
    np.testing.assert_allclose(patches.halves[order], [[0.004, 0.0025, 0.002], [0.004, 0.0025, 0.0]], atol=1e-13)
    assert (patches.halves > [0.004 - 1e-16, 0.0025 - 1e-16, 0.0]).all()  # by the rounding of the middle
    assert [patches.triangles[k].tolist() for k in order] == [[0, 1], [2]]


def test_a_gap_is_to_the_nearest_side_edge_or_corner() -> None:
    patches = Patches(np.zeros((1, 3)), np.array([[1.0, 2.0, 3.0]]), [np.zeros(1, dtype=np.int64)])
    gaps = [patches.gap(np.array(point, dtype=float))[0] for point in ((3, 0, 0), (0, 5, 7), (-3, 3, -5), (0, 1, 0))]
    assert gaps == pytest.approx([2.0, 5.0, 3.0, 0.0])
    assert patches.reach(np.array([[2.0, 4.0, -3.0]]))[0] == pytest.approx([9.0])


def test_patches_grow_with_the_surface_in_between() -> None:
    assert patch_size(PATCHES * 0.004**2, 0.02) == pytest.approx(0.004)


def test_a_surface_that_takes_too_many_pieces_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MAX_PIECES", 100)
    with pytest.raises(InputError, match="more than 100 pieces of 10 mm; let spheres protrude further"):
        split(box(1, 1, 1), 0.01)


@pytest.mark.parametrize(("area_m2", "share"), [(1e-9, FINEST), (1e3, COARSEST)])
def test_patches_are_neither_too_fine_nor_too_coarse(area_m2: float, share: float) -> None:
    assert patch_size(area_m2, 0.02) == pytest.approx(share * 0.02)
