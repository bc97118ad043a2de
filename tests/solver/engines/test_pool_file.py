"""The pool on disk: what was saved comes back bit for bit, and what is damaged is drawn again."""

import os

import numba
import numpy as np
import pytest

from ikde.errors import CacheWarning
from ikde.kernels import cache_files
from ikde.solver.engines.pool_file import load_pool, save_pool
from tests.solver.engines.questions import make_pool


def test_kernels_take_all_seeds_alike(qiao, tmp_path):
    """Drawn, loaded, near something or frozen: one type, one compilation."""
    save_pool(tmp_path / "pool.npz", make_pool(qiao))
    every = [
        make_pool(qiao),
        load_pool(tmp_path / "pool.npz"),
        make_pool(qiao, near=qiao.home),
        make_pool(qiao, freeze={"q1": 0.1}),
    ]
    assert len({numba.typeof(seeds) for seeds in every}) == 1


def test_what_was_saved_comes_back(qiao, tmp_path):
    seeds = make_pool(qiao)
    save_pool(tmp_path / "pool.npz", seeds)
    loaded = load_pool(tmp_path / "pool.npz")
    for ours, theirs in zip(seeds, loaded, strict=True):
        assert type(ours) is type(theirs)
        assert np.asarray(ours).tobytes() == np.asarray(theirs).tobytes()
        assert not isinstance(theirs, np.ndarray) or not theirs.flags.writeable


@pytest.mark.parametrize("share", [0.0, 0.5, 0.999])
def test_a_file_that_was_cut_is_none(qiao, tmp_path, share, monkeypatch):
    monkeypatch.setattr(cache_files, "WARNED", set())
    path = tmp_path / "pool.npz"
    save_pool(path, make_pool(qiao))
    content = path.read_bytes()
    path.write_bytes(content[: int(share * len(content))])
    with pytest.warns(CacheWarning, match="is damaged"):
        assert load_pool(path) is None


def test_a_full_disk_is_no_error(qiao, tmp_path, monkeypatch):
    def fail(handle):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(cache_files, "WARNED", set())
    monkeypatch.setattr(os, "fsync", fail)
    with pytest.warns(CacheWarning, match="No space left on device"):
        save_pool(tmp_path / "pool.npz", make_pool(qiao))
    assert list(tmp_path.iterdir()) == []


def test_no_file_is_none(tmp_path):
    assert load_pool(tmp_path / "pool.npz") is None
