"""Machine code on disk: compiled once and loaded; compiled again if it is damaged, or made for something else."""

import pickle
from pathlib import Path

import numba
import numpy as np
import pytest

from ikde.errors import CacheWarning
from ikde.kernels import cache_files, cache_folder, jit, machine_code

pytestmark = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="needs compiled kernels")


def double(x):
    return 2.0 * x


def make_closure():
    factor = 3.0

    def multiply(x):
        return factor * x

    return multiply


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A cache of the test's own, in which nothing has been told."""
    monkeypatch.setattr(cache_folder, "CACHE_FOLDER", tmp_path)
    monkeypatch.setattr(cache_folder, "CACHE_IS_WRITABLE", True)
    monkeypatch.setattr(cache_files, "WARNED", set())
    return tmp_path / cache_folder.MACHINE_CODE


def run(x, function=double):
    """(result, whether it was compiled) of a kernel that knows nothing yet, as in a new process."""
    with jit.compile_clock() as clock:
        result = jit.kernel(function)(x)
    return result, clock.seconds > 0.0


def only_file(folder):
    (path,) = folder.iterdir()
    return path


def test_a_kernel_is_compiled_once(folder):
    assert [run(2.0), run(2.0)] == [(4.0, True), (4.0, False)]
    assert only_file(folder).name.startswith("test_machine_code.double.")


def test_whether_there_is_machine_code_is_known_without_numba(folder):
    assert not cache_folder.is_kept(double)
    run(2.0)
    assert cache_folder.is_kept(double)
    assert not cache_folder.is_kept(make_closure)


def test_other_types_of_arguments_are_compiled_and_kept_beside(folder):
    frozen = np.ones(2)
    frozen.setflags(write=False)
    calls = [2.0, 2, np.ones(2), frozen]
    assert [compiled for _, compiled in map(run, calls * 2)] == [True] * 4 + [False] * 4
    assert len(list(folder.iterdir())) == 4


def test_numbas_own_cache_is_left_alone(folder, monkeypatch, tmp_path):
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "numba"))
    run(2.0)
    assert not (tmp_path / "numba").exists()


@pytest.mark.parametrize("change", ["source", "VERSIONS"])
def test_another_source_or_another_numba_compiles_again(folder, monkeypatch, substitute, change):
    run(2.0)
    if change == "source":
        substitute(machine_code.hash_source, lambda file: "another")
    else:
        monkeypatch.setattr(machine_code, "VERSIONS", ("another",))
    assert run(2.0) == (4.0, True)
    assert len(list(folder.iterdir())) == 2


def test_what_was_kept_for_something_else_is_not_run(folder):
    """Two keys that are written alike."""
    run(2.0)
    path = only_file(folder)
    key, parts = pickle.loads(cache_files.read_sealed(path))
    cache_files.write_sealed(path, pickle.dumps(((*key[:2], "another"), parts)))
    assert run(2.0) == (4.0, True)


@pytest.mark.parametrize("share", [0.0, 0.01, 0.5, 0.999])
def test_a_file_that_was_cut_is_compiled_again(folder, share):
    run(2.0)
    path = only_file(folder)
    path.write_bytes(path.read_bytes()[: int(share * path.stat().st_size)])
    with pytest.warns(CacheWarning, match="is damaged"):
        assert run(2.0) == (4.0, True)
    assert run(2.0) == (4.0, False)


@pytest.mark.parametrize("seed", range(5))
def test_a_flipped_bit_is_never_run(folder, seed):
    run(2.0)
    path = only_file(folder)
    content = bytearray(path.read_bytes())
    content[np.random.default_rng(seed).integers(len(content))] ^= 16
    path.write_bytes(content)
    with pytest.warns(CacheWarning, match="is damaged"):
        assert run(2.0) == (4.0, True)


@pytest.mark.parametrize("content", [b"", pickle.dumps(1), b"cnowhere\nnothing\n."])
def test_whatever_cannot_be_loaded_is_compiled_again(folder, content):
    run(2.0)
    cache_files.write_sealed(only_file(folder), content)
    with pytest.warns(CacheWarning, match="cannot be loaded"):
        assert run(2.0) == (4.0, True)
    assert run(2.0) == (4.0, False)


def test_a_folder_in_place_of_the_file_is_compiled_again(folder):
    run(2.0)
    path = only_file(folder)
    path.unlink()
    (path / "inside").mkdir(parents=True)
    with pytest.warns(CacheWarning, match="cannot be read"):
        assert run(2.0) == (4.0, True)
    assert run(2.0) == (4.0, False)


def test_where_nothing_can_be_written_it_is_compiled_all_the_same(folder):
    folder.write_text("in the way")
    with pytest.warns(CacheWarning):
        assert run(2.0) == (4.0, True)


def test_what_has_no_file_is_not_kept(folder):
    function = {}
    exec("def double(x):\n    return 2.0 * x\n", function)
    assert run(2.0, function["double"]) == (4.0, True)
    assert not folder.exists()


def test_what_depends_on_where_it_was_made_is_not_kept(folder):
    assert run(2.0, make_closure()) == (6.0, True)
    assert not folder.exists()


def test_without_a_cache_nothing_is_kept(folder, monkeypatch):
    monkeypatch.setattr(cache_folder, "CACHE_IS_WRITABLE", False)
    assert [run(2.0), run(2.0)] == [(4.0, True)] * 2
    assert not folder.exists()


def test_the_source_of_a_file_is_hashed_by_its_bytes(tmp_path):
    for name in "ab":
        (tmp_path / name).write_text("same")
    assert machine_code.hash_source(str(tmp_path / "a")) == machine_code.hash_source(str(tmp_path / "b"))
    assert machine_code.hash_source(str(tmp_path / "c")) is None
    assert machine_code.hash_source(str(Path("/"))) is None
