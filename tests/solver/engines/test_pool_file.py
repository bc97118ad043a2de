"""The pool on disk: what was saved comes back bit for bit, and what is not whole is drawn again."""

import numpy as np
import pytest

from ikde.solver.engines.pool_file import load_pool, save_pool
from tests.solver.engines.test_pool import pool


def test_what_was_saved_comes_back(qiao, tmp_path):
    seeds = pool(qiao)
    save_pool(tmp_path / "pool.npz", seeds)
    loaded = load_pool(tmp_path / "pool.npz")
    for ours, theirs in zip(seeds, loaded, strict=True):
        assert type(ours) is type(theirs)
        assert np.asarray(ours).tobytes() == np.asarray(theirs).tobytes()
        assert not isinstance(theirs, np.ndarray) or not theirs.flags.writeable


@pytest.mark.parametrize("share", [0.0, 0.5, 0.999])
def test_a_file_that_was_cut_is_none(qiao, tmp_path, share):
    path = tmp_path / "pool.npz"
    save_pool(path, pool(qiao))
    content = path.read_bytes()
    path.write_bytes(content[: int(share * len(content))])
    assert load_pool(path) is None


def test_no_file_is_none(tmp_path):
    assert load_pool(tmp_path / "pool.npz") is None
