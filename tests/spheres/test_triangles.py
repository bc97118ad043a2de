"""Shapes as triangles."""

import numpy as np
import pytest

from ikde.spheres.shapes import Shape
from ikde.spheres.triangles import FACETS, shape_triangles
from tests.mesh_bodies import box, write_stl

TURNED = np.array([[0.0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]])


def make(kind: str, *size: float) -> Shape:
    return Shape(kind=kind, size=size, T_link_shape=TURNED)


def volume(triangles: np.ndarray) -> float:
    about = triangles - triangles.reshape(-1, 3).mean(axis=0)
    return float(np.linalg.det(about).sum() / 6.0)


def test_a_box_is_exact_and_stands_where_it_is() -> None:
    triangles = shape_triangles(make("box", 0.1, 0.2, 0.4))
    assert volume(triangles) == pytest.approx(0.008)
    np.testing.assert_allclose(triangles.min(axis=(0, 1)), [0.9, 1.95, 2.8])
    np.testing.assert_allclose(triangles.max(axis=(0, 1)), [1.1, 2.05, 3.2])


@pytest.mark.parametrize(
    ("shape", "whole", "height"),
    [
        (make("cylinder", 0.1, 0.4), 0.004 * np.pi, 0.4),
        (make("capsule", 0.1, 0.4), (0.004 + 0.004 / 3.0) * np.pi, 0.6),
        (make("sphere", 0.1), 0.004 / 3.0 * np.pi, 0.2),
    ],
)
def test_round_shapes_have_facets_inside_them(shape: Shape, whole: float, height: float) -> None:
    triangles = shape_triangles(shape)
    assert whole * (1.0 - 20.0 / FACETS**2) < volume(triangles) < whole
    assert np.ptp(triangles[..., 2]) == pytest.approx(height)
    assert np.hypot(*(triangles[..., :2] - [1.0, 2.0]).reshape(-1, 2).T).max() == pytest.approx(0.1, rel=1e-2)


def test_a_mesh_is_scaled_and_placed(tmp_path) -> None:
    pytest.importorskip("trimesh")
    path = write_stl(tmp_path / "box.stl", box(0.1, 0.1, 0.1))
    shape = Shape(kind="mesh", size=(), T_link_shape=TURNED, mesh=path, scale=(2.0, 1.0, -1.0))
    triangles = shape_triangles(shape)
    assert volume(triangles) == pytest.approx(0.002)
    np.testing.assert_allclose(triangles.min(axis=(0, 1)), [0.9, 2.0, 2.9], atol=1e-8)
