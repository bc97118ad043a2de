"""Files that are whole or not there."""

import pytest

from ikde.batch.atomic import remove_temporaries, temporary_path, write_atomically


def test_a_file_is_written_and_written_over(tmp_path):
    path = tmp_path / "a.json"
    for data in (b"first", b"second, longer", b""):
        write_atomically(path, data)
        assert path.read_bytes() == data
        assert list(tmp_path.iterdir()) == [path]


def test_a_write_that_fails_leaves_what_was_there(tmp_path, monkeypatch):
    path = tmp_path / "a.json"
    path.write_bytes(b"old")

    def full(descriptor):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(OSError, match="No space left"):
        write_atomically(path, b"new")
    assert [(p, p.read_bytes()) for p in tmp_path.iterdir()] == [(path, b"old")]


def test_leftovers_are_removed_and_nothing_else(tmp_path):
    keep = [tmp_path / "a.parquet", tmp_path / ".hidden", tmp_path / "b.tmp"]
    leftover = temporary_path(keep[0])
    for path in (*keep, leftover):
        path.touch()
    remove_temporaries(tmp_path)
    assert sorted(tmp_path.iterdir()) == sorted(keep)
