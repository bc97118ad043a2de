"""Where spheres may stand, and what they cover there."""

import numpy as np
import pytest

from ikde.spheres.candidates import _Around, _neighbours, find_candidates, grid_inside
from ikde.spheres.patches import make_patches
from ikde.spheres.solid import Solid, Triangles
from tests.mesh_bodies import box, make_l, solid_of


def test_points_of_the_grid_lie_inside_and_fill_it() -> None:
    solid = solid_of(make_l())
    points = grid_inside(solid, 0.02, 10**6)
    assert min(solid.depth(point) for point in points[::7]) > 0.0
    assert not ((points[:, 0] > 0.1) & (points[:, 1] > 0.1)).any()
    assert 0.9 < len(points) * 0.006**3 / 0.003 < 1.1


def test_no_more_points_than_allowed() -> None:
    assert len(grid_inside(solid_of(box(1, 1, 1)), 0.02, 1000)) <= 1000


def test_a_sheet_has_no_points_inside() -> None:
    sheet = Solid(Triangles.of(box(1, 1, 1)), Triangles.of(np.empty((0, 3, 3))))
    assert grid_inside(sheet, 0.02, 1000).shape == (0, 3)


def test_each_sphere_is_as_large_as_its_depth_allows_and_names_the_patches_inside_it() -> None:
    solid = solid_of(make_l())
    patches = make_patches(solid.surface.corners, 0.01)
    candidates = find_candidates(solid, patches, 0.02, 300)
    count = len(grid_inside(solid, 0.02, 300))
    depths = np.array([solid.depth(point) for point in candidates.centres[:count]])
    np.testing.assert_allclose(candidates.radii[:count], depths + 0.02, atol=2e-9)
    assert (candidates.radii[count:] <= 0.02).all()
    for index in range(0, len(candidates.radii), 17):
        inside = patches.reach(candidates.centres[index][None])[0] <= candidates.radii[index]
        np.testing.assert_array_equal(np.flatnonzero(inside), np.sort(candidates.covers[index]))


def test_every_line_of_the_grid_counts_the_faces_over_it() -> None:
    """Two boxes one in the other: inside both is inside, and so is all of the outer one; turned inside out is not."""
    outer, inner = box(0.2, 0.2, 0.2), box(0.1, 0.1, 0.1) + 0.051
    whole = grid_inside(solid_of(outer), 0.02, 10**6)
    np.testing.assert_array_equal(grid_inside(solid_of(np.concatenate([outer, inner])), 0.02, 10**6), whole)
    hollow = grid_inside(solid_of(np.concatenate([outer, inner[:, ::-1]])), 0.02, 10**6)
    is_inner = ((hollow > 0.051) & (hollow < 0.151)).all(axis=1)
    assert not is_inner.any()
    assert len(hollow) == len(whole) - ((whole > 0.051) & (whole < 0.151)).all(axis=1).sum()
    assert not len(grid_inside(solid_of(outer[:, ::-1]), 0.02, 10**6))


def test_the_grid_is_as_fine_as_the_protrusion_asks_unless_that_makes_too_many() -> None:
    solid = solid_of(box(0.12, 0.06, 0.03))
    assert len(grid_inside(solid, 0.02, 10**6)) == 20 * 10 * 5
    assert len(grid_inside(solid, 0.02, 27)) == 6 * 3 * 2
    x = np.unique(grid_inside(solid, 0.02, 10**6)[:, 0])
    np.testing.assert_allclose(np.diff(x), 0.006)
    assert x[0] == pytest.approx(0.4981 * 0.006)


def test_near_points_stand_in_one_block_each_once() -> None:
    points = np.random.default_rng(2).uniform(-0.05, 0.05, (500, 3))
    blocks = list(_neighbours(points, 0.03))
    assert sorted(np.concatenate(blocks).tolist()) == list(range(500))
    assert max(map(len, blocks)) <= 64
    assert max(np.ptp(points[block], axis=0).max() for block in blocks) <= 0.03
    many = list(_neighbours(np.zeros((200, 3)), 0.03))
    assert [len(block) for block in many] == [50] * 4


def test_no_triangle_that_is_nearest_and_no_patch_that_is_covered_is_missed() -> None:
    """For blocks of points inside, outside and on the surface."""
    solid = solid_of(make_l())
    patches, draw = make_patches(solid.surface.corners, 0.015), np.random.default_rng(6)
    for spread in (0.0, 0.005, 0.05):
        for middle in ([0.05, 0.05, 0.05], [0.15, 0.15, 0.05], [0.2, 0.0, 0.1]):
            block = middle + spread * draw.uniform(-1.0, 1.0, (6, 3))
            around = _Around(patches, block)
            some = solid.surface.take(around.find_triangles())
            np.testing.assert_array_equal(some.distances(block), solid.surface.distances(block))
            radii = solid.surface.distances(block) + 0.02
            held = np.flatnonzero((patches.reach(block) <= radii[:, None]).any(axis=0))
            assert set(held) <= set(around.find_patches(0.02))


def test_what_is_looked_at_around_points_reaches_just_as_far_as_the_nearest_of_one_may_be() -> None:
    """Two points 10 mm above and below a middle; what is nearest to the upper one is 29 mm from there."""
    small = 1e-5 * np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    heights = np.array([-0.01, 0.029, 0.034, 0.045])
    surface = Triangles.of(np.stack([small + np.array([0.3, 0.2, height]) for height in heights]))
    patches = make_patches(surface.corners, 0.004)
    block = np.array([[0.3, 0.2, height] for height in (0.01, 0.0, -0.01)])
    around = _Around(patches, block)
    assert around.find_triangles().tolist() == [0, 1]
    assert surface.distances(block[:1]) == pytest.approx([0.019], abs=1e-5)
    assert {patches.triangles[k][0] for k in around.find_patches(0.0)} == {0, 1}
    assert {patches.triangles[k][0] for k in around.find_patches(0.01)} == {0, 1, 2}
