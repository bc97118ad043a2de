"""Surfaces in small patches."""

import numpy as np
import pytest

from ikde.errors import InputError
from ikde.spheres import patches as module
from ikde.spheres.patches import COARSEST, FINEST, halve, make_patches, patch_size, split
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


def test_a_surface_that_takes_too_many_pieces_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MAX_PIECES", 100)
    with pytest.raises(InputError, match="more than 100 pieces of 10 mm; let spheres protrude further"):
        split(box(1, 1, 1), 0.01)


@pytest.mark.parametrize(("area_m2", "share"), [(1e-9, FINEST), (1e3, COARSEST)])
def test_patches_are_neither_too_fine_nor_too_coarse(area_m2: float, share: float) -> None:
    assert patch_size(area_m2, 0.02) == pytest.approx(share * 0.02)
