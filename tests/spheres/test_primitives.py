"""Spheres of boxes, cylinders and capsules: they cover all, and protrude exactly as far as they say."""

import numpy as np
import pytest

from ikde.errors import InputError
from ikde.spheres.primitives import Rows, cover_box, cover_capsule, cover_cylinder

ROUNDING = 1e-12
BOXES = [(0.1, 0.1, 0.1), (0.4, 0.1, 0.02), (0.3, 0.25, 0.2), (0.001, 0.2, 0.2), (0.02, 0.02, 1.0)]
CYLINDERS = [(0.03, 0.5), (0.06, 0.12), (0.15, 0.05), (0.1, 0.2), (0.01, 0.001)]
PROTRUSIONS = [0.02, 0.01]


def bare(rows: Rows, points: np.ndarray) -> float:
    """How far outside all spheres the worst of the points is, in m."""
    away = np.linalg.norm(points[:, None] - rows.centres, axis=2) - rows.radii
    return float(away.min(axis=1).max())


def on_spheres(rows: Rows) -> np.ndarray:
    """Points of the spheres: along the axes, through the nearest faces and edges, and all over them."""
    draw = np.random.default_rng(3).normal(size=(500, 3))
    ways = np.concatenate([np.eye(3), -np.eye(3), draw / np.linalg.norm(draw, axis=1)[:, None]])
    radial = rows.centres * (1.0, 1.0, 0.0)
    length = np.linalg.norm(radial, axis=1)[:, None]
    outward = np.divide(radial, length, out=np.zeros_like(radial), where=length > 0.0)
    points = (rows.centres[:, None] + rows.radii[:, None, None] * ways).reshape(-1, 3)
    return np.concatenate([points, rows.centres + rows.radii[:, None] * outward])


def farthest_from_box(rows: Rows, edges: tuple[float, ...]) -> float:
    beyond = np.maximum(np.abs(on_spheres(rows)) - 0.5 * np.array(edges), 0.0)
    return float(np.linalg.norm(beyond, axis=1).max())


def farthest_from_cylinder(rows: Rows, radius: float, length: float) -> float:
    x, y, z = on_spheres(rows).T
    beside, above = np.hypot(x, y) - radius, np.abs(z) - 0.5 * length
    return float(np.hypot(np.maximum(beside, 0.0), np.maximum(above, 0.0)).max())


def in_disc(count: int) -> np.ndarray:
    """Points [N, 2] of the unit disc, many on its rim."""
    turn = np.linspace(0.0, 2.0 * np.pi, count)
    return np.concatenate(
        [r * np.stack([np.cos(turn), np.sin(turn)], axis=1) for r in (0.0, 0.33, 0.5, 0.71, 0.9, 1.0)]
    )


@pytest.mark.parametrize("protrusion_m", PROTRUSIONS)
@pytest.mark.parametrize("edges", BOXES)
def test_all_of_a_box_is_covered(edges: tuple[float, float, float], protrusion_m: float) -> None:
    steps = [np.linspace(-0.5 * e, 0.5 * e, 13) for e in edges]
    points = np.stack(np.meshgrid(*steps), axis=-1).reshape(-1, 3)
    assert bare(cover_box(edges, protrusion_m), points) <= ROUNDING


@pytest.mark.parametrize("protrusion_m", PROTRUSIONS)
@pytest.mark.parametrize("edges", BOXES)
def test_a_box_protrudes_as_far_as_it_says(edges: tuple[float, float, float], protrusion_m: float) -> None:
    rows = cover_box(edges, protrusion_m)
    assert rows.protrusion_m <= protrusion_m + ROUNDING
    assert farthest_from_box(rows, edges) == pytest.approx(rows.protrusion_m, abs=ROUNDING)


@pytest.mark.parametrize("protrusion_m", PROTRUSIONS)
@pytest.mark.parametrize(("radius", "length"), CYLINDERS)
def test_all_of_a_cylinder_is_covered(radius: float, length: float, protrusion_m: float) -> None:
    disc = radius * in_disc(61)
    heights = np.linspace(-0.5 * length, 0.5 * length, 17)
    points = np.column_stack([np.tile(disc, (17, 1)), np.repeat(heights, len(disc))])
    assert bare(cover_cylinder(radius, length, protrusion_m), points) <= ROUNDING


@pytest.mark.parametrize("protrusion_m", PROTRUSIONS)
@pytest.mark.parametrize(("radius", "length"), CYLINDERS)
def test_a_cylinder_protrudes_as_far_as_it_says(radius: float, length: float, protrusion_m: float) -> None:
    rows = cover_cylinder(radius, length, protrusion_m)
    assert rows.protrusion_m <= protrusion_m + ROUNDING
    assert farthest_from_cylinder(rows, radius, length) == pytest.approx(rows.protrusion_m, abs=ROUNDING)


@pytest.mark.parametrize(("radius", "length"), [(0.05, 0.4), (0.05, 0.0), (0.01, 0.05)])
def test_a_capsule_is_covered_and_protrudes_by_what_its_radius_grew(radius: float, length: float) -> None:
    rows = cover_capsule(radius, length, 0.01)
    turn = np.linspace(0.0, np.pi, 91)
    side = np.stack([np.full(301, radius), np.linspace(-0.5 * length, 0.5 * length, 301)], axis=1)
    cap = np.stack([radius * np.sin(turn), radius * np.cos(turn)], axis=1)
    cap[:, 1] += 0.5 * length * np.sign(cap[:, 1])
    points = np.insert(np.concatenate([side, cap]), 1, 0.0, axis=1)
    assert bare(rows, points) <= ROUNDING
    assert rows.protrusion_m == pytest.approx(float(rows.radii.max()) - radius)
    assert rows.protrusion_m <= 0.01
    assert np.abs(rows.centres[:, 2]).max() == 0.5 * length


def test_a_capsule_takes_no_sphere_more_than_it_must() -> None:
    radius, length, count = 0.05, 0.4, len(cover_capsule(0.05, 0.4, 0.01).radii)
    assert np.hypot(radius, 0.5 * length / (count - 2)) - radius > 0.01


def test_a_slim_cylinder_is_one_row() -> None:
    centres = cover_cylinder(0.03, 0.5, 0.02).centres
    assert (centres[:, :2] == 0.0).all()


def test_deep_inside_a_box_spheres_are_larger() -> None:
    radii = cover_box((0.3, 0.25, 0.2), 0.02).radii
    assert radii.max() > 1.5 * radii.min()


@pytest.mark.parametrize("kind", ["box", "cylinder", "capsule"])
def test_a_shape_that_takes_too_many_spheres_is_refused_with_the_way_out(kind: str) -> None:
    with pytest.raises(InputError, match=f"a {kind} would take more than 2,000 spheres.*--protrusion"):
        {
            "box": lambda: cover_box((3.0, 3.0, 3.0), 0.002),
            "cylinder": lambda: cover_cylinder(3.0, 3.0, 0.002),
            "capsule": lambda: cover_capsule(0.001, 90.0, 0.001),
        }[kind]()
