"""The proof that a surface is covered."""

import numpy as np
import pytest

from ikde.spheres.certificate import certify
from tests.mesh_bodies import box, make_l, on_surface

CORNER_SPHERES = np.array([[x, y, z] for x in (0.25, 0.75) for y in (0.25, 0.75) for z in (0.25, 0.75)])
RADII = np.full(8, 0.25 * np.sqrt(3.0) + 1e-9)


def sampled(triangles: np.ndarray, centres: np.ndarray, radii: np.ndarray, count: int = 10_000) -> float:
    """Share of random points of a surface that lie in a sphere."""
    away = np.linalg.norm(on_surface(triangles, count)[:, None] - centres, axis=2)
    return float((away <= radii).any(axis=1).mean())


def test_a_box_in_eight_spheres_is_covered_by_proof() -> None:
    certificate = certify(box(1, 1, 1), CORNER_SPHERES, RADII)
    assert (certificate.covered, certificate.area_m2, len(certificate.open_pieces)) == (1.0, pytest.approx(6.0), 0)


@pytest.mark.parametrize("missing", [0, 5])
def test_without_one_sphere_less_is_proved_as_a_sampler_confirms(missing: int) -> None:
    centres, radii = np.delete(CORNER_SPHERES, missing, axis=0), np.delete(RADII, missing)
    certificate = certify(box(1, 1, 1), centres, radii)
    assert certificate.covered < 0.92
    assert certificate.covered == pytest.approx(sampled(box(1, 1, 1), centres, radii), abs=0.01)


@pytest.mark.parametrize("seed", range(2))
def test_what_is_proved_is_never_more_than_there_is(seed: int) -> None:
    draw = np.random.default_rng(seed)
    centres, radii = draw.uniform(0.0, 0.2, (12, 3)), draw.uniform(0.02, 0.08, 12)
    certificate = certify(make_l(), centres, radii)
    share = sampled(make_l(), centres, radii)
    assert share - 0.02 <= certificate.covered <= share + 0.01


def test_pieces_that_are_left_open_hold_all_that_is_bare() -> None:
    centres, radii = CORNER_SPHERES[:7], RADII[:7]
    left = certify(box(1, 1, 1), centres, radii).open_pieces
    points = on_surface(box(1, 1, 1), 3_000)
    bare = points[(np.linalg.norm(points[:, None] - centres, axis=2) > radii).all(axis=1)]
    low, high = left.min(axis=(0, 1)), left.max(axis=(0, 1))
    assert ((bare >= low - 1e-12) & (bare <= high + 1e-12)).all()


def test_a_triangle_whose_corners_lie_in_different_spheres_only_is_not_proved_at_once() -> None:
    triangle = np.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]])
    assert certify(triangle, triangle[0], np.full(3, 0.1), halvings=0).covered == 0.0


def test_no_sphere_proves_nothing() -> None:
    assert certify(box(1, 1, 1), np.zeros((0, 3)), np.zeros(0)).covered == 0.0
