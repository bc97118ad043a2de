"""What of overlapping parts is the surface of one body."""

import tracemalloc

import numpy as np
import pytest

from ikde.kernels.arrays import Floats
from ikde.spheres import union
from ikde.spheres.patches import halve
from ikde.spheres.solid import Triangles
from ikde.spheres.union import outer_triangles
from tests.mesh_bodies import box, make_l, on_surface

CUBE = box(0.1, 0.1, 0.1)


def area(triangles: Floats) -> float:
    return float(Triangles.of(triangles).areas.sum())


def test_parts_apart_stay_as_they_are() -> None:
    parts = [CUBE, CUBE + 1.0]
    for left, part in zip(outer_triangles(parts), parts, strict=True):
        np.testing.assert_array_equal(left, part)


@pytest.mark.parametrize("outer", [CUBE, make_l()])
def test_a_part_inside_another_vanishes(outer: Floats) -> None:
    left = outer_triangles([outer, 0.5 * CUBE + 0.02])
    assert len(left[1]) == 0
    np.testing.assert_array_equal(left[0], outer)


def test_a_part_inside_two_others_vanishes_once() -> None:
    left = outer_triangles([CUBE, box(0.12, 0.12, 0.12) - 0.005, 0.5 * CUBE + 0.02])
    assert len(left[2]) == 0


def test_two_that_are_the_same_both_stay() -> None:
    assert [len(left) for left in outer_triangles([CUBE, CUBE])] == [12, 12]


@pytest.mark.parametrize("outer", [CUBE, make_l()])
def test_all_that_lies_outside_the_other_part_is_kept(outer: Floats) -> None:
    beam = box(0.4, 0.03, 0.03) - (0.2, -0.03, -0.03)
    left = outer_triangles([outer, beam])
    points = on_surface(beam, 4000)
    solid = Triangles.of(outer)
    outside = np.array([solid.winding(point) < 0.5 for point in points])
    assert Triangles.of(left[1]).distances(points[outside]).max() < 1e-12
    assert area(left[1]) < 0.95 * area(beam)
    assert area(left[1]) == pytest.approx(area(beam) * outside.mean(), rel=0.1)


@pytest.mark.parametrize("outer", [CUBE, make_l()])
def test_many_faces_take_no_more_memory_than_some_at_a_time(outer: Floats, monkeypatch: pytest.MonkeyPatch) -> None:
    """A printed gripper of 28,000 triangles took 17 GB at once."""
    parts = [outer, box(0.4, 0.03, 0.03) - (0.2, -0.03, -0.03)]
    whole = outer_triangles(parts)
    monkeypatch.setattr(union, "BLOCK", 50)
    for left, same in zip(outer_triangles(parts), whole, strict=True):
        np.testing.assert_array_equal(left, same)


@pytest.mark.parametrize("outer", [make_l(), make_l() + 0.013])
def test_triangles_that_are_chosen_by_their_balls_give_the_same(outer: Floats, monkeypatch: pytest.MonkeyPatch) -> None:
    parts = [outer, box(0.4, 0.03, 0.03) - (0.2, -0.03, -0.03)]
    whole = outer_triangles(parts)
    monkeypatch.setattr(union, "MANY", 1)
    for left, same in zip(outer_triangles(parts), whole, strict=True):
        np.testing.assert_array_equal(left, same)


def test_a_mesh_of_many_triangles_fits_into_memory() -> None:
    """6,000 triangles: 0.9 GB, were all corners held against all faces at once."""
    fine = CUBE
    for _ in range(9):
        edges = ((np.roll(fine, -1, axis=1) - fine) ** 2).sum(axis=2)
        fine = halve(fine, edges.argmax(axis=1))
    assert len(fine) > 6_000
    tracemalloc.start()
    left = outer_triangles([fine, 0.5 * CUBE + 0.02])
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert len(left[1]) == 0
    assert peak < 3e8
