"""What is proved of spheres that are there already."""

import numpy as np
import pytest

from ikde.spheres import measure as module
from ikde.spheres.measure import Measured, measure_spheres
from ikde.spheres.primitives import cover_box
from ikde.spheres.shapes import Shape

BOX = Shape(kind="box", size=(0.1, 0.04, 0.04), T_link_shape=np.eye(4))
CYLINDER = Shape(kind="cylinder", size=(0.1, 0.04), T_link_shape=np.eye(4))


def test_a_box_in_its_own_spheres_is_covered_although_they_go_through_its_corners() -> None:
    rows = cover_box((0.1, 0.04, 0.04), 0.01)
    measured = measure_spheres([BOX], rows.centres, rows.radii)
    assert (measured.covered, measured.of_hulls) == (1.0, False)
    assert measured.protrusion_m == pytest.approx(rows.protrusion_m)


def test_without_one_sphere_less_is_proved() -> None:
    rows = cover_box((0.1, 0.04, 0.04), 0.01)
    measured = measure_spheres([BOX], rows.centres[1:], rows.radii[1:])
    assert measured.covered is not None
    assert 0.3 < measured.covered < 0.95


def test_a_sphere_outside_stands_out_by_all_of_it() -> None:
    measured = measure_spheres([BOX], np.array([[0.0, 0.0, 0.05]]), np.array([0.01]))
    assert measured.protrusion_m == pytest.approx(0.04)
    assert measured.covered == 0.0


def test_shapes_that_overlap_are_one_body() -> None:
    turned = Shape(kind="box", size=(0.04, 0.1, 0.04), T_link_shape=np.eye(4))
    one, two = cover_box((0.1, 0.04, 0.04), 0.01), cover_box((0.04, 0.1, 0.04), 0.01)
    centres, radii = np.concatenate([one.centres, two.centres]), np.concatenate([one.radii, two.radii])
    measured = measure_spheres([BOX, turned], centres, radii)
    assert measured.covered == 1.0


@pytest.mark.parametrize("shapes", [[], [CYLINDER], [BOX, CYLINDER]])
def test_nothing_is_said_of_round_shapes_and_of_none(shapes: list[Shape]) -> None:
    measured = measure_spheres(shapes, np.zeros((1, 3)), np.ones(1))
    assert (measured.covered, measured.protrusion_m) == (None, None)


@pytest.mark.parametrize(("own", "hulls"), [(0.7, 1.0), (0.7, 0.7), (1.0, 1.0)])
def test_hulls_are_measured_where_more_of_them_is_covered(monkeypatch, own: float, hulls: float) -> None:
    def answer(triangles, centres, radii, *, only_hulls: bool) -> Measured:
        return Measured(covered=hulls if only_hulls else own, protrusion_m=0.0, of_hulls=only_hulls)

    monkeypatch.setattr(module, "_measure", answer)
    measured = measure_spheres([BOX], np.zeros((1, 3)), np.ones(1))
    assert (measured.covered, measured.of_hulls) == (max(own, hulls), hulls > own)
