"""Files that are whole or not there."""

import os
import threading

import pytest

from ikde.errors import FileError
from ikde.formats.atomic import remove_temporaries, replace_all, temporary_path, write_named, write_together


def test_a_file_is_written_and_written_over(tmp_path):
    path = tmp_path / "a.json"
    for data in (b"first", b"second, longer", b""):
        replace_all(tmp_path, {path.name: data})
        assert path.read_bytes() == data
        assert list(tmp_path.iterdir()) == [path]


def test_a_write_that_fails_leaves_what_was_there(tmp_path, monkeypatch):
    path = tmp_path / "a.json"
    path.write_bytes(b"old")

    def full(descriptor):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(FileError, match=r"a\.json: cannot be written: No space left"):
        replace_all(tmp_path, {path.name: b"new"})
    assert [(p, p.read_bytes()) for p in tmp_path.iterdir()] == [(path, b"old")]


def test_a_folder_holds_what_is_new_and_nothing_that_was_before(tmp_path):
    assert replace_all(tmp_path, {"b": b"1", "a": b"2"}, "abc") == (tmp_path / "b", tmp_path / "a")
    (tmp_path / "mine").touch()
    replace_all(tmp_path, {"c": b"3"}, "abc")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["c", "mine"]


def test_a_folder_that_cannot_be_written_is_one_line(tmp_path):
    (tmp_path / "a").mkdir()
    with pytest.raises(FileError, match=r"a: cannot be written: [^\n]*$"):
        replace_all(tmp_path, {"a": b"1"}, ())


def test_leftovers_are_removed_and_nothing_else(tmp_path):
    keep = [tmp_path / "a.parquet", tmp_path / ".hidden", tmp_path / "b.tmp"]
    leftover = temporary_path(keep[0])
    for path in (*keep, leftover):
        path.touch()
    remove_temporaries(tmp_path)
    assert sorted(tmp_path.iterdir()) == sorted(keep)


def test_files_get_their_names_together_and_in_order(tmp_path, monkeypatch):
    paths, named = [tmp_path / name for name in "cab"], []
    honest = type(tmp_path).replace

    def watch(path, target):
        named.append(target)
        assert all(temporary_path(later).exists() for later in paths[len(named) - 1 :])
        return honest(path, target)

    monkeypatch.setattr(type(tmp_path), "replace", watch)
    write_together({path: path.name.encode() * 100_000 for path in paths})
    assert named == paths
    assert [path.read_bytes() for path in paths] == [name * 100_000 for name in (b"c", b"a", b"b")]
    assert sorted(tmp_path.iterdir()) == sorted(paths)


@pytest.mark.parametrize("call", ["os.write", "os.fsync", "os.open"])
@pytest.mark.parametrize("guilty", [0, 1])
def test_the_file_that_fails_is_named_and_none_is_new(tmp_path, monkeypatch, call, guilty):
    paths, honest, calls = [tmp_path / name for name in "ab"], getattr(os, call.split(".")[1]), []
    paths[0].write_bytes(b"old")

    def fail(first, *rest):
        calls.append(first)
        if call == "os.fsync" and os.fstat(first).st_size == 3 + guilty:
            raise OSError(28, "No space left on device")
        if call != "os.fsync" and len(calls) == guilty + 1:
            raise OSError(28, "No space left on device")
        return honest(first, *rest)

    monkeypatch.setattr(call, fail)
    with pytest.raises(OSError, match="No space left") as caught:
        write_together({paths[0]: b"new", paths[1]: b"newer"[:4]})
    monkeypatch.undo()
    assert caught.value.filename == str(paths[guilty])
    assert [(p, p.read_bytes()) for p in tmp_path.iterdir()] == [(paths[0], b"old")]


def test_a_disk_that_takes_a_little_at_a_time_gets_it_all(tmp_path, monkeypatch):
    honest = os.write
    monkeypatch.setattr("os.write", lambda descriptor, data: honest(descriptor, data[:7]))
    replace_all(tmp_path, {"a": b"0123456789" * 10})
    assert (tmp_path / "a").read_bytes() == b"0123456789" * 10


def test_a_link_in_the_way_is_not_followed(tmp_path):
    precious = tmp_path / "precious"
    precious.write_text("mine")
    path = tmp_path / "out" / "a.txt"
    path.parent.mkdir()
    temporary_path(path).symlink_to(precious)
    path.symlink_to(precious)
    replace_all(path.parent, {path.name: b"ours"})
    assert (precious.read_text(), path.read_text(), path.is_symlink()) == ("mine", "ours", False)


def test_a_pipe_in_the_way_is_not_waited_for(tmp_path):
    path = tmp_path / "a.txt"
    os.mkfifo(temporary_path(path))
    writing = threading.Thread(target=replace_all, args=(tmp_path, {path.name: b"ours"}), daemon=True)
    writing.start()
    writing.join(20.0)
    assert path.read_bytes() == b"ours"


def test_a_file_that_a_user_names_is_written_through_a_link(tmp_path):
    (tmp_path / "data").mkdir()
    aim, link = tmp_path / "data" / "a.txt", tmp_path / "link.txt"
    link.symlink_to("data/a.txt")
    for text in (b"new", b"newer"):  # the first time, nothing is there yet
        assert write_named(link, text, {"b.txt": b"beside"}) == (tmp_path / "b.txt", link)
        assert (link.is_symlink(), aim.read_bytes(), (tmp_path / "b.txt").read_bytes()) == (True, text, b"beside")
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["a.txt", "b.txt", "data", "link.txt"]


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("pipe", "this is no ordinary file"),
        ("folder", "this is no ordinary file"),
        ("round", "Too many levels|no path|no ordinary|folder does not exist"),
        ("away", "its folder does not exist"),
        ("none/a.txt", "its folder does not exist"),
        ("pipe/a.txt", "its folder does not exist"),
        ("a\0b", "cannot be written: no path"),
        ("\ud800", "cannot be written: no path"),
        ("x" * 300, "cannot be written: File name too long"),
    ],
)
def test_what_is_no_place_for_a_file_is_left_alone(tmp_path, name, said):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "folder").mkdir()
    (tmp_path / "round").symlink_to("round")
    (tmp_path / "away").symlink_to("none/a.txt")
    before = sorted(tmp_path.rglob("*"))
    with pytest.raises(FileError, match=said):
        write_named(tmp_path / name, b"ours")
    assert sorted(tmp_path.rglob("*")) == before
