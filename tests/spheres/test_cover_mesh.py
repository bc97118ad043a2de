"""Meshes covered with spheres: all of the surface, and no farther out than asked."""

import hashlib
from dataclasses import replace

import numpy as np
import pytest

from ikde.errors import InputError
from ikde.spheres import cover_mesh as module
from ikde.spheres import patches
from ikde.spheres.certificate import certify
from ikde.spheres.cover_mesh import MeshCover, bound_protrusion, convex_hull, cover_mesh, cover_solid, drop_needless
from ikde.spheres.parts import PartCounts
from ikde.spheres.primitives import Rows
from tests.mesh_bodies import box, make_l, on_surface, solid_of, write_stl

BODIES = {"box": box(0.12, 0.05, 0.04), "L": 0.5 * make_l()}


@pytest.fixture(scope="module", params=list(BODIES))
def covered(request: pytest.FixtureRequest):
    body = BODIES[request.param]
    return body, cover_solid(solid_of(body), 0.02)


def test_all_of_the_surface_is_covered_by_proof_and_by_a_sampler(covered) -> None:
    body, rows = covered
    assert certify(body, rows.centres, rows.radii).covered == 1.0
    points = on_surface(body, 5_000)
    assert (np.linalg.norm(points[:, None] - rows.centres, axis=2) <= rows.radii).any(axis=1).all()


def test_no_point_of_a_sphere_is_farther_out_than_allowed(covered) -> None:
    body, rows = covered
    draw = np.random.default_rng(5).normal(size=(200, 3))
    ways = draw / np.linalg.norm(draw, axis=1)[:, None]
    points = (rows.centres[:, None] + rows.radii[:, None, None] * ways).reshape(-1, 3)
    solid = solid_of(body)
    assert min(solid.depth(point) for point in points[::5]) >= -0.02
    assert rows.protrusion_m == 0.02


def test_less_is_proved_without_any_one_of_the_spheres(covered) -> None:
    body, rows = covered
    for out in range(len(rows.radii)):
        centres, radii = np.delete(rows.centres, out, axis=0), np.delete(rows.radii, out)
        assert certify(body, centres, radii).covered < 1.0


def test_a_sphere_that_others_make_needless_is_dropped(covered) -> None:
    body, rows = covered
    twice = Rows(np.concatenate([rows.centres, rows.centres[:1]]), np.append(rows.radii, 0.9 * rows.radii[0]), 0.02)
    left = drop_needless(body, 0.004, twice)
    assert left.radii.tolist() == rows.radii.tolist()


def test_the_same_body_gets_the_same_bits(covered) -> None:
    body, rows = covered
    again = cover_solid(solid_of(body), 0.02)
    digests = {hashlib.sha256(own.centres.tobytes() + own.radii.tobytes()).hexdigest() for own in (rows, again)}
    assert len(digests) == 1


@pytest.mark.parametrize("more_m", [9.0, 0.002])
def test_a_candidate_that_is_too_large_is_not_taken(more_m: float, monkeypatch: pytest.MonkeyPatch) -> None:
    real = module.find_candidates

    def enlarge(*own):
        candidates = real(*own)
        candidates.radii[0] += more_m
        candidates.covers[0] = np.arange(len(own[1].centres))
        return candidates

    monkeypatch.setattr(module, "find_candidates", enlarge)
    monkeypatch.setattr(module, "EXCHANGES", 0)
    solid = solid_of(BODIES["box"])
    rows = cover_solid(solid, 0.02)
    assert bound_protrusion(solid, rows.centres, rows.radii) <= 0.02
    assert certify(BODIES["box"], rows.centres, rows.radii).covered == 1.0


def test_how_far_spheres_stand_out_is_bounded_by_the_one_that_is_out_most() -> None:
    solid = solid_of(box(1, 1, 1))
    centres = np.array([[0.5, 0.5, 0.5], [0.5, 0.5, 0.9], [0.5, 0.5, 1.2]])
    assert bound_protrusion(solid, centres, np.array([0.6, 0.3, 0.05])) == pytest.approx(0.25)
    assert bound_protrusion(solid, centres[:2], np.array([0.6, 0.3])) == pytest.approx(0.2)
    assert bound_protrusion(solid, centres[:2], np.array([0.3, 0.05])) == 0.0


def test_protrusion_of_a_cover_of_hulls_is_that_from_the_mesh(tmp_path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One sphere in the notch of an L, 50 mm from it: all of its radius and as much again stand out."""
    pytest.importorskip("trimesh")
    path = write_stl(tmp_path / "l.stl", make_l())
    many, coarse = Rows(np.zeros((61, 3)), np.full(61, 0.02), 0.02), Rows(np.array([[0.15, 0.15, 0.05]]), np.ones(1), 9)
    covers = [MeshCover(rows, 1.0, 1.0, PartCounts(1, 0, 0), ()) for rows in (many, coarse)]
    monkeypatch.setattr(module, "_cover_surface", lambda *own: covers[own[1].hulls])
    cover = cover_mesh(path, (1.0, 1.0, 1.0), 0.02)
    assert (cover.only_hulls, cover.rows.protrusion_m) == (True, pytest.approx(1.05))
    covers[1] = replace(covers[1], rows=many)
    assert not cover_mesh(path, (1.0, 1.0, 1.0), 0.02).only_hulls
    covers[0] = replace(covers[0], rows=Rows(many.centres[1:], many.radii[1:], 0.02))
    covers[1] = replace(covers[1], rows=coarse)
    assert not cover_mesh(path, (1.0, 1.0, 1.0), 0.02).only_hulls


def test_the_share_is_that_of_the_surface_and_its_spheres(monkeypatch: pytest.MonkeyPatch, tmp_path) -> None:
    pytest.importorskip("trimesh")
    half = Rows(np.array([[0.25, 0.5, 0.5]]), np.array([0.8]), 0.02)
    monkeypatch.setattr(module, "cover_solid", lambda solid, protrusion_m: half)
    cover = cover_mesh(write_stl(tmp_path / "box.stl", box(1, 1, 1)), (1.0, 1.0, 1.0), 0.02)
    assert (cover.covered, cover.area_m2) == (certify(box(1, 1, 1), *half[:2]).covered, pytest.approx(6.0))
    assert 0.1 < cover.covered < 0.9


def test_an_open_box_is_covered_as_its_hull(tmp_path) -> None:
    pytest.importorskip("trimesh")
    cover = cover_mesh(write_stl(tmp_path / "open.stl", box(0.06, 0.05, 0.04)[:-2]), (1.0, 1.0, 1.0), 0.02)
    assert (cover.parts.hulls, cover.parts.closed, cover.covered) == (1, 0, 1.0)
    assert cover.area_m2 == pytest.approx(2 * (0.003 + 0.0024 + 0.002))


def test_a_mirrored_mesh_is_covered_where_it_stands(tmp_path) -> None:
    pytest.importorskip("trimesh")
    path = write_stl(tmp_path / "l.stl", BODIES["L"])
    rows = cover_mesh(path, (-1.0, 1.0, 1.0), 0.02).rows
    assert certify(BODIES["L"] * (-1.0, 1.0, 1.0), rows.centres, rows.radii).covered > 0.999999


def test_points_in_a_plane_have_no_hull() -> None:
    pytest.importorskip("trimesh")
    flat = np.array([[0.0, 0, 1], [1, 0, 1], [0, 1, 1], [1, 1, 1]])
    assert convex_hull(flat) is None
    assert convex_hull(flat[:3]) is None
    hull = convex_hull(np.concatenate([flat, flat - (0, 0, 1)]))
    assert hull is not None
    assert hull.shape == (12, 3, 3)


def test_where_a_mesh_takes_too_many_spheres_its_hull_is_covered(tmp_path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("trimesh")
    path = write_stl(tmp_path / "l.stl", BODIES["L"])
    monkeypatch.setattr(module, "EXCHANGES", 1_000_000)
    few = cover_mesh(path, (1.0, 1.0, 1.0), 0.04)
    monkeypatch.setattr(module, "MAX_SPHERES", len(few.rows.radii) - 1)
    again = cover_mesh(path, (1.0, 1.0, 1.0), 0.04)
    assert not few.only_hulls
    assert again.only_hulls == (len(again.rows.radii) < len(few.rows.radii))
    assert again.covered == 1.0


def test_a_mesh_too_large_to_cover_is_suspected_to_be_in_mm(tmp_path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(patches, "MAX_PIECES", 30_000)
    path = write_stl(tmp_path / "box.stl", box(120, 50, 40))
    with pytest.raises(
        InputError, match=r"^box\.stl is 120 m large; if it is given in mm, use --mesh-scale 0\.001; the"
    ):
        cover_mesh(path, (1.0, 1.0, 1.0), 0.02)
