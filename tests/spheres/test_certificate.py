"""The proof that a surface is covered."""

import numpy as np
import pytest

from ikde.spheres import certificate as module
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


def test_the_share_is_one_of_area() -> None:
    triangles = np.array([[[0.0, 0, 0], [2, 0, 0], [0, 1, 0]], [[9.0, 0, 0], [11, 0, 0], [9, 0, 3]]])
    certificate = certify(triangles, np.array([[0.5, 0.5, 0.0]]), np.array([2.0]), halvings=0)
    assert (certificate.area_m2, certificate.covered) == (4.0, 0.25)
    assert certificate.open_pieces[..., 0].min() == 9.0


@pytest.mark.parametrize(("less", "covered"), [(1.2e-12, 1.0), (0.8e-12, 0.0), (0.0, 0.0), (-1e-6, 0.0)])
def test_a_corner_is_inside_only_below_the_radius_by_more_than_rounding(less: float, covered: float) -> None:
    triangle = np.array([[[1.0 - less, 0, 0], [0, 0.5, 0], [0, 0, -0.5]]])
    for turn in range(3):
        assert certify(np.roll(triangle, turn, axis=1), np.zeros((1, 3)), np.ones(1), halvings=0).covered == covered
        assert certify(np.roll(triangle, turn, axis=2), np.zeros((1, 3)), np.ones(1), halvings=0).covered == covered


@pytest.mark.parametrize("turn", range(3))
def test_what_is_in_no_sphere_is_halved_at_its_longest_edge_so_often(turn: int) -> None:
    triangle = np.roll(np.array([[[0.0, 0, 0], [8, 0, 0], [4, 1, 0]]]), turn, axis=1)
    centres, radii = np.array([[2.0, 0.25, 0], [6.0, 0.25, 0]]), np.array([2.2, 2.2])
    assert certify(triangle, centres, radii, halvings=0).covered == 0.0
    assert certify(triangle, centres, radii, halvings=1).covered == 1.0
    one = certify(triangle, centres[:1], radii[:1], halvings=1)
    assert one.covered == 0.5
    assert one.open_pieces.shape == (4, 3, 3)  # long beside its radius: once more
    assert certify(triangle, centres[:1], 50.0 * radii[:1] + 50.0, halvings=1).covered == 1.0
    far = certify(triangle, centres[:1] + 999.0, 100.0 * radii[:1], halvings=1)
    assert (far.covered, far.open_pieces.shape) == (0.0, (2, 3, 3))


def test_a_long_thin_triangle_is_halved_more_often() -> None:
    """After 14 halvings pieces are a 128th as long, and a sphere holds a 160th."""
    triangle = np.array([[[0.0, 0, 0], [1, 0, 0], [0.5, 1e-4, 0]]])
    centres = np.linspace([0.0, 0, 0], [1, 0, 0], 301)
    assert certify(triangle, centres, np.full(301, 0.003)).covered == 1.0
    assert certify(triangle, np.delete(centres, 7, axis=0), np.full(300, 0.003)).covered < 1.0


def test_fourteen_times_unless_asked_otherwise() -> None:
    """A quarter of a large triangle is bare, so that every halving leaves some of what is not decided."""
    triangle, centre = np.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]]), np.array([[0.0, 0, 0]])
    usual = certify(triangle, centre, np.array([0.8]))
    assert usual.covered == certify(triangle, centre, np.array([0.8]), halvings=14).covered
    assert usual.covered > certify(triangle, centre, np.array([0.8]), halvings=13).covered
    assert usual.covered < certify(triangle, centre, np.array([0.8]), halvings=15).covered


@pytest.mark.parametrize(("share", "covered"), [(0.9e-8, 0.0), (1.1e-8, 1.0)])
def test_what_is_too_small_is_given_up_and_left_open(share: float, covered: float) -> None:
    """Spheres hold its halves, and all of a triangle that has nearly all of the area."""
    size = 7.0  # the share is one of all area, however large that is
    large = np.array([[0.0, 0, 9], [2, 0, 9], [0, 1, 9]]) * size
    small = np.array([[0.0, 0, 0], [8, 0, 0], [4, 1, 0]]) * size * np.sqrt(share / 4.0)
    centres = np.array([[2.0, 0.25, 0], [6.0, 0.25, 0]]) * size * np.sqrt(share / 4.0)
    radii = np.array([2.2, 2.2]) * size * np.sqrt(share / 4.0)
    proved = certify(
        np.array([large, small]),
        np.concatenate([centres, [[0.5 * size, 0.5 * size, 9 * size]]]),
        np.append(radii, 2.0 * size),
        halvings=1,
    )
    assert proved.covered == (1.0 if covered else pytest.approx(1.0 - share, abs=1e-12))
    assert (proved.covered == 1.0) == (not len(proved.open_pieces)) == bool(covered)
    assert len(proved.open_pieces) == (not covered)


def test_what_is_proved_and_what_is_left_open_make_up_the_surface() -> None:
    draw = np.random.default_rng(7)
    triangles, centres, radii = draw.random((20, 3, 3)), draw.random((30, 3)), draw.uniform(0.1, 0.3, 30)
    certificate = certify(triangles, centres, radii, halvings=6)
    left = certificate.open_pieces
    areas = 0.5 * np.linalg.norm(np.cross(left[:, 1] - left[:, 0], left[:, 2] - left[:, 0]), axis=1)
    assert 0.1 < certificate.covered < 0.9
    assert certificate.covered * certificate.area_m2 + areas.sum() == pytest.approx(certificate.area_m2, rel=1e-12)


def test_many_spheres_are_asked_in_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    draw = np.random.default_rng(8)
    triangles, centres, radii = draw.random((20, 3, 3)), draw.random((30, 3)), draw.uniform(0.1, 0.3, 30)
    whole = certify(triangles, centres, radii, halvings=4)
    for block in (1, 9 * 30 * 7):
        monkeypatch.setattr(module, "BLOCK", block)
        again = certify(triangles, centres, radii, halvings=4)
        assert again.covered == whole.covered
        np.testing.assert_array_equal(again.open_pieces, whole.open_pieces)


def test_no_sphere_proves_nothing() -> None:
    assert certify(box(1, 1, 1), np.zeros((0, 3)), np.zeros(0)).covered == 0.0
