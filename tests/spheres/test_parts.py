"""Solids out of triangles as files hold them."""

import numpy as np

from ikde.spheres.parts import connect, is_closed, make_solid, merge_corners, turn_outwards
from ikde.spheres.solid import Triangles
from tests.mesh_bodies import FACES, box, make_l


def no_hull(points: np.ndarray) -> None:
    raise AssertionError("no hull is needed")


def volume(triangles: np.ndarray) -> float:
    return float(np.linalg.det(triangles).sum() / 6.0)


def test_a_box_is_closed_and_its_corners_are_merged() -> None:
    corners, faces = merge_corners(box(1, 2, 3) + 1e-9)
    assert (corners.shape, faces.shape) == ((8, 3), (12, 3))
    solid, counts = make_solid(box(1, 2, 3), no_hull)
    assert (counts.closed, counts.hulls, counts.sheets) == (1, 0, 0)
    assert volume(solid.surface.corners) == volume(solid.parts.corners) == 6.0


def test_a_body_inside_out_is_turned() -> None:
    assert volume(turn_outwards(make_l()[:, ::-1])) > 0.0
    solid, _ = make_solid(make_l()[:, ::-1], no_hull)
    assert volume(solid.surface.corners) > 0.0


def test_of_an_open_box_the_hull_is_taken() -> None:
    asked = []
    solid, counts = make_solid(box(1, 1, 1)[:-2], lambda points: (asked.append(points), box(1, 1, 1))[1])
    assert len(asked[0]) == 8
    assert (counts.closed, counts.hulls, len(solid.surface.corners)) == (0, 1, 12)
    assert len(solid.parts.corners) == 12


def test_a_flat_part_stays_without_an_inside() -> None:
    both = np.concatenate([box(1, 1, 1), box(1, 1, 1)[-2:] + 5.0])
    solid, counts = make_solid(both, lambda points: None)
    assert (counts.closed, counts.sheets) == (1, 1)
    assert (len(solid.surface.corners), len(solid.parts.corners)) == (14, 12)


def test_parts_are_counted_in_the_order_of_their_first_faces() -> None:
    assert connect(np.array([[5, 6, 7], [0, 1, 2], [7, 8, 9], [2, 3, 4]])).tolist() == [0, 1, 0, 1]


def test_a_face_turned_the_wrong_way_leaves_a_body_open() -> None:
    assert is_closed(FACES)
    wrong = FACES.copy()
    wrong[0] = wrong[0][::-1]
    assert not is_closed(wrong)


def test_faces_without_an_area_are_dropped() -> None:
    line = np.array([[[0.0, 0, 0], [0, 0, 0], [1, 1, 1]]])
    _, counts = make_solid(np.concatenate([box(1, 1, 1), line]), no_hull)
    assert counts.closed == 1


def test_where_parts_overlap_the_depth_is_that_of_the_union() -> None:
    """A point beside a face that lies inside the other part: the distance to that face says nothing."""
    both = np.concatenate([box(0.2, 0.05, 0.05), box(0.05, 0.2, 0.05) + np.array([0.002, 0.001, 0.003])])
    solid, _ = make_solid(both, no_hull)
    point = np.array([0.05, 0.025, 0.026])
    assert Triangles.of(both).distances(point[None])[0] < 0.003
    assert 0.015 < solid.depth(point) <= 0.025


def test_of_every_part_the_hull_is_taken_if_asked() -> None:
    _, counts = make_solid(np.concatenate([make_l(), make_l() + 1.0]), lambda points: box(1, 1, 1), only_hulls=True)
    assert (counts.closed, counts.hulls) == (0, 2)
