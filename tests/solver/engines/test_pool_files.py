"""Pools as files: whole or none; those that come with ikde are what would be drawn."""

import os
import zlib

import numpy as np
import pytest

import ikde
from ikde.errors import CacheWarning
from ikde.kernels import cache_files, cache_folder
from ikde.kernels.cache_files import seal
from ikde.model.collision_model import CollisionModel
from ikde.model.target import KINDS
from ikde.solver.engines import pool_files
from ikde.solver.engines.draws import DRAWS
from ikde.solver.engines.pool import DRAWN, digest_pool, draw_kept, make_whole_pool
from ikde.solver.engines.pool_files import (
    MAX_DRAW,
    SHIPPED,
    Kept,
    load_cached,
    load_shipped,
    read_kept,
    save_cached,
    write_kept,
)

NAME = "some.pool"
KEPT = Kept(numbers=np.array([0, 3, 4, 17, 4000]), scale=np.array([[-0.25, 64.0], [1.0 / 3.0, 2.0]]))
NONE = Kept(numbers=np.empty(0, dtype=np.int64), scale=np.zeros((2, 2)))
STALE = "run python -m benchmarks.ship_pools"


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """A cache of its own, and nothing that comes with ikde."""
    monkeypatch.setattr(cache_folder, "CACHE_FOLDER", tmp_path)
    monkeypatch.setattr(cache_folder, "CACHE_IS_WRITABLE", True)
    monkeypatch.setattr(cache_files, "WARNED", set())
    monkeypatch.setattr(pool_files, "SHIPPED", tmp_path / "shipped")
    (tmp_path / "shipped").mkdir()
    return tmp_path


def assert_same(kept, expected):
    assert kept.numbers.tolist() == expected.numbers.tolist()
    assert kept.numbers.dtype == np.int64
    assert kept.scale.tobytes() == expected.scale.tobytes()


@pytest.mark.parametrize("kept", [KEPT, NONE])
def test_what_was_saved_comes_back(kept):
    save_cached(NAME, kept)
    assert_same(load_cached(NAME, 2), kept)


def test_what_is_not_there_is_none():
    assert load_cached(NAME, 2) is None
    assert load_shipped(NAME, 2) is None


def test_a_cache_that_is_not_used_keeps_nothing(folder, monkeypatch):
    save_cached(NAME, KEPT)
    monkeypatch.setattr(cache_folder, "CACHE_IS_WRITABLE", False)
    assert load_cached(NAME, 2) is None
    (folder / cache_folder.ROBOTS / NAME).unlink()
    save_cached(NAME, KEPT)
    assert not list((folder / cache_folder.ROBOTS).iterdir())


@pytest.mark.parametrize("share", [0.0, 0.5, 0.99])
def test_a_file_that_was_cut_is_removed(folder, share):
    save_cached(NAME, KEPT)
    path = folder / cache_folder.ROBOTS / NAME
    content = path.read_bytes()
    path.write_bytes(content[: int(share * len(content))])
    with pytest.warns(CacheWarning, match="is damaged"):
        assert load_cached(NAME, 2) is None
    assert not path.exists()


def test_one_pool_does_not_pass_for_another(folder):
    save_cached(NAME, KEPT)
    path = folder / cache_folder.ROBOTS / NAME
    path.rename(path.with_name("other.pool"))
    with pytest.warns(CacheWarning, match="is damaged"):
        assert load_cached("other.pool", 2) is None


def test_a_full_disk_is_no_error(monkeypatch):
    def fail(handle):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", fail)
    with pytest.warns(CacheWarning, match="No space left on device"):
        save_cached(NAME, KEPT)
    assert load_cached(NAME, 2) is None


def test_what_comes_with_ikde_is_read_only_whole(folder):
    path = folder / "shipped" / NAME
    path.write_bytes(seal(path, write_kept(KEPT)))
    assert_same(load_shipped(NAME, 2), KEPT)
    whole = path.read_bytes()
    path.write_bytes(whole[:-1])
    assert load_shipped(NAME, 2) is None
    assert path.exists()
    path.write_bytes(bytes([whole[0] ^ 1]) + whole[1:])
    assert load_shipped(NAME, 2) is None


def test_what_no_pool_can_be_is_none():
    """Whoever can write into the cache can forge a checksum."""
    bits, scale = zlib.compress(b"\x80"), KEPT.scale.tobytes()
    assert_same(read_kept(scale + bits, 2), Kept(numbers=np.array([0]), scale=KEPT.scale))
    assert read_kept(scale + bits, 3) is None
    assert read_kept(scale + bits, 1) is None
    assert read_kept(scale[:5], 2) is None
    assert read_kept(b"", 2) is None
    assert read_kept(scale + bits[:-1], 2) is None
    assert read_kept(scale + zlib.compress(bytes(MAX_DRAW // 8 + 1)), 2) is None
    for bad in (np.nan, np.inf):
        assert read_kept(np.array([[0.0, 1.0], [bad, 1.0]]).tobytes() + bits, 2) is None


def test_no_draw_is_beyond_the_largest():
    assert DRAWS * DRAWN < MAX_DRAW
    last = Kept(numbers=np.array([DRAWS * DRAWN - 1]), scale=KEPT.scale)
    assert_same(read_kept(write_kept(last), 2), last)


# ---- what comes with ikde


@pytest.mark.parametrize("name", ikde.robot_names())
def test_the_pools_of_a_robot_come_with_ikde_as_they_would_be_drawn(name, monkeypatch):
    monkeypatch.setattr(pool_files, "SHIPPED", SHIPPED)
    collision = CollisionModel.of(ikde.load_robot(name))
    for kind in KINDS:
        pool = make_whole_pool(collision, kind)
        shipped = load_shipped(f"{digest_pool(pool, collision)}.pool", len(pool.grid))
        assert shipped is not None, STALE
        drawn = draw_kept(pool, collision)
        assert shipped.numbers.tolist() == drawn.numbers.tolist(), STALE
        np.testing.assert_allclose(shipped.scale, drawn.scale, rtol=1e-9, atol=1e-9, err_msg=STALE)


def test_nothing_else_comes_with_ikde():
    collisions = [CollisionModel.of(ikde.load_robot(name)) for name in ikde.robot_names()]
    pools = [(make_whole_pool(collision, kind), collision) for collision in collisions for kind in KINDS]
    assert {path.stem for path in SHIPPED.iterdir()} == {digest_pool(*pool) for pool in pools}, STALE
    assert sum(path.stat().st_size for path in SHIPPED.iterdir()) < 150_000
