"""Covers of random meshes, judged by points; `python -m benchmarks.covers` judges 210."""

from pathlib import Path

import numpy as np
import pytest

from ikde.spheres import cover_mesh as module
from ikde.spheres import patches
from ikde.spheres.cover_mesh import cover_mesh
from tests.cover_judge import judge
from tests.mesh_bodies import box, make_l
from tests.random_meshes import KINDS, draw_mesh


@pytest.mark.parametrize("seed", [4, 6, 25])  # boxes that cross, an open mesh, a needle
def test_what_is_proved_to_be_covered_is(seed: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("trimesh")
    monkeypatch.setattr(module, "EXCHANGES", 1_000_000)
    monkeypatch.setattr(patches, "PATCHES", 500)
    mesh, path = draw_mesh(seed, tmp_path)
    cover = cover_mesh(path, mesh.scale, mesh.protrusion_m)
    rng = np.random.default_rng(seed)
    found = judge(mesh.triangles, cover.rows.centres, cover.rows.radii, rng, of_hulls=cover.only_hulls, count=1_000)
    assert (cover.covered, found.bare) == (1.0, 0.0)
    assert found.out_m <= cover.rows.protrusion_m + 1e-9


def test_the_judge_sees_what_is_bare_and_what_stands_out() -> None:
    centres, radii = np.array([[0.05, 0.05, 0.05], [0.15, 0.05, 0.05]]), np.array([0.09, 0.09])
    rng = np.random.default_rng(0)
    found = judge(make_l(), centres, radii, rng, of_hulls=False)
    assert 0.2 < found.bare < 0.4
    assert 0.03 < found.out_m <= 0.04
    assert judge(make_l(), centres, radii, rng, of_hulls=True).bare > found.bare
    inner = np.concatenate([box(1, 1, 1), 0.1 * box(1, 1, 1) + 0.4])
    around = judge(inner, np.full((1, 3), 0.5), np.array([0.87]), rng, of_hulls=False)
    assert (around.bare, around.out_m) == (0.0, pytest.approx(0.37, abs=0.01))
    assert judge(inner[12:], np.zeros((1, 3)), np.array([0.1]), rng, of_hulls=False).bare == 1.0


def test_the_same_seed_draws_the_same_mesh_and_every_kind_is_drawn(tmp_path: Path) -> None:
    kinds = {draw_mesh(seed, tmp_path)[0].kind for seed in range(len(KINDS))}
    assert kinds == set(KINDS)
    one, other = (draw_mesh(33, tmp_path)[0] for _ in range(2))
    np.testing.assert_array_equal(one.triangles, other.triangles)
    assert (one.scale, one.protrusion_m) == (other.scale, other.protrusion_m)
