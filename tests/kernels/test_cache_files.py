"""Files of the cache: written whole, read only if they are this user's and unharmed, removed with one word if not."""

import os
import stat

import pytest

from ikde.errors import CacheWarning
from ikde.kernels import cache_files as module
from ikde.kernels.cache_folder import HAS_OWNERS, USER

CONTENT = bytes(range(256)) * 10


@pytest.fixture(autouse=True)
def nothing_told(monkeypatch):
    """No process has said anything yet."""
    monkeypatch.setattr(module, "WARNED", set())


@pytest.fixture
def sealed(tmp_path):
    """A file that was written."""
    path = tmp_path / "folder" / "file"
    module.write_sealed(path, CONTENT)
    return path


def test_what_was_written_comes_back(sealed):
    assert module.read_sealed(sealed) == CONTENT
    assert [path.name for path in sealed.parent.iterdir()] == [sealed.name]


@pytest.mark.skipif(not HAS_OWNERS, reason="needs owners of files")
def test_it_is_this_users_alone(sealed):
    assert [stat.S_IMODE(path.stat().st_mode) for path in (sealed, sealed.parent)] == [0o600, 0o700]


def test_another_file_of_the_cache_does_not_pass_for_it(sealed):
    module.write_sealed(sealed.with_name("other"), b"another's")
    sealed.with_name("other").replace(sealed)
    with pytest.warns(CacheWarning, match=rf"^{sealed} is damaged: "):
        assert module.read_sealed(sealed) is None
    assert not sealed.exists()


def test_what_is_not_there_is_none(tmp_path):
    assert module.read_sealed(tmp_path / "file") is None
    assert module.read_file(tmp_path / "folder" / "file") is None


def test_it_is_on_the_disk_before_it_has_its_name(tmp_path, monkeypatch):
    synced, sync = [], os.fsync
    monkeypatch.setattr(os, "fsync", lambda handle: (synced.append((tmp_path / "file").exists()), sync(handle)))
    assert module.write_file(tmp_path / "file", CONTENT)
    assert synced == [False]


@pytest.mark.parametrize("size", [0, 1, module.SEAL - 1, module.SEAL, 500, len(CONTENT) + module.SEAL - 1])
def test_a_file_that_was_cut_is_removed(sealed, size):
    sealed.write_bytes(sealed.read_bytes()[:size])
    with pytest.warns(CacheWarning, match=rf"^{sealed} is damaged: "):
        assert module.read_sealed(sealed) is None
    assert not sealed.exists()


@pytest.mark.parametrize("place", [0, module.SEAL, 1000, -1])
def test_a_file_with_a_flipped_bit_is_removed(sealed, place):
    content = bytearray(sealed.read_bytes())
    content[place] ^= 1
    sealed.write_bytes(content)
    with pytest.warns(CacheWarning, match="is damaged"):
        assert module.read_sealed(sealed) is None
    assert not sealed.exists()


def put_folder(path):
    path.mkdir()
    (path / "inside").touch()


def put_pipe(path):
    os.mkfifo(path)


def put_link(path):
    path.symlink_to(path.with_name("target"))
    module.write_sealed(path.with_name("target"), CONTENT)


def put_loose_file(path):
    module.write_sealed(path, CONTENT)
    path.chmod(0o606)


def put_foreign_file(path):
    module.write_sealed(path, CONTENT)
    if USER != 0:
        pytest.skip("only root gives files away")
    os.chown(path, 4321, -1)


@pytest.mark.skipif(not HAS_OWNERS, reason="needs owners of files")
@pytest.mark.parametrize("put", [put_folder, put_pipe, put_link, put_loose_file, put_foreign_file])
def test_what_is_no_file_of_this_users_alone_is_removed_unread(tmp_path, put):
    path = tmp_path / "file"
    put(path)
    faults = "is no file|cannot be read|can be written by others|belongs to user 4321"
    with pytest.warns(CacheWarning, match=rf"^{path} ({faults})"):
        assert module.read_sealed(path) is None
    assert not os.path.lexists(path)
    module.write_sealed(path, CONTENT)
    assert module.read_sealed(path) == CONTENT
    assert put is not put_link or module.read_sealed(tmp_path / "target") == CONTENT


def test_a_folder_where_a_file_is_written_is_removed(tmp_path):
    put_folder(tmp_path / "file")
    with pytest.warns(CacheWarning, match=rf"^{tmp_path / 'file'} is no file"):
        module.write_sealed(tmp_path / "file", CONTENT)
    assert module.read_sealed(tmp_path / "file") == CONTENT


def test_damage_is_told_once(tmp_path):
    for name in "ab":
        (tmp_path / name).write_text("short")
    with pytest.warns(CacheWarning):
        assert module.read_sealed(tmp_path / "a") is None
    assert module.read_sealed(tmp_path / "b") is None  # a warning would be an error
    assert list(tmp_path.iterdir()) == []


def test_a_disk_that_is_full_is_told_once_and_nothing_half_written_stays(tmp_path, monkeypatch):
    def fail(handle):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", fail)
    with pytest.warns(CacheWarning, match="No space left on device"):
        assert not module.write_file(tmp_path / "a", CONTENT)
    assert not module.write_file(tmp_path / "b", CONTENT)
    assert list(tmp_path.iterdir()) == []


def test_a_file_in_place_of_its_folder_is_told_and_no_error(tmp_path):
    (tmp_path / "folder").write_text("in the way")
    with pytest.warns(CacheWarning, match="cannot be written"):
        assert not module.write_file(tmp_path / "folder" / "file", CONTENT)
