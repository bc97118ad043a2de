"""Where spheres may stand, and what they cover there."""

import numpy as np

from ikde.spheres.candidates import find_candidates, grid_inside
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
