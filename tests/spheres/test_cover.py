"""The spheres of a link: every shape covered where it stands."""

from pathlib import Path

import numpy as np
import pytest

from ikde.spheres import cover_shapes
from ikde.spheres.cover_mesh import MeshCover
from ikde.spheres.parts import PartCounts
from ikde.spheres.primitives import Rows, cover_box, cover_capsule, cover_cylinder
from ikde.spheres.shapes import Shape

QUARTER = np.array([[0.0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]])


def test_each_shape_gets_its_own_spheres_where_it_stands() -> None:
    shapes = [
        Shape(kind="box", size=(0.3, 0.1, 0.1), T_link_shape=QUARTER),
        Shape(kind="cylinder", size=(0.03, 0.4), T_link_shape=np.eye(4)),
        Shape(kind="capsule", size=(0.02, 0.2), T_link_shape=np.eye(4)),
        Shape(kind="sphere", size=(0.7,), T_link_shape=QUARTER),
    ]
    box, cylinder = cover_box((0.3, 0.1, 0.1), 0.01), cover_cylinder(0.03, 0.4, 0.01)
    capsule = cover_capsule(0.02, 0.2, 0.01)
    turned = np.stack([1 - box.centres[:, 1], 2 + box.centres[:, 0], 3 + box.centres[:, 2]], axis=1)
    cover = cover_shapes(shapes, 0.01)
    np.testing.assert_allclose(
        cover.centres, np.concatenate([turned, cylinder.centres, capsule.centres, [[1, 2, 3]]]), atol=1e-15
    )
    np.testing.assert_array_equal(cover.radii, [*box.radii, *cylinder.radii, *capsule.radii, 0.7])
    assert cover.covered == 1.0
    assert cover.protrusion_m == max(box.protrusion_m, cylinder.protrusion_m, capsule.protrusion_m) <= 0.01


def test_spheres_stand_out_by_two_centimetres_at_most_unless_more_is_asked() -> None:
    shape = Shape(kind="box", size=(0.3, 0.1, 0.1), T_link_shape=np.eye(4))
    assert len(cover_shapes([shape]).radii) == len(cover_box((0.3, 0.1, 0.1), 0.02).radii)


def test_a_mesh_is_covered_where_it_stands_and_counts_by_its_area(monkeypatch) -> None:
    parts = PartCounts(closed=1, hulls=2, sheets=1)
    made = [
        MeshCover(Rows(np.array([[0.1, 0, 0]]), np.array([0.2]), 0.01), 3.0, 1.0, parts, ("large",)),
        MeshCover(Rows(np.zeros((1, 3)), np.array([0.3]), 0.02), 1.0, 0.6, parts, ()),
    ]
    asked = []
    monkeypatch.setattr("ikde.spheres.cover.cover_mesh", lambda *own: (asked.append(own), made[len(asked) - 1])[1])
    mesh = Shape(kind="mesh", size=(), T_link_shape=QUARTER, mesh=Path("a.stl"), scale=(1.0, -1.0, 1.0))
    cover = cover_shapes([mesh, mesh], 0.02)
    assert asked == [(Path("a.stl"), (1.0, -1.0, 1.0), 0.02)] * 2
    np.testing.assert_array_equal(cover.centres, [[1, 2.1, 3], [1, 2, 3]])
    assert (cover.covered, cover.protrusion_m, cover.warnings) == (pytest.approx(0.9), 0.02, ("large",))
    assert cover.how == "fitted to the mesh, hulls of 4 open parts, 2 flat parts"


def test_a_hull_that_is_taken_for_fewer_spheres_is_said(monkeypatch) -> None:
    parts = PartCounts(closed=0, hulls=1, sheets=0)
    made = MeshCover(Rows(np.zeros((1, 3)), np.array([0.3]), 0.02), 1.0, 1.0, parts, (), only_hulls=True)
    monkeypatch.setattr("ikde.spheres.cover.cover_mesh", lambda *own: made)
    mesh = Shape(kind="mesh", size=(), T_link_shape=np.eye(4), mesh=Path("a.stl"))
    assert cover_shapes([mesh], 0.02).how == "fitted to the mesh, hull, for fewer spheres"
