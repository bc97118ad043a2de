"""Files are read whole or refused in one line: regular ones, of limited size, and whatever their readers raise."""

import os
import socket
import threading
import zlib

import pytest

from ikde.errors import FileError, InputError
from ikde.formats.reading import errors_of, max_bytes, read_bytes, read_json, read_text


def complaint(read, *arguments, **options):
    with pytest.raises(InputError) as caught:
        read(*arguments, **options)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_a_regular_file_is_read_whole(tmp_path):
    (tmp_path / "a").write_bytes(b"abc\r\n")
    assert read_bytes(tmp_path / "a") == b"abc\r\n"
    assert read_text(tmp_path / "a") == "abc\r\n"


def test_a_pipe_without_a_writer_is_refused_at_once(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    heard = []
    asking = threading.Thread(target=lambda: heard.append(complaint(read_bytes, tmp_path / "pipe")), daemon=True)
    asking.start()
    asking.join(20.0)  # a reader that waits for a writer waits for ever
    assert heard == [f"{tmp_path / 'pipe'}: this is a pipe, a device or a socket; expected a regular file"]


def test_what_never_ends_is_refused():
    assert "a device" in complaint(read_bytes, "/dev/zero")


def test_folders_and_sockets_and_names_that_cannot_be_are_refused(tmp_path):
    assert "this is a folder; expected a file" in complaint(read_bytes, tmp_path)
    with socket.socket(socket.AF_UNIX) as listening:
        listening.bind(str(tmp_path / "s"))
        assert "cannot be read" in complaint(read_bytes, tmp_path / "s")
    assert "no such file" in complaint(read_bytes, tmp_path / "missing")
    assert "cannot be read" in complaint(read_bytes, tmp_path / ("x" * 5000))
    assert "cannot be read" in complaint(read_bytes, tmp_path / "x\0y")


def test_a_file_that_says_it_is_empty_is_empty():
    assert read_bytes("/proc/self/status") == b""  # such files of the system may never end


def test_sizes_are_limited_and_the_limit_is_said_and_can_be_raised(tmp_path, monkeypatch):
    path = tmp_path / "large"
    with path.open("wb") as file:
        file.truncate(2_000_001)  # takes up no room
    monkeypatch.setenv("IKDE_MAX_FILE_MB", "2")
    assert complaint(read_bytes, path) == f"{path}: 2.000001 MB; expected at most 2 MB ($IKDE_MAX_FILE_MB)"
    monkeypatch.setenv("IKDE_MAX_FILE_MB", "2.1")
    assert len(read_bytes(path)) == 2_000_001
    assert complaint(read_text, path) == f"{path}: 2.000001 MB; expected at most 0.21 MB ($IKDE_MAX_FILE_MB)"


def test_half_a_gigabyte_is_the_limit_if_nothing_is_said(monkeypatch):
    monkeypatch.delenv("IKDE_MAX_FILE_MB", raising=False)
    assert max_bytes() == 500 * 10**6


@pytest.mark.parametrize("given", ["many", "-1", "0", "nan", "inf", "1e30"])
def test_a_limit_that_is_none_is_refused(monkeypatch, given):
    monkeypatch.setenv("IKDE_MAX_FILE_MB", given)
    assert complaint(max_bytes) == f"IKDE_MAX_FILE_MB: expected a number of MB above 0, got {given!r}"


def test_a_link_is_followed_unless_that_is_forbidden(tmp_path):
    (tmp_path / "a").write_text("abc")
    (tmp_path / "b").symlink_to("a")
    assert read_bytes(tmp_path / "b") == b"abc"
    assert "cannot be read" in complaint(read_bytes, tmp_path / "b", follow=False)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("{", "a.json:1: not JSON: Expecting property name"),
        ("[\n1,\n]", "a.json:"),
        ("NaN", "a.json: not JSON: NaN is no number"),
        ("[" * 41 + "]" * 41, "a.json: nested too deeply; expected at most 40 levels"),
        ("[" * 100_000, "a.json: nested too deeply"),
        ("1" * 5000, "a.json: not JSON: "),
    ],
)
def test_what_is_no_json_is_one_line(tmp_path, text, expected):
    path = tmp_path / "a.json"
    path.write_text(text)
    assert complaint(read_json, path).replace(str(path), "a.json").startswith(expected)


def test_brackets_inside_words_are_no_levels(tmp_path):
    (tmp_path / "a.json").write_text('{"' + "[" * 100 + '\\"": [[1]]}')
    assert read_json(tmp_path / "a.json") == {"[" * 100 + '"': [[1]]}


@pytest.mark.parametrize(
    "error",
    [zlib.error("bad\nlines"), EOFError(), NotImplementedError("x"), TypeError("x"), MemoryError(), KeyError(1)],
)
def test_whatever_a_reader_raises_is_one_line(error):
    def read():
        with errors_of("a.bin"):
            raise error

    assert complaint(read).startswith("a.bin: cannot be read: ")


def test_an_error_of_ours_stays_as_it_is():
    with pytest.raises(InputError) as caught, errors_of("a.bin"):
        raise InputError("wrong", ("x",))
    assert not isinstance(caught.value, FileError)
    assert str(caught.value) == "x: wrong"
